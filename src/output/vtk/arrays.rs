//! Arrays of VTK's XML files: base64 of the bytes, least significant first, after their number as eight bytes.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Writer;
use quick_xml::events::BytesText;
use std::io::{self, Write};

/// An array as a file has it.
#[derive(Debug, Clone)]
pub struct DataArray {
    kind: &'static str,
    name: &'static str,
    components: usize,
    /// Names of the components, or none.
    names_of_components: &'static [&'static str],
    /// Base64.
    text: String,
}

impl DataArray {
    fn new(kind: &'static str, name: &'static str, components: usize, bytes: impl Iterator<Item = u8>) -> Self {
        let mut all = vec![0; size_of::<u64>()];
        all.extend(bytes);
        let count = (all.len() - size_of::<u64>()) as u64;
        all[..size_of::<u64>()].copy_from_slice(&count.to_le_bytes());
        Self { kind, name, components, names_of_components: &[], text: STANDARD.encode(all) }
    }

    /// Numbers, each vector with as many components.
    pub fn numbers(name: &'static str, components: usize, values: &[f64]) -> Self {
        Self::new("Float64", name, components, values.iter().flat_map(|value| value.to_le_bytes()))
    }

    /// Numbers at the two ends of each element.
    pub fn at_ends(name: &'static str, values: &[f64]) -> Self {
        Self { names_of_components: &["start", "end"], ..Self::numbers(name, 2, values) }
    }

    pub fn integers(name: &'static str, values: impl Iterator<Item = i64>) -> Self {
        Self::new("Int64", name, 1, values.flat_map(i64::to_le_bytes))
    }

    pub fn bytes(name: &'static str, values: impl Iterator<Item = u8>) -> Self {
        Self::new("UInt8", name, 1, values)
    }

    /// Writes the array; `tuples` is given for arrays whose length the file does not know otherwise.
    pub fn write<To: Write>(&self, to: &mut Writer<To>, tuples: Option<usize>) -> io::Result<()> {
        let mut element = to
            .create_element("DataArray")
            .with_attribute(("type", self.kind))
            .with_attribute(("Name", self.name))
            .with_attribute(("format", "binary"));
        if self.components > 1 {
            element = element.with_attribute(("NumberOfComponents", self.components.to_string().as_str()));
        }
        for (place, name) in self.names_of_components.iter().enumerate() {
            element = element.with_attribute((format!("ComponentName{place}").as_str(), *name));
        }
        if let Some(tuples) = tuples {
            element = element.with_attribute(("NumberOfTuples", tuples.to_string().as_str()));
        }
        element.write_text_content(BytesText::from_escaped(self.text.as_str())).map(drop)
    }
}

/// Texts as an array has them: of each the bytes of its UTF-8 as numbers, ended by 0.
pub fn text_array<'t>(texts: impl Iterator<Item = &'t str>) -> String {
    let mut numbers = String::new();
    for text in texts {
        for byte in text.bytes().filter(|byte| *byte != 0) {
            numbers.push_str(&byte.to_string());
            numbers.push(' ');
        }
        numbers.push_str("0 ");
    }
    numbers.truncate(numbers.trim_end().len());
    numbers
}

/// Writes texts as [`text_array`] has them; `tuples` as for [`DataArray::write`].
pub fn write_texts<To: Write>(to: &mut Writer<To>, name: &str, numbers: &str, tuples: Option<usize>) -> io::Result<()> {
    let mut element = to
        .create_element("Array")
        .with_attribute(("type", "String"))
        .with_attribute(("Name", name))
        .with_attribute(("format", "ascii"));
    if let Some(tuples) = tuples {
        element = element.with_attribute(("NumberOfTuples", tuples.to_string().as_str()));
    }
    element.write_text_content(BytesText::from_escaped(numbers)).map(drop)
}
