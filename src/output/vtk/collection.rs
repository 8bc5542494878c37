//! The list of the files of a path (`.pvd`).

use quick_xml::escape::escape;

/// The list as it grows.
///
/// Viewers take files of one time for parts of one picture. Where the arc length stands still (a stage begins, a contact
/// changes at the point before), the time is therefore the next larger number.
#[derive(Debug, Default)]
pub struct Collection {
    time: Option<f64>,
}

impl Collection {
    /// What stands before the entries.
    pub const HEAD: &'static str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
                                    byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<Collection>\n";

    /// What stands behind the entries.
    pub const TAIL: &'static str = "</Collection>\n</VTKFile>\n";

    /// The entry of an increment's file.
    pub fn entry(&mut self, arc_length: f64, file: &str) -> String {
        let time = self.time.map_or(arc_length, |before| arc_length.max(before.next_up()));
        self.time = Some(time);
        format!("<DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{}\"/>\n", escape(file))
    }
}
