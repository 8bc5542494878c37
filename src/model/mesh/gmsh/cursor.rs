//! Numbers of a file whatever their encoding.

use crate::model::mesh::data::error::{MeshError, MeshPlace, quoted};
use crate::model::mesh::gmsh::binary::BinaryLayout;
use crate::model::mesh::gmsh::text::Words;

/// The numbers of a section, text or binary.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    /// The file's text, and where reading has come to.
    pub words: Words<'a>,
    layout: Option<BinaryLayout>,
}

/// Bytes that numbers take at least.
#[derive(Debug, Clone, Copy, Default)]
pub struct RecordSize {
    /// Numbers of the type `int`.
    pub ints: usize,
    /// Numbers of the type `size_t`.
    pub sizes: usize,
    /// Numbers of the type `double`.
    pub doubles: usize,
}

impl<'a> Cursor<'a> {
    /// A text from its beginning.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { words: Words::new(bytes), layout: None }
    }

    /// From here on numbers are binary.
    pub fn set_layout(&mut self, layout: BinaryLayout) {
        self.layout = Some(layout);
    }

    /// Whether numbers are binary.
    pub fn is_binary(&self) -> bool {
        self.layout.is_some()
    }

    /// Where reading has come to: a line of text, or a byte.
    pub fn place(&self) -> MeshPlace {
        if self.is_binary() { MeshPlace::Byte(self.words.at() as u64) } else { self.words.line() }
    }

    fn bytes<const N: usize>(&mut self, what: &str) -> Result<[u8; N], MeshError> {
        let rest = self.words.rest();
        let Some(bytes) = rest.first_chunk::<N>() else {
            let found = format!("the end of the file after {} bytes", rest.len());
            return Err(MeshError::expected(self.place(), format_args!("{what} ({N} bytes)"), found));
        };
        self.words.skip_binary(N);
        Ok(*bytes)
    }

    /// An `int`.
    pub fn int(&mut self, what: &str) -> Result<i64, MeshError> {
        match self.layout {
            Some(layout) => Ok(i64::from(layout.int(self.bytes(what)?))),
            None => self.words.integer(what),
        }
    }

    /// An `int` of at least zero.
    pub fn natural_int(&mut self, what: &str) -> Result<u64, MeshError> {
        let place = self.place();
        match self.layout {
            Some(_) => {
                let number = self.int(what)?;
                u64::try_from(number)
                    .map_err(|_| MeshError::expected(place, format_args!("{what} of at least zero"), number))
            }
            None => self.words.natural(what),
        }
    }

    /// A `size_t`.
    pub fn size(&mut self, what: &str) -> Result<u64, MeshError> {
        match self.layout {
            Some(layout) if layout.size_bytes == 4 => Ok(layout.size(&self.bytes::<4>(what)?)),
            Some(layout) => Ok(layout.size(&self.bytes::<8>(what)?)),
            None => self.words.natural(what),
        }
    }

    /// A finite `double`.
    pub fn double(&mut self, what: &str) -> Result<f64, MeshError> {
        let place = self.place();
        match self.layout {
            Some(layout) => {
                let number = layout.double(self.bytes(what)?);
                let refused = || MeshError::expected(place, format_args!("{what}, a finite number"), number);
                number.is_finite().then_some(number).ok_or_else(refused)
            }
            None => self.words.real(what),
        }
    }

    /// Checks a count of records against the bytes that are left, so that memory is only asked for what is there.
    ///
    /// # Errors
    /// The rest of the file is too short for so many.
    pub fn fitting(&self, count: u64, record: RecordSize, what: &str) -> Result<usize, MeshError> {
        let bytes = match self.layout {
            Some(layout) => 4 * record.ints + layout.size_bytes * record.sizes + 8 * record.doubles,
            // A digit and a blank.
            None => 2 * (record.ints + record.sizes + record.doubles),
        };
        let left = self.words.rest().len() + usize::from(self.layout.is_none());
        let fits = usize::try_from(count).ok().filter(|count| count.checked_mul(bytes).is_some_and(|all| all <= left));
        fits.ok_or_else(|| {
            MeshError::new(
                self.place(),
                format!("{count} {what} are announced, which the rest of the file, {left} bytes, is too short for"),
            )
        })
    }

    /// Passes over the end of the line before binary numbers.
    pub fn begin_numbers(&mut self) -> Result<(), MeshError> {
        if !self.is_binary() {
            return Ok(());
        }
        let rest = self.words.rest_of_line();
        if rest.trim_ascii().is_empty() {
            return Ok(());
        }
        Err(MeshError::expected(self.place(), "the end of the line before binary numbers", quoted(rest)))
    }

    /// Reads a word that has to stand here.
    pub fn keyword(&mut self, keyword: &str) -> Result<(), MeshError> {
        let word = self.words.word();
        if word == keyword.as_bytes() {
            return Ok(());
        }
        Err(MeshError::expected(self.place(), format_args!("`{keyword}`"), quoted(word)))
    }
}
