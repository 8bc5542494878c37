//! Nodes and elements of version 4.1, in blocks by geometrical entity.

use crate::model::mesh::data::error::MeshError;
use crate::model::mesh::gmsh::cursor::{Cursor, RecordSize};
use crate::model::mesh::gmsh::element_record::{ReadKind, TagType, read_element};
use crate::model::mesh::gmsh::found::GmshContents;

const NODE: RecordSize = RecordSize { ints: 0, sizes: 1, doubles: 3 };

/// The header of a block: three numbers and a count.
struct BlockHeader {
    dimension: usize,
    tag: i64,
    /// Parametric or not of nodes, the type of elements.
    third: i64,
    count: u64,
}

/// Reads the header of the section: blocks, and nodes or elements altogether. Labels' bounds are not needed.
fn section_header(cursor: &mut Cursor, what: &str) -> Result<(usize, u64), MeshError> {
    cursor.begin_numbers()?;
    let blocks = cursor.size("the number of blocks")?;
    let count = cursor.size(what)?;
    cursor.size("the least tag")?;
    cursor.size("the largest tag")?;
    let blocks = cursor.fitting(blocks, RecordSize { ints: 3, sizes: 1, doubles: 0 }, "blocks")?;
    Ok((blocks, count))
}

fn block_header(cursor: &mut Cursor, third: &str) -> Result<BlockHeader, MeshError> {
    let dimension = cursor.natural_int("the dimension of an entity")?;
    let tag = cursor.int("the tag of an entity")?;
    let third = cursor.int(third)?;
    let count = cursor.size("the count of a block")?;
    let known = usize::try_from(dimension).ok().filter(|dimension| *dimension <= 3);
    let Some(dimension) = known else {
        return Err(MeshError::expected(cursor.place(), "a dimension of an entity from 0 to 3", dimension));
    };
    Ok(BlockHeader { dimension, tag, third, count })
}

/// Reads the nodes: in each block their tags, then their coordinates, with those on the entity where it is parametric.
pub fn nodes(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    let (blocks, announced) = section_header(cursor, "the number of nodes")?;
    found.reserve_nodes(cursor, announced, NODE)?;
    for _ in 0..blocks {
        let header = block_header(cursor, "whether nodes are parametric, 0 or 1")?;
        let parameters = if header.third == 0 { 0 } else { header.dimension };
        let record = RecordSize { doubles: 3 + parameters, ..NODE };
        let count = cursor.fitting(header.count, record, "nodes")?;
        for _ in 0..count {
            found.node_labels.push(cursor.size("the tag of a node")?);
        }
        for _ in 0..count {
            let mut point = [0.0; 3];
            for coordinate in &mut point {
                *coordinate = cursor.double("a coordinate")?;
            }
            for _ in 0..parameters {
                cursor.double("a parametric coordinate")?;
            }
            found.coordinates.push(point);
        }
    }
    as_announced(cursor, announced, found.node_labels.len(), "nodes")?;
    found.index_nodes(cursor.place())
}

/// Reads the elements: in each block a tag and nodes for each.
pub fn elements(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    let (blocks, announced) = section_header(cursor, "the number of elements")?;
    cursor.fitting(announced, RecordSize { ints: 0, sizes: 2, doubles: 0 }, "elements")?;
    for _ in 0..blocks {
        let header = block_header(cursor, "the type of elements")?;
        let kind = ReadKind::new(header.third, cursor.place())?;
        let record = RecordSize { sizes: 1 + kind.shape.nodes(), ..RecordSize::default() };
        let count = cursor.fitting(header.count, record, "elements")?;
        found.elements.nodes.reserve(count, count * kind.shape.nodes());
        for _ in 0..count {
            let label = cursor.size("the tag of an element")?;
            read_element(cursor, found, kind, label, TagType::Size)?;
        }
        let tag = match &found.entities {
            Some(entities) if entities.contains_key(&(header.dimension, header.tag)) => header.tag,
            Some(_) => {
                let (dimension, tag) = (header.dimension, header.tag);
                let detail =
                    format!("dimension {dimension}, tag {tag}: `$Entities` does not have the elements' entity");
                return Err(MeshError::new(cursor.place(), detail));
            }
            // Without entities there are no groups.
            None => 0,
        };
        found.extend_run(header.dimension, tag, count);
    }
    as_announced(cursor, announced, found.elements.len(), "elements")
}

fn as_announced(cursor: &Cursor, announced: u64, read: usize, what: &str) -> Result<(), MeshError> {
    if announced == read as u64 {
        return Ok(());
    }
    Err(MeshError::new(cursor.place(), format!("{announced} {what} are announced, and the blocks have {read}")))
}
