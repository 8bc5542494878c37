//! Numbers of binary files.

/// How a binary file holds its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BinaryLayout {
    /// The most significant byte comes first.
    pub big_endian: bool,
    /// Bytes of a tag or a count in version 4.1: 4 or 8.
    pub size_bytes: usize,
}

impl BinaryLayout {
    /// An `int` from its 4 bytes.
    pub fn int(self, bytes: [u8; 4]) -> i32 {
        if self.big_endian { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) }
    }

    /// A `double` from its 8 bytes.
    pub fn double(self, bytes: [u8; 8]) -> f64 {
        if self.big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
    }

    /// A `size_t` from its bytes.
    pub fn size(self, bytes: &[u8]) -> u64 {
        let digit = |number: u64, byte: &u8| (number << 8) | u64::from(*byte);
        if self.big_endian { bytes.iter().fold(0, digit) } else { bytes.iter().rev().fold(0, digit) }
    }
}
