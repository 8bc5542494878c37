//! The sections of a file, one after another.

use crate::model::input::limits::MAX_NAME_BYTES;
use crate::model::mesh::data::error::{MeshError, MeshPlace, quoted};
use crate::model::mesh::data::mesh_data::MeshData;
use crate::model::mesh::gmsh::binary::BinaryLayout;
use crate::model::mesh::gmsh::cursor::Cursor;
use crate::model::mesh::gmsh::found::GmshContents;
use crate::model::mesh::gmsh::{blocks, entities, groups, legacy};

/// The two families of versions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    /// 2.0, 2.1 and 2.2.
    Two,
    /// 4.1.
    Four,
}

/// Reads a mesh file of gmsh.
///
/// # Errors
/// The first mistake, with its line in a text file, or its byte in a binary one.
pub fn read(bytes: &[u8]) -> Result<MeshData, MeshError> {
    let mut cursor = Cursor::new(bytes);
    let mut found = GmshContents::default();
    let version = first_section(&mut cursor, &mut found)?;
    while let Some(name) = section_name(&mut cursor)? {
        let place = cursor.place();
        match (name, version) {
            (b"PhysicalNames", _) => physical_names(&mut cursor, &mut found)?,
            (b"Entities" | b"PartitionedEntities", Version::Four) if found.has_elements => {
                return Err(MeshError::new(place, "entities have to stand before `$Elements`"));
            }
            (b"Entities", Version::Four) => entities::entities(&mut cursor, &mut found)?,
            (b"PartitionedEntities", Version::Four) => entities::partitioned_entities(&mut cursor, &mut found)?,
            (b"Nodes", _) => {
                once(found.node_index.is_some(), "$Nodes", place)?;
                match version {
                    Version::Two => legacy::nodes(&mut cursor, &mut found)?,
                    Version::Four => blocks::nodes(&mut cursor, &mut found)?,
                }
                cursor.keyword("$EndNodes")?;
            }
            (b"Elements", _) => {
                once(found.has_elements, "$Elements", place)?;
                if found.node_index.is_none() {
                    return Err(MeshError::new(place, "`$Nodes` has to stand before `$Elements`"));
                }
                found.has_elements = true;
                match version {
                    Version::Two => legacy::elements(&mut cursor, &mut found)?,
                    Version::Four => blocks::elements(&mut cursor, &mut found)?,
                }
                cursor.keyword("$EndElements")?;
            }
            (other, _) => skip(&mut cursor, other, &mut found)?,
        }
    }
    for (is_there, section) in [(found.node_index.is_some(), "$Nodes"), (found.has_elements, "$Elements")] {
        if !is_there {
            return Err(MeshError::new(MeshPlace::File, format!("there is no section `{section}`")));
        }
    }
    groups::mesh(found, version == Version::Two, bytes.len())
}

fn once(again: bool, section: &str, place: MeshPlace) -> Result<(), MeshError> {
    if again { Err(MeshError::new(place, format!("`{section}` is there a second time"))) } else { Ok(()) }
}

/// The name of the next section without `$`; none at the end of the file.
fn section_name<'a>(cursor: &mut Cursor<'a>) -> Result<Option<&'a [u8]>, MeshError> {
    let word = cursor.words.word();
    if word.is_empty() {
        return Ok(None);
    }
    match word.strip_prefix(b"$") {
        Some(name) if !name.is_empty() && name.len() <= MAX_NAME_BYTES => Ok(Some(name)),
        _ => Err(MeshError::expected(cursor.place(), "a section such as `$Nodes`", quoted(word))),
    }
}

/// Reads up to the end of `$MeshFormat`, before which comments may stand.
fn first_section(cursor: &mut Cursor, found: &mut GmshContents) -> Result<Version, MeshError> {
    loop {
        match section_name(cursor)? {
            Some(b"MeshFormat") => return mesh_format(cursor),
            Some(comments @ (b"Comments" | b"Comment")) => skip(cursor, comments, found)?,
            Some(other) => {
                let other = [b"$", other].concat();
                return Err(MeshError::expected(cursor.place(), "`$MeshFormat` first", quoted(&other)));
            }
            None => return Err(MeshError::expected(cursor.place(), "`$MeshFormat`", "nothing")),
        }
    }
}

fn mesh_format(cursor: &mut Cursor) -> Result<Version, MeshError> {
    let word = cursor.words.word();
    let version = match word {
        b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
        b"4.1" => Version::Four,
        _ => {
            let expected = "version 2.2 or 4.1 (save with Mesh.MshFileVersion = 4.1)";
            return Err(MeshError::expected(cursor.place(), expected, quoted(word)));
        }
    };
    let file_type = cursor.words.natural("0 for text or 1 for binary")?;
    let size = cursor.words.natural("the bytes of a number")?;
    match file_type {
        0 => {}
        1 => {
            let layout = layout(cursor, version, size)?;
            cursor.set_layout(layout);
        }
        other => return Err(MeshError::expected(cursor.place(), "0 for text or 1 for binary", other)),
    }
    cursor.keyword("$EndMeshFormat")?;
    Ok(version)
}

/// The layout of a binary file: its order of bytes is that in which a number reads as 1.
fn layout(cursor: &mut Cursor, version: Version, size: u64) -> Result<BinaryLayout, MeshError> {
    let place = cursor.place();
    let size_bytes = match (version, size) {
        (_, 8) => 8,
        (Version::Four, 4) => 4,
        _ => return Err(MeshError::expected(place, "8 bytes for a number", size)),
    };
    if !cursor.words.rest_of_line().trim_ascii().is_empty() {
        return Err(MeshError::new(place, "expected the end of the line after the bytes of a number"));
    }
    let one = cursor.words.rest().first_chunk::<4>().copied().unwrap_or_default();
    let big_endian = match one {
        [1, 0, 0, 0] => false,
        [0, 0, 0, 1] => true,
        _ => return Err(MeshError::expected(place, "the number 1 in four bytes on the next line", quoted(&one))),
    };
    cursor.words.skip_binary(4);
    Ok(BinaryLayout { big_endian, size_bytes })
}

/// Passes over a section, which is put on the list of what is not read.
fn skip(cursor: &mut Cursor, name: &[u8], found: &mut GmshContents) -> Result<(), MeshError> {
    let place = cursor.place();
    let end = [b"$End", name].concat();
    let rest = cursor.words.rest();
    let starts = rest.iter().enumerate().filter(|(_, byte)| **byte == b'$');
    let found_end = starts.map(|(at, _)| at).find(|at| rest.get(*at..).is_some_and(|rest| rest.starts_with(&end)));
    let section = quoted(&[b"$", name].concat());
    let Some(at) = found_end else {
        return Err(MeshError::new(place, format!("the section {section} has no end: expected {}", quoted(&end))));
    };
    cursor.words.skip(at + end.len());
    found.unread.add(place, format!("section {section}"));
    Ok(())
}

/// Reads the names of physical groups, which are text in every file.
fn physical_names(cursor: &mut Cursor, found: &mut GmshContents) -> Result<(), MeshError> {
    let words = &mut cursor.words;
    let count = words.natural("the number of physical names")?;
    for _ in 0..count {
        let dimension = words.natural("the dimension of a physical group, or as many names as announced")?;
        let tag = words.integer("the tag of a physical group")?;
        let place = words.line();
        let rest = words.rest_of_line().trim_ascii();
        let name = rest.strip_prefix(b"\"").and_then(|name| name.strip_suffix(b"\""));
        let Some(name) = name.and_then(|name| std::str::from_utf8(name).ok()) else {
            return Err(MeshError::expected(place, "a name in quotes, in UTF-8", quoted(rest)));
        };
        let dimension = usize::try_from(dimension).ok().filter(|dimension| *dimension <= 3);
        let Some(dimension) = dimension else {
            return Err(MeshError::new(place, format!("the dimension of the group `{name}` is not 0 to 3")));
        };
        if name.len() > MAX_NAME_BYTES {
            return Err(MeshError::new(place, format!("a name of {} bytes, at most {MAX_NAME_BYTES}", name.len())));
        }
        if !name.is_empty() {
            found.names.insert((dimension, tag.saturating_abs()), name.to_owned());
        }
    }
    cursor.keyword("$EndPhysicalNames")
}
