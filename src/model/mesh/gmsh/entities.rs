//! Geometrical entities of version 4.1 and their physical groups.

use crate::model::mesh::data::error::MeshError;
use crate::model::mesh::gmsh::cursor::{Cursor, RecordSize};
use crate::model::mesh::gmsh::found::GmshContents;

/// Reads `$Entities`: for each its tag, its place, its physical groups, and what bounds it.
pub fn entities(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    cursor.begin_numbers()?;
    list(cursor, found, false)?;
    cursor.keyword("$EndEntities")
}

/// Reads `$PartitionedEntities`, the parts that entities are cut into; elements belong to these.
pub fn partitioned_entities(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    cursor.begin_numbers()?;
    cursor.size("the number of partitions")?;
    let ghosts = cursor.size("the number of ghost entities")?;
    let ghosts = cursor.fitting(ghosts, RecordSize { ints: 2, ..RecordSize::default() }, "ghost entities")?;
    for _ in 0..ghosts {
        cursor.int("the tag of a ghost entity")?;
        cursor.int("the partition of a ghost entity")?;
    }
    list(cursor, found, true)?;
    cursor.keyword("$EndPartitionedEntities")
}

fn list(cursor: &mut Cursor, found: &mut GmshContents, partitioned: bool) -> Result<(), MeshError> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("the number of entities of a dimension")?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        let record = RecordSize { ints: 1, sizes: 1, doubles: 3 };
        for _ in 0..cursor.fitting(count, record, "entities")? {
            let tag = cursor.int("the tag of an entity")?;
            if partitioned {
                cursor.int("the dimension of a parent")?;
                cursor.int("the tag of a parent")?;
                numbers(cursor, "partitions")?;
            }
            // A point, or the corners of a box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                cursor.double("a bound of an entity")?;
            }
            let groups = numbers(cursor, "physical groups")?;
            if dimension > 0 {
                numbers(cursor, "bounding entities")?;
            }
            found.entities.get_or_insert_default().insert((dimension, tag), groups);
        }
    }
    found.entities.get_or_insert_default();
    Ok(())
}

/// Reads a count and as many numbers.
fn numbers(cursor: &mut Cursor, what: &str) -> Result<Vec<i64>, MeshError> {
    let count = cursor.size(what)?;
    let count = cursor.fitting(count, RecordSize { ints: 1, ..RecordSize::default() }, what)?;
    (0..count).map(|_| cursor.int(what)).collect()
}
