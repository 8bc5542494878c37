//! Meshes from files of gmsh and from decks of Abaqus, and the models made of them.
//!
//! A mesh file is read from memory: nothing here opens a file. Every format is read in linear time, and memory is asked
//! for in proportion to the bytes that are there, whatever their header promises. Each folder imports only those before
//! it: [`data`] has the mesh, [`gmsh`] and [`abaqus`] read it, [`convert`] writes a model. No crate keeps the sets of
//! both versions of gmsh's format: `mshio` reads version 4.1 alone, without the names of groups; none reads decks.

pub mod abaqus;
pub mod convert;
pub mod data;
pub mod gmsh;

use data::error::{MeshError, MeshPlace, quoted};
use data::mesh_data::MeshData;
use serde::{Deserialize, Serialize};

/// A format of mesh files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum MeshFormat {
    /// gmsh's, versions 2.2 and 4.1.
    Gmsh,
    /// Decks of Abaqus and its kin.
    Abaqus,
}

impl MeshFormat {
    /// The format's name in a model.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gmsh => "gmsh",
            Self::Abaqus => "abaqus",
        }
    }

    /// The format by the first byte that is no blank.
    ///
    /// # Errors
    /// It is neither `$` nor `*`.
    pub fn of(bytes: &[u8]) -> Result<Self, MeshError> {
        let start = without_mark(bytes).trim_ascii_start();
        match start.first() {
            Some(b'$') => Ok(Self::Gmsh),
            Some(b'*') => Ok(Self::Abaqus),
            _ => {
                let line = start.split(|byte| *byte == b'\n').next().unwrap_or_default();
                let expected = "`$MeshFormat` of gmsh or a keyword such as `*NODE` of Abaqus";
                Err(MeshError::expected(MeshPlace::File, expected, quoted(line.trim_ascii_end())))
            }
        }
    }

    /// Reads a mesh file of this format.
    ///
    /// # Errors
    /// The first mistake, with its line or byte, what was expected and what was found.
    pub fn read(self, bytes: &[u8]) -> Result<MeshData, MeshError> {
        match self {
            Self::Gmsh => gmsh::read(without_mark(bytes)),
            Self::Abaqus => abaqus::read(without_mark(bytes)),
        }
    }
}

/// A text without the mark of UTF-8 that some editors put before it.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}
