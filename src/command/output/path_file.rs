//! The file of a path, in the format that its extension names.

use crate::check::judged::JudgedIncrement;
use crate::command::output::outcome::Failure;
use crate::command::output::written::{extension, is_standard_output};
use crate::model::JobRequest;
use crate::output::parquet::PathTable;
use crate::output::parquet::tables::PathSheets;
use crate::output::vtk::{Collection, Grid};
use crate::output::{Table, json_line};
use parquet::errors::ParquetError;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The format of a path's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// One JSON object per line.
    Ndjson,
    /// A table with named columns.
    Csv,
    /// For ParaView: a list, and beside it a folder of the same name with a `.vtu` file for each increment.
    Pvd,
    /// Apache Parquet: increments, and beside them nodes, elements and contacts in files of their own.
    Parquet,
}

impl Format {
    /// The format that is asked for, or else that of the extension.
    ///
    /// # Errors
    /// The extension names no format or another than is asked for, or the format is of several files and goes to standard output.
    pub fn of(asked: Option<Self>, place: &Path) -> Result<Self, Failure> {
        let extension = extension(place);
        let named = match extension.as_deref() {
            Some("ndjson" | "jsonl") => Some(Self::Ndjson),
            Some("csv") => Some(Self::Csv),
            Some("pvd") => Some(Self::Pvd),
            Some("parquet") => Some(Self::Parquet),
            _ => None,
        };
        let format = match (asked, named, extension.as_deref()) {
            (Some(format), Some(named), Some(extension)) if format != named => {
                let what =
                    format!("--format says {format:?} and the extension of --out says `{extension}`; leave one out");
                return Err(Failure::Input(vec![what.to_lowercase()]));
            }
            (Some(format), ..) | (None, Some(format), _) => format,
            (None, None, None) => Self::Ndjson,
            (None, None, Some(other)) => {
                let known = "`ndjson`, `csv`, `pvd` (ParaView) and `parquet` do, or give --format";
                return Err(Failure::Input(vec![format!("--out: the extension `{other}` names no format; {known}")]));
            }
        };
        if is_standard_output(place) && matches!(format, Self::Pvd | Self::Parquet) {
            let example = if format == Self::Pvd { "path.pvd" } else { "path.parquet" };
            let what = format!("--out: this format is of several files; give the name of one, such as `{example}`");
            return Err(Failure::Input(vec![what]));
        }
        Ok(format)
    }
}

/// A path's file that is being written, increment by increment.
pub enum PathFile {
    Lines(Box<dyn Write>),
    Csv { to: Box<dyn Write>, table: Box<Table>, begun: bool },
    Pvd(Box<PvdFile>),
    Parquet(Box<PathSheets<BufWriter<File>>>),
}

/// A list of files, complete after every increment, and the folder of the files.
pub struct PvdFile {
    list: File,
    folder: PathBuf,
    folder_name: String,
    grid: Grid,
    collection: Collection,
}

impl PathFile {
    /// # Errors
    /// A file or folder cannot be made.
    pub fn open(place: &Path, format: Format, request: &JobRequest) -> Result<Self, Failure> {
        Self::open_branch(place, format, request, "")
    }

    /// The same for a path that leaves another one; `branch` tells it from that one.
    ///
    /// # Errors
    /// As for [`open`](Self::open).
    pub fn open_branch(place: &Path, format: Format, request: &JobRequest, branch: &str) -> Result<Self, Failure> {
        let failed = |error: io::Error| Failure::Other(format!("{}: {error}", place.display()));
        let plain = || -> io::Result<Box<dyn Write>> {
            Ok(if is_standard_output(place) { Box::new(io::stdout()) } else { Box::new(File::create(place)?) })
        };
        Ok(match format {
            Format::Ndjson => Self::Lines(plain().map_err(failed)?),
            Format::Csv => {
                Self::Csv { to: plain().map_err(failed)?, table: Box::new(Table::of(request)), begun: false }
            }
            Format::Pvd => Self::Pvd(Box::new(PvdFile::open(place, request, branch).map_err(failed)?)),
            Format::Parquet => {
                let open = |table| Ok(BufWriter::new(File::create(file_of(place, table))?));
                let sheets = PathSheets::new(&request.model, open);
                Self::Parquet(Box::new(sheets.map_err(|error| failed(from_parquet(error)))?))
            }
        })
    }

    /// Writes an increment. Lines, rows and the files of `.pvd` are there at once, those of Parquet when many are.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&mut self, judged: &JudgedIncrement) -> io::Result<()> {
        match self {
            Self::Lines(to) => {
                to.write_all((json_line(judged)? + "\n").as_bytes())?;
                to.flush()
            }
            Self::Csv { to, table, begun } => {
                let header = if std::mem::replace(begun, true) { String::new() } else { table.header() };
                to.write_all((header + &table.row(&judged.increment, Some(&judged.measure))).as_bytes())?;
                to.flush()
            }
            Self::Pvd(file) => file.write(judged),
            Self::Parquet(sheets) => sheets.push(&judged.increment, Some(&judged.measure)).map_err(from_parquet),
        }
    }

    /// Writes the end of files that have one.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(self) -> io::Result<()> {
        match self {
            Self::Parquet(sheets) => sheets.finish().map_err(from_parquet),
            Self::Lines(_) | Self::Csv { .. } | Self::Pvd(_) => Ok(()),
        }
    }
}

/// The file of a table: that of the increments has the name as given, the others a word before the extension.
fn file_of(place: &Path, table: PathTable) -> PathBuf {
    if table == PathTable::Increments {
        return place.to_owned();
    }
    let mut name = place.file_stem().map_or_else(OsString::new, OsString::from);
    name.push(format!(".{}.parquet", table.name()));
    place.with_file_name(name)
}

fn from_parquet(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(error) => io::Error::other(error),
        error => io::Error::other(error),
    }
}

/// Removes the files of an earlier path, which viewers would take for a part of this one; others stay.
fn remove_pieces(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| name.strip_suffix(".vtu"));
        if number.is_some_and(|number| number.len() >= 6 && number.bytes().all(|byte| byte.is_ascii_digit())) {
            std::fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

impl PvdFile {
    fn open(place: &Path, request: &JobRequest, branch: &str) -> io::Result<Self> {
        let folder = place.with_extension("");
        // A name without extension is the folder's own.
        let folder = if folder == place { place.with_extension("pieces") } else { folder };
        std::fs::create_dir_all(&folder).map_err(|error| {
            let what = format!("the folder {} of its pieces cannot be made: {error}", folder.display());
            io::Error::new(error.kind(), what)
        })?;
        remove_pieces(&folder)?;
        let folder_name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let mut list = File::create(place)?;
        list.write_all(Collection::HEAD.as_bytes())?;
        list.write_all(Collection::TAIL.as_bytes())?;
        Ok(Self { list, folder, folder_name, grid: Grid::of(request, branch), collection: Collection::default() })
    }

    fn write(&mut self, judged: &JudgedIncrement) -> io::Result<()> {
        let increment = &judged.increment;
        let name = format!("{:06}.vtu", increment.index);
        let mut piece = BufWriter::new(File::create(self.folder.join(&name))?);
        self.grid.write(increment, &mut piece)?;
        piece.flush()?;
        let entry = self.collection.entry(increment.arc_length, &format!("{}/{name}", self.folder_name));
        self.list.seek(SeekFrom::End(-i64::try_from(Collection::TAIL.len()).unwrap_or(0)))?;
        self.list.write_all((entry + Collection::TAIL).as_bytes())
    }
}
