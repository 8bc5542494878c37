//! The keywords of a deck, one after another.

use crate::model::mesh::abaqus::definitions::Definitions;
use crate::model::mesh::abaqus::instances::Instances;
use crate::model::mesh::abaqus::lines::{DeckLines, Keyword};
use crate::model::mesh::abaqus::{elements, materials, sets};
use crate::model::mesh::data::error::{MeshError, MeshPlace};

/// Reads what a deck defines, up to its end.
///
/// # Errors
/// The first mistake of form.
pub fn definitions(bytes: &[u8]) -> Result<Definitions, MeshError> {
    let mut lines = DeckLines::new(bytes);
    let mut found = Definitions::default();
    let mut instances = Instances::default();
    if let Some(line) = lines.next_data() {
        return Err(MeshError::expected(line.place, "a keyword such as *NODE first", "data"));
    }
    while let Some(keyword) = lines.next_keyword()? {
        if !instances.take(&keyword, &mut lines)? {
            read_keyword(&keyword, &mut lines, &instances, &mut found)?;
        }
    }
    for (is_there, name) in [(!found.node_labels.is_empty(), "*NODE"), (found.elements > 0, "*ELEMENT")] {
        if !is_there {
            return Err(MeshError::new(MeshPlace::File, format!("there is no {name} of a kind that is read")));
        }
    }
    Ok(found)
}

fn read_keyword(
    keyword: &Keyword,
    lines: &mut DeckLines,
    instances: &Instances,
    found: &mut Definitions,
) -> Result<(), MeshError> {
    if keyword.has("INPUT") || keyword.name == "INCLUDE" {
        return Err(MeshError::new(keyword.place, "other files are not opened: put the text in its place"));
    }
    match keyword.name.as_str() {
        "NODE" => elements::nodes(keyword, lines, instances, found)?,
        "ELEMENT" => elements::elements(keyword, lines, instances, found)?,
        "NSET" => {
            let set = sets::set(keyword, "NSET", lines, instances, found)?;
            found.node_sets.extend(set);
        }
        "ELSET" => {
            let set = sets::set(keyword, "ELSET", lines, instances, found)?;
            found.element_sets.extend(set);
        }
        "SURFACE" => sets::surface(keyword, lines, instances, found)?,
        "MATERIAL" => materials::material(keyword, found)?,
        "ELASTIC" | "HYPERELASTIC" | "DENSITY" => materials::property(keyword, lines, found)?,
        "SOLID SECTION" => materials::solid_section(keyword, lines, instances, found)?,
        // What makes further nodes or elements, or moves them: without it the mesh would be another one.
        "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" | "SYSTEM" | "PARAMETER" => {
            let detail =
                format!("*{} is not read, and the mesh depends on it: write all nodes and elements", keyword.name);
            return Err(MeshError::new(keyword.place, detail));
        }
        "STEP" => {
            found.unread.add(keyword.place, "*STEP with all that it holds");
            while lines.next_keyword()?.is_some_and(|keyword| keyword.name != "END STEP") {}
        }
        "HEADING" => {}
        other => found.unread.add(keyword.place, format!("*{other}")),
    }
    Ok(())
}
