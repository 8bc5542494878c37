//! Parts, instances and the assembly: one part in its own place is read.

use crate::model::mesh::abaqus::definitions::NameScope;
use crate::model::mesh::abaqus::lines::{DeckLines, Keyword};
use crate::model::mesh::data::error::{MeshError, MeshPlace, quoted};

/// Which part of a deck is being read.
#[derive(Debug, Clone, Default)]
pub struct Instances {
    part: Option<String>,
    instance: Option<String>,
    in_assembly: bool,
    in_instance: bool,
}

impl Instances {
    /// Where names are defined now.
    pub fn scope(&self) -> NameScope {
        if self.is_assembly() { NameScope::Assembly } else { NameScope::Part }
    }

    /// Whether what stands here belongs to the assembly itself.
    pub fn is_assembly(&self) -> bool {
        self.in_assembly && !self.in_instance
    }

    /// Takes a keyword of this kind, and tells whether it is one.
    ///
    /// # Errors
    /// A second part or instance, or one that is moved.
    pub fn take(&mut self, keyword: &Keyword, lines: &mut DeckLines) -> Result<bool, MeshError> {
        match keyword.name.as_str() {
            "PART" => one(&mut self.part, "part", keyword, "NAME")?,
            "INSTANCE" => {
                one(&mut self.instance, "instance", keyword, "NAME")?;
                self.in_instance = true;
                in_its_own_place(lines)?;
            }
            "END INSTANCE" => self.in_instance = false,
            "ASSEMBLY" => self.in_assembly = true,
            "END ASSEMBLY" => self.in_assembly = false,
            "END PART" => {}
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Checks that a set of the assembly is of the instance that is read.
    ///
    /// # Errors
    /// It is of another one.
    pub fn check_instance(&self, name: &str, place: MeshPlace) -> Result<(), MeshError> {
        match &self.instance {
            Some(instance) if instance.eq_ignore_ascii_case(name) => Ok(()),
            Some(instance) => {
                Err(MeshError::expected(place, format_args!("the instance `{instance}`"), quoted(name.as_bytes())))
            }
            None => Err(MeshError::expected(
                place,
                "a set without INSTANCE, as there is no *INSTANCE",
                quoted(name.as_bytes()),
            )),
        }
    }

    /// A name without the name of the instance before it.
    pub fn local<'a>(&self, name: &'a str) -> &'a str {
        match (&self.instance, name.split_once('.')) {
            (Some(instance), Some((before, local))) if instance.eq_ignore_ascii_case(before) => local,
            _ => name,
        }
    }
}

fn one(slot: &mut Option<String>, what: &str, keyword: &Keyword, parameter: &str) -> Result<(), MeshError> {
    if let Some(first) = slot {
        let detail = format!("a second {what} after `{first}`; one {what} is read: join them before");
        return Err(MeshError::new(keyword.place, detail));
    }
    *slot = Some(keyword.required(parameter)?.to_owned());
    Ok(())
}

/// Reads the translation and rotation of an instance, which have to be none.
fn in_its_own_place(lines: &mut DeckLines) -> Result<(), MeshError> {
    while let Some(line) = lines.next_data() {
        // A rotation gives two points of its axis, then the angle.
        let fields: Vec<&[u8]> = line.fields().collect();
        let moves = if fields.len() > 3 { fields.get(6..).unwrap_or_default() } else { fields.as_slice() };
        for field in moves {
            if line.real(field, "a translation or a rotation")? != 0.0 {
                let detail = "the instance is moved; write the nodes where they are instead";
                return Err(MeshError::new(line.place, detail));
            }
        }
    }
    Ok(())
}
