//! `*NODE` and `*ELEMENT`.

use crate::model::mesh::abaqus::definitions::{DeckElementBlock, Definitions, SetDefinition, SetItem};
use crate::model::mesh::abaqus::element_types::{DeckElementType, deck_element_type};
use crate::model::mesh::abaqus::instances::Instances;
use crate::model::mesh::abaqus::lines::{DeckLines, Keyword, label};
use crate::model::mesh::data::error::{MeshError, MeshPlace, quoted};

/// Reads nodes: a label and up to three coordinates a line.
pub fn nodes(
    keyword: &Keyword,
    lines: &mut DeckLines,
    instances: &Instances,
    found: &mut Definitions,
) -> Result<(), MeshError> {
    if instances.is_assembly() {
        found.unread.add(keyword.place, "*NODE of the assembly");
        return Ok(());
    }
    if let Some(system) = keyword.value("SYSTEM").filter(|system| !system.eq_ignore_ascii_case("R")) {
        return Err(MeshError::expected(keyword.place, "rectangular coordinates", quoted(system.as_bytes())));
    }
    let first = found.node_labels.len();
    found.node_blocks.push((keyword.place, first));
    while let Some(line) = lines.next_data() {
        let mut fields = line.fields();
        let label = line.label(fields.next().unwrap_or_default(), "the label of a node")?;
        let mut point = [0.0; 3];
        for coordinate in &mut point {
            *coordinate = line.real(fields.next().unwrap_or_default(), "a coordinate")?;
        }
        found.node_labels.push(label);
        found.coordinates.push(point);
    }
    if let Some(name) = keyword.value("NSET") {
        let items = vec![places(first, found.node_labels.len(), keyword.place)?];
        found.node_sets.push(definition(keyword, instances, name, items));
    }
    Ok(())
}

/// Reads elements: a label and the nodes each, over as many lines as they take.
pub fn elements(
    keyword: &Keyword,
    lines: &mut DeckLines,
    instances: &Instances,
    found: &mut Definitions,
) -> Result<(), MeshError> {
    let name = keyword.required("TYPE")?;
    if instances.is_assembly() {
        found.unread.add(keyword.place, format!("*ELEMENT, TYPE={} of the assembly", name.to_ascii_uppercase()));
        return Ok(());
    }
    let first = found.elements;
    match deck_element_type(name) {
        DeckElementType::Refused => {
            let expected = "elements C3D4, 8, 10, 20 or CPS, CPE, CAX with 3, 4, 6, 8 nodes";
            return Err(MeshError::expected(keyword.place, expected, quoted(name.as_bytes())));
        }
        DeckElementType::Other => other_elements(lines, found, keyword, name),
        DeckElementType::Solid { shape, plane_state, variant } => {
            if !variant.is_empty() {
                let plain = name.get(..name.len() - variant.len()).unwrap_or(name);
                found.unread.add(keyword.place, format!("the ending {variant} of {name}, which is read as {plain}"));
            }
            let mut block =
                DeckElementBlock { shape, plane_state, place: keyword.place, labels: Vec::new(), nodes: Vec::new() };
            while read_element(lines, &mut block)? {}
            found.elements += block.labels.len();
            found.element_blocks.push(block);
        }
    }
    if let Some(name) = keyword.value("ELSET") {
        let items = vec![places(first, found.elements, keyword.place)?];
        found.element_sets.push(definition(keyword, instances, name, items));
    }
    Ok(())
}

/// Reads one element, if there is one.
fn read_element(lines: &mut DeckLines, block: &mut DeckElementBlock) -> Result<bool, MeshError> {
    let Some(mut line) = lines.next_data() else { return Ok(false) };
    let mut fields = line.fields();
    let label = line.label(fields.next().unwrap_or_default(), "the label of an element")?;
    let wanted = block.shape.nodes();
    let mut read = 0;
    loop {
        for field in fields {
            if read == wanted {
                let expected = format!("{wanted} nodes for element {label}");
                return Err(MeshError::expected(line.place, expected, format_args!("also {}", quoted(field))));
            }
            block.nodes.push(line.label(field, "the label of a node")?);
            read += 1;
        }
        if read == wanted {
            block.labels.push(label);
            return Ok(true);
        }
        let place = line.place;
        match lines.next_data() {
            Some(next) => line = next,
            None => return Err(MeshError::expected(place, format_args!("{wanted} nodes for element {label}"), read)),
        }
        fields = line.fields();
    }
}

/// Keeps the labels of elements that are not read, as sets may have them.
fn other_elements(lines: &mut DeckLines, found: &mut Definitions, keyword: &Keyword, name: &str) {
    found.unread.add(keyword.place, format!("*ELEMENT, TYPE={}", name.to_ascii_uppercase()));
    let mut is_continued = false;
    while let Some(line) = lines.next_data() {
        if !is_continued && let Some(label) = line.fields().next().and_then(label) {
            found.other_elements.insert(label);
        }
        is_continued = line.is_continued();
    }
}

fn places(first: usize, end: usize, place: MeshPlace) -> Result<SetItem, MeshError> {
    let first_place = u32::try_from(first);
    match (first_place, u32::try_from(end)) {
        (Ok(first), Ok(end)) if end < u32::MAX => Ok(SetItem::Places(first, end - first)),
        _ => Err(MeshError::new(place, format!("too many: at most {} of a kind", u32::MAX - 1))),
    }
}

fn definition(keyword: &Keyword, instances: &Instances, name: &str, items: Vec<SetItem>) -> SetDefinition {
    SetDefinition {
        scope: instances.scope(),
        name: name.to_owned(),
        is_internal: keyword.has("INTERNAL"),
        place: keyword.place,
        items,
    }
}
