//! The file of a picture, in the format that its extension names.

use crate::command::output::outcome::Failure;
use crate::command::output::written::{extension, write, write_file};
use crate::studies::picture::raster::png;
use std::path::Path;

/// Where a picture goes; without an extension, and on standard output, it is SVG.
#[derive(Debug, Clone, Copy)]
pub struct PictureFile<'a> {
    place: &'a Path,
    is_png: bool,
}

impl<'a> PictureFile<'a> {
    /// `option`: the name of the option that gives the place.
    ///
    /// # Errors
    /// The extension names another format than SVG and PNG.
    pub fn of(option: &str, place: Option<&'a Path>) -> Result<Option<Self>, Failure> {
        let Some(place) = place else { return Ok(None) };
        let is_png = match extension(place).as_deref() {
            None | Some("svg") => false,
            Some("png") => true,
            Some(other) => {
                let what =
                    format!("{option}: the extension `{other}` names no format of a picture; `svg` and `png` do");
                return Err(Failure::Input(vec![what]));
            }
        };
        Ok(Some(Self { place, is_png }))
    }

    /// # Errors
    /// The picture cannot be drawn, or the file cannot be written.
    pub fn write(self, svg: &str) -> Result<(), Failure> {
        if !self.is_png {
            return write(self.place, svg);
        }
        write_file(self.place, &png(svg).map_err(Failure::other)?)
    }
}
