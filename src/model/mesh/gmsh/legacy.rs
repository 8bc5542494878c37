//! Nodes and elements of version 2.2.

use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::gmsh::cursor::{Cursor, RecordSize};
use crate::model::mesh::gmsh::element_record::{ReadKind, TagType, read_element};
use crate::model::mesh::gmsh::found::GmshContents;

const NODE: RecordSize = RecordSize { ints: 1, sizes: 0, doubles: 3 };

/// Tags of an element at most; more are no file of gmsh.
const MOST_TAGS: u64 = 1_000_000;

/// Reads the nodes: `tag x y z` each.
pub fn nodes(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    let count = cursor.words.natural("the number of nodes")?;
    cursor.begin_numbers()?;
    let count = found.reserve_nodes(cursor, count, NODE)?;
    for _ in 0..count {
        found.node_labels.push(cursor.natural_int("the tag of a node, or as many nodes as announced")?);
        let mut point = [0.0; 3];
        for coordinate in &mut point {
            *coordinate = cursor.double("a coordinate")?;
        }
        found.coordinates.push(point);
    }
    found.index_nodes(cursor.place())
}

/// Reads the elements. In text every element has its header, `tag type tags`; in binary a block of elements has one.
pub fn elements(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    let count = cursor.words.natural("the number of elements")?;
    cursor.begin_numbers()?;
    let count = cursor.fitting(count, RecordSize { ints: 2, ..RecordSize::default() }, "elements")?;
    let mut read = 0;
    while read < count {
        if cursor.is_binary() {
            read += block(cursor, found, count - read)?;
        } else {
            let label = cursor.words.natural("the tag of an element, or as many elements as announced")?;
            let kind = kind(cursor)?;
            let tags = cursor.words.natural("the number of tags")?;
            element(cursor, found, kind, label, tags)?;
            read += 1;
        }
    }
    Ok(())
}

fn kind(cursor: &mut Cursor) -> Result<ReadKind, MeshError> {
    let place = cursor.place();
    let number = cursor.int("the type of an element")?;
    ReadKind::new(number, place)
}

/// Reads a block of a binary file and counts its elements.
fn block(cursor: &mut Cursor, found: &mut GmshContents, left: usize) -> Result<usize, MeshError> {
    let place = cursor.place();
    let kind = kind(cursor)?;
    let count = cursor.natural_int("the number of elements in a block")?;
    let tags = cursor.natural_int("the number of tags")?;
    if count == 0 || count > left as u64 {
        return Err(MeshError::expected(place, format_args!("a block of 1 to {left} elements"), count));
    }
    let record = RecordSize { ints: 1 + kind.shape.nodes(), ..RecordSize::default() };
    let count = cursor.fitting(count, record, "elements")?;
    for _ in 0..count {
        let label = cursor.natural_int("the tag of an element")?;
        element(cursor, found, kind, label, tags)?;
    }
    Ok(count)
}

/// Reads an element's tags, of which the first is its physical group, and its nodes.
fn element(
    cursor: &mut Cursor,
    found: &mut GmshContents,
    kind: ReadKind,
    label: u64,
    tags: u64,
) -> Result<(), MeshError> {
    if tags > MOST_TAGS {
        return Err(too_many_tags(cursor.place(), kind.shape, tags));
    }
    let mut group = 0;
    for place in 0..tags {
        let tag = cursor.int("a tag of an element")?;
        if place == 0 {
            group = tag;
        }
    }
    read_element(cursor, found, kind, label, TagType::Int)?;
    found.extend_run(kind.shape.dimension(), group, 1);
    Ok(())
}

fn too_many_tags(place: MeshPlace, shape: ElementShape, tags: u64) -> MeshError {
    MeshError::expected(place, format_args!("at most {MOST_TAGS} tags for a {}", shape.name()), tags)
}
