//! Writes a Parquet file row by row. Rows are kept until a group is full, so that memory is bounded.

use parquet::basic::{Compression, ConvertedType, Repetition, Type as PhysicalType};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::io::Write;
use std::sync::Arc;

/// Cells of a group. Each takes 8 bytes, texts as many as they have.
const CELLS_OF_A_GROUP: usize = 1 << 20;

/// What the cells of a column hold. Any cell may be empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Integer,
    Number,
    Text,
    Flag,
}

/// A value of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    Integer(u64),
    Number(f64),
    Text(&'a str),
    Flag(bool),
    Empty,
}

impl From<Option<f64>> for Cell<'_> {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Cell::Empty, Cell::Number)
    }
}

/// The cells of a column that are not yet written, and of every row whether it has one.
enum Values {
    Integers(Vec<i64>),
    Numbers(Vec<f64>),
    Texts(Vec<ByteArray>),
    Flags(Vec<bool>),
}

struct Column {
    values: Values,
    is_present: Vec<i16>,
}

/// A Parquet file that is being written.
pub struct Sheet<To: Write + Send> {
    file: SerializedFileWriter<To>,
    columns: Vec<Column>,
    rows: usize,
}

impl<To: Write + Send> Sheet<To> {
    /// A file with columns of these names and kinds; `about` is what readers find beside the columns, by key.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn new(to: To, columns: &[(String, Kind)], about: Vec<KeyValue>) -> Result<Self> {
        let fields = columns.iter().map(|(name, kind)| {
            let (physical, converted) = match kind {
                Kind::Integer => (PhysicalType::INT64, ConvertedType::NONE),
                Kind::Number => (PhysicalType::DOUBLE, ConvertedType::NONE),
                Kind::Text => (PhysicalType::BYTE_ARRAY, ConvertedType::UTF8),
                Kind::Flag => (PhysicalType::BOOLEAN, ConvertedType::NONE),
            };
            let field = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
            field.with_converted_type(converted).build().map(Arc::new)
        });
        let schema = Type::group_type_builder("path").with_fields(fields.collect::<Result<_>>()?).build()?;
        let about = (!about.is_empty()).then_some(about);
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).set_key_value_metadata(about);
        let properties = properties.build();
        let file = SerializedFileWriter::new(to, Arc::new(schema), Arc::new(properties))?;
        let columns = columns.iter().map(|(_, kind)| Column {
            values: match kind {
                Kind::Integer => Values::Integers(Vec::new()),
                Kind::Number => Values::Numbers(Vec::new()),
                Kind::Text => Values::Texts(Vec::new()),
                Kind::Flag => Values::Flags(Vec::new()),
            },
            is_present: Vec::new(),
        });
        Ok(Self { file, columns: columns.collect(), rows: 0 })
    }

    /// Adds a row; a cell of another kind than its column's is an error, as is a row of another length.
    ///
    /// # Errors
    /// The row does not fit the columns, or the file cannot be written.
    pub fn push(&mut self, row: &[Cell<'_>]) -> Result<()> {
        if row.len() != self.columns.len() {
            let (cells, columns) = (row.len(), self.columns.len());
            return Err(ParquetError::General(format!("a row of {cells} cells in a table of {columns} columns")));
        }
        for (column, cell) in self.columns.iter_mut().zip(row) {
            match (&mut column.values, cell) {
                (Values::Integers(values), Cell::Integer(value)) => {
                    values.push(i64::try_from(*value).map_err(|error| ParquetError::External(Box::new(error)))?);
                }
                (Values::Numbers(values), Cell::Number(value)) => values.push(*value),
                (Values::Texts(values), Cell::Text(value)) => values.push(ByteArray::from(*value)),
                (Values::Flags(values), Cell::Flag(value)) => values.push(*value),
                (_, Cell::Empty) => {}
                (_, cell) => return Err(ParquetError::General(format!("{cell:?} in a column of another kind"))),
            }
            column.is_present.push(i16::from(*cell != Cell::Empty));
        }
        self.rows += 1;
        if self.rows * self.columns.len() >= CELLS_OF_A_GROUP { self.write_group() } else { Ok(()) }
    }

    fn write_group(&mut self) -> Result<()> {
        if self.rows == 0 {
            return Ok(());
        }
        let mut group = self.file.next_row_group()?;
        for column in &mut self.columns {
            let Some(mut writer) = group.next_column()? else { break };
            let present = Some(column.is_present.as_slice());
            match (writer.untyped(), &mut column.values) {
                (ColumnWriter::Int64ColumnWriter(writer), Values::Integers(values)) => {
                    writer.write_batch(values, present, None)?;
                    values.clear();
                }
                (ColumnWriter::DoubleColumnWriter(writer), Values::Numbers(values)) => {
                    writer.write_batch(values, present, None)?;
                    values.clear();
                }
                (ColumnWriter::ByteArrayColumnWriter(writer), Values::Texts(values)) => {
                    writer.write_batch(values, present, None)?;
                    values.clear();
                }
                (ColumnWriter::BoolColumnWriter(writer), Values::Flags(values)) => {
                    writer.write_batch(values, present, None)?;
                    values.clear();
                }
                _ => return Err(ParquetError::General("a column of another kind than planned".to_owned())),
            }
            writer.close()?;
            column.is_present.clear();
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }

    /// Writes what is left and the end of the file; without it the file cannot be read.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self) -> Result<To> {
        self.write_group()?;
        self.file.into_inner()
    }
}
