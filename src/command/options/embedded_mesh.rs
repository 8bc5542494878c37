//! Puts the mesh file that a request names into the request: `{"file": "part.msh"}` becomes `{"content": "..."}`.
//!
//! The rest of the text stays as it is, byte by byte, so that mistakes are told at their places.

use crate::model::input::limits::MAX_TEXT_BYTES;
use crate::model::request::{ContentEncoding, MeshFile};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::io::Read;
use std::path::Path;

#[derive(Deserialize)]
struct RawRequest<'a> {
    #[serde(borrow)]
    model: Option<&'a RawValue>,
}

#[derive(Deserialize)]
struct RawModel<'a> {
    #[serde(borrow)]
    mesh: Option<&'a RawValue>,
}

/// The text of a request with the contents of its mesh file, whose path is relative to the folder of the request's; the
/// text as it is where it names none, or is no request.
///
/// # Errors
/// The mesh file cannot be read; in words.
pub fn embed(text: Vec<u8>, request: &Path) -> Result<Vec<u8>, String> {
    let Some((place, mut mesh)) = named(&text) else { return Ok(text) };
    let Some(file) = mesh.file.take().filter(|_| mesh.content.is_none()) else { return Ok(text) };
    let path = request.parent().unwrap_or(Path::new("")).join(&file);
    let at_fault = |error: &dyn std::fmt::Display| format!("/model/mesh/file: {}: {error}", path.display());
    // A request may not be longer, whatever it holds.
    let mut bytes = Vec::new();
    let mut opened = std::fs::File::open(&path).map_err(|error| at_fault(&error))?.take(MAX_TEXT_BYTES as u64 + 1);
    opened.read_to_end(&mut bytes).map_err(|error| at_fault(&error))?;
    if bytes.len() > MAX_TEXT_BYTES {
        return Err(at_fault(&format_args!("the file has more than {MAX_TEXT_BYTES} bytes, as many as are taken")));
    }
    match String::from_utf8(bytes) {
        Ok(content) => mesh.content = Some(content),
        Err(binary) => {
            mesh.content = Some(STANDARD.encode(binary.as_bytes()));
            mesh.encoding = Some(ContentEncoding::Base64);
        }
    }
    let mesh = serde_json::to_string(&mesh).map_err(|error| error.to_string())?;
    Ok([&text[..place.start], mesh.as_bytes(), &text[place.end..]].concat())
}

/// The mesh of a request that names a file, and the bytes where it stands.
fn named(text: &[u8]) -> Option<(std::ops::Range<usize>, MeshFile)> {
    let request: RawRequest<'_> = serde_json::from_slice(text).ok()?;
    let model: RawModel<'_> = serde_json::from_str(request.model?.get()).ok()?;
    let raw = model.mesh?.get();
    // A borrowed part of the text.
    let start = (raw.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    let mesh: MeshFile = serde_json::from_str(raw).ok()?;
    mesh.file.as_ref()?;
    Some((start..start + raw.len(), mesh))
}
