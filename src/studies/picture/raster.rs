//! Pictures as PNG, made of their SVG.
//!
//! Texts are drawn with the fonts in `fonts`, and with no others, so that a picture is the same on every machine.

use crate::studies::picture::PlotError;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// Pixels of the PNG for each of the SVG, so that texts can be read on fine screens and in print.
const SCALE: f32 = 2.0;
const FAMILY: &str = "DejaVu Sans";
const FONTS: [&[u8]; 2] = [include_bytes!("fonts/DejaVuSans.ttf"), include_bytes!("fonts/DejaVuSans-Bold.ttf")];

/// The picture as a PNG file, with twice the width and height of the SVG.
///
/// # Errors
/// The text is no SVG, or the picture is too large.
pub fn png(svg: &str) -> Result<Vec<u8>, PlotError> {
    let mut options = Options { font_family: FAMILY.to_owned(), ..Options::default() };
    let fonts = Arc::make_mut(&mut options.fontdb);
    FONTS.iter().for_each(|font| fonts.load_font_data(font.to_vec()));
    fonts.set_sans_serif_family(FAMILY);
    let failed = |error: &dyn std::fmt::Display| PlotError::Drawing(error.to_string());
    let tree = Tree::from_str(svg, &options).map_err(|error| failed(&error))?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let sheet = size.and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut sheet = sheet.ok_or_else(|| failed(&"it is too large for a PNG"))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut sheet.as_mut());
    sheet.encode_png().map_err(|error| failed(&error))
}

#[cfg(test)]
mod tests {
    use super::png;
    use crate::studies::picture::shapes::{INK, Lettering, svg};
    use resvg::tiny_skia::Pixmap;

    /// Dark pixels in the part of a picture that has a text.
    fn ink(text: &str) -> usize {
        let lettering = Lettering { size: 20, color: &INK, bold: false, centred: false };
        let drawn = svg(200, 40, |sheet| lettering.write(sheet, (50, 200), text, 20)).expect("a picture");
        let picture = Pixmap::decode_png(&png(&drawn).expect("a PNG")).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (400, 80));
        picture.pixels().iter().filter(|pixel| pixel.red() < 128 && pixel.alpha() == 255).count()
    }

    #[test]
    fn texts_are_drawn() {
        assert_eq!(ink(""), 0);
        let [one, many, greek] = ["l", "load factor λ", "μ"].map(ink);
        assert!(one > 20 && greek > one && many > 5 * one, "{one} {greek} {many}");
        assert!(matches!(png("no picture"), Err(crate::studies::picture::PlotError::Drawing(_))));
    }
}
