//! `*NSET`, `*ELSET` and `*SURFACE`.

use crate::model::mesh::abaqus::definitions::{Definitions, SetDefinition, SetItem, SurfaceDefinition, SurfaceRow};
use crate::model::mesh::abaqus::instances::Instances;
use crate::model::mesh::abaqus::lines::{DataLine, DeckLines, Keyword, label};
use crate::model::mesh::data::error::{MeshError, quoted};

/// Reads a set of nodes or elements; `parameter` is NSET or ELSET. None for a set of the assembly's own nodes.
pub fn set(
    keyword: &Keyword,
    parameter: &str,
    lines: &mut DeckLines,
    instances: &Instances,
    found: &mut Definitions,
) -> Result<Option<SetDefinition>, MeshError> {
    let name = keyword.required(parameter)?;
    match keyword.value("INSTANCE") {
        Some(instance) => instances.check_instance(instance, keyword.place)?,
        None if instances.is_assembly() => {
            found.unread.add(keyword.place, format!("*{} of the assembly's own, `{name}`", keyword.name));
            return Ok(None);
        }
        None => {}
    }
    let mut items = Vec::new();
    while let Some(line) = lines.next_data() {
        if keyword.has("GENERATE") {
            items.push(range(line)?);
            continue;
        }
        for field in line.fields() {
            match (label(field), items.last_mut()) {
                (Some(label), Some(SetItem::Labels(labels))) => labels.push(label),
                (Some(label), _) => items.push(SetItem::Labels(vec![label])),
                (None, _) => items.push(SetItem::Name(instances.local(line.name(field)?).to_owned())),
            }
        }
    }
    Ok(Some(SetDefinition {
        scope: instances.scope(),
        name: name.to_owned(),
        is_internal: keyword.has("INTERNAL"),
        place: keyword.place,
        items,
    }))
}

/// Reads `first, last, step` of a generated set.
fn range(line: DataLine) -> Result<SetItem, MeshError> {
    let what = "a whole number of `first, last, step`";
    let mut fields = line.fields();
    let first = line.label(fields.next().unwrap_or_default(), what)?;
    let last = line.label(fields.next().unwrap_or_default(), what)?;
    let step = fields.next().filter(|step| !step.is_empty()).map_or(Ok(1), |step| line.label(step, what))?;
    if step == 0 || last < first {
        let found = format!("{first}, {last}, {step}");
        return Err(MeshError::expected(line.place, "`first, last, step` upwards with a step above zero", found));
    }
    Ok(SetItem::Range(first, last, step))
}

/// Reads a surface of faces or of nodes.
pub fn surface(
    keyword: &Keyword,
    lines: &mut DeckLines,
    instances: &Instances,
    found: &mut Definitions,
) -> Result<(), MeshError> {
    let name = keyword.required("NAME")?;
    let of_nodes = match keyword.value("TYPE").map(str::to_ascii_uppercase).as_deref() {
        None | Some("ELEMENT") => false,
        Some("NODE") => true,
        Some(other) => {
            found.unread.add(keyword.place, format!("*SURFACE, TYPE={other}, `{name}`"));
            return Ok(());
        }
    };
    if keyword.has("COMBINE") || keyword.has("CROP") {
        found.unread.add(keyword.place, format!("*SURFACE made of others, `{name}`"));
        return Ok(());
    }
    let mut rows = Vec::new();
    while let Some(line) = lines.next_data() {
        let mut fields = line.fields();
        let first = fields.next().unwrap_or_default();
        let members = match label(first) {
            Some(label) => SetItem::Labels(vec![label]),
            None => SetItem::Name(instances.local(line.name(first)?).to_owned()),
        };
        let face = if of_nodes { None } else { Some(face(line, fields.next().unwrap_or_default())?) };
        rows.push(SurfaceRow { members, face, place: line.place });
    }
    found.surfaces.push(SurfaceDefinition { scope: instances.scope(), name: name.to_owned(), of_nodes, rows });
    Ok(())
}

/// The number of a face: S1 to S6.
fn face(line: DataLine, field: &[u8]) -> Result<usize, MeshError> {
    let number = field.strip_prefix(b"S").or_else(|| field.strip_prefix(b"s")).and_then(label);
    match number.and_then(|number| usize::try_from(number).ok()) {
        Some(number @ 1..=6) => Ok(number),
        _ => Err(MeshError::expected(line.place, "a face S1 to S6 of a solid", quoted(field))),
    }
}
