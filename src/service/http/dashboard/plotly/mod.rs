//! Plotly's script (MIT licence, see `LICENSE`): `plotly.js.gz`, which `trim.py` makes of the released one.

use crate::service::http::answer::embedded::{Packed, SCRIPT};

/// The name of the script in the page.
pub const NAME: &str = "plotly.js";

/// The script.
pub static PLOTLY: Packed = Packed::new(include_bytes!("plotly.js.gz"), SCRIPT);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plotly_is_one_script_without_mathjax_and_quick_to_start() {
        let text = PLOTLY.text();
        assert!(text.contains("plotly.js v") && !text.contains("</script"));
        assert!(text.contains("Licensed under the MIT license"));
        assert!(text.contains(".register([])") && text.ends_with("window.Plotly = Plotly;"), "it is quick to start");
        assert!((3_000_000..5_000_000).contains(&text.len()), "{}", text.len());
        assert!(3 * PLOTLY.compressed_size() < text.len());
    }
}
