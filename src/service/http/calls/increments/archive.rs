//! A zip file that is sent while it is made. Its bytes depend on the files in it alone: their times are not written.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

/// The bytes that are made and not yet sent.
#[derive(Clone, Default)]
pub struct Made(Arc<Mutex<Vec<u8>>>);

impl Made {
    /// The bytes made since they were last taken.
    pub fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.bytes())
    }

    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for Made {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A zip file that grows.
pub struct Archive {
    zip: ZipWriter<StreamWriter<Made>>,
    made: Made,
}

impl Default for Archive {
    fn default() -> Self {
        let made = Made::default();
        Self { zip: ZipWriter::new_stream(made.clone()), made }
    }
}

impl Archive {
    /// Begins a file; what is written next belongs to it.
    ///
    /// # Errors
    /// The name cannot be that of a file in an archive.
    pub fn begin(&mut self, name: &str, method: CompressionMethod) -> io::Result<()> {
        // The level that costs least: what is sent changes little by more, and it is made while it is waited for.
        let level = (method == CompressionMethod::Deflated).then_some(1);
        let options = SimpleFileOptions::default().compression_method(method).compression_level(level);
        Ok(self.zip.start_file(name, options.large_file(true))?)
    }

    /// The bytes made since they were last taken.
    pub fn take(&self) -> Vec<u8> {
        self.made.take()
    }

    /// What [`take`](Self::take) takes from, for when the archive is lent to the writer of a file.
    pub fn made(&self) -> Made {
        self.made.clone()
    }

    /// Writes the list of files, and returns the last bytes.
    ///
    /// # Errors
    /// The list cannot be written.
    pub fn finish(self) -> io::Result<Vec<u8>> {
        let Self { zip, made } = self;
        drop(zip.finish()?);
        Ok(made.take())
    }
}

impl Write for Archive {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.zip.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.zip.flush()
    }
}
