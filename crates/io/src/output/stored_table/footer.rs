//! What the end of a table says: its columns, and where in the file their numbers are.

use std::io::Read;

use super::super::parquet::ROWS_PER_GROUP;
use super::thrift::{Kind, Thrift};
use super::{HEAD, ParquetProblem};
use crate::files::MOST_BYTES;
use crate::output::TableError;

/// `DOUBLE` and `REQUIRED` in the numbers of the format.
const DOUBLE: i64 = 5;
const REQUIRED: i64 = 0;
const UNCOMPRESSED: i64 = 0;
const SNAPPY: i64 = 1;

/// A footer that holds together: every piece lies behind the one before it and before the footer.
#[derive(Debug)]
pub(super) struct Footer {
    pub(super) columns: Vec<String>,
    pub(super) groups: Vec<Group>,
}

/// Rows that were written together.
#[derive(Debug)]
pub(super) struct Group {
    /// At most [`ROWS_PER_GROUP`].
    pub(super) rows: usize,
    /// One for every column.
    pub(super) pieces: Vec<Piece>,
}

/// The numbers of one column in one group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Its first byte in the file.
    pub(super) start: u64,
    /// How many bytes it takes.
    pub(super) length: u64,
    /// By Snappy.
    pub(super) compressed: bool,
}

/// Reads a footer; all that it speaks of must lie before the byte `start` of the file, where it begins.
pub(super) fn read(from: impl Read, start: u64) -> Result<Footer, TableError> {
    let (mut columns, mut groups) = (Vec::new(), Vec::new());
    let (mut rows, mut numbers, mut free) = (None, Ok(()), HEAD);
    let mut thrift = Thrift(from);
    let read = thrift.fields(|thrift, field| {
        match field {
            (2, Kind::List) => {
                let mut first = true;
                thrift.structures(|thrift| {
                    // The first is the table itself.
                    let column = column(thrift)?;
                    if !std::mem::take(&mut first) {
                        if !column.is_number && numbers.is_ok() {
                            numbers = Err(TableError::NotNumbers { column: column.name.clone() });
                        }
                        columns.push(column.name);
                    }
                    Ok(())
                })?;
            }
            (3, Kind::Integer) => rows = Some(thrift.integer()?),
            (4, Kind::List) => thrift.structures(|thrift| {
                groups.push(group(thrift, columns.len(), &mut free, start)?);
                Ok(())
            })?,
            _ => return Ok(false),
        }
        Ok(true)
    });
    // Columns of another kind explain everything behind them that is strange.
    numbers?;
    read?;
    let found: usize = groups.iter().map(|group: &Group| group.rows).sum();
    if columns.is_empty() || rows != i64::try_from(found).ok() {
        return Err(ParquetProblem::Malformed.into());
    }
    Ok(Footer { columns, groups })
}

struct Column {
    name: String,
    is_number: bool,
}

fn column(thrift: &mut Thrift<impl Read>) -> Result<Column, ParquetProblem> {
    let (mut name, mut kind, mut repetition, mut children) = (None, None, None, None);
    thrift.fields(|thrift, field| {
        match field {
            (1, Kind::Integer) => kind = Some(thrift.integer()?),
            (3, Kind::Integer) => repetition = Some(thrift.integer()?),
            // Names of agents enter, which a scenario gives.
            (4, Kind::Bytes) => name = Some(thrift.text(MOST_BYTES)?),
            (5, Kind::Integer) => children = Some(thrift.integer()?),
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    let is_number = kind == Some(DOUBLE) && repetition == Some(REQUIRED) && children.is_none();
    Ok(Column { name: name.ok_or(ParquetProblem::Malformed)?, is_number })
}

fn group(thrift: &mut Thrift<impl Read>, columns: usize, free: &mut u64, end: u64) -> Result<Group, ParquetProblem> {
    let (mut rows, mut pieces) = (None, Vec::new());
    thrift.fields(|thrift, field| {
        match field {
            (1, Kind::List) => thrift.structures(|thrift| {
                let piece = piece(thrift)?;
                let after = piece.start.checked_add(piece.length);
                if piece.start < *free || after.is_none_or(|after| after > end) || pieces.len() == columns {
                    return Err(ParquetProblem::Misplaced);
                }
                *free = piece.start + piece.length;
                pieces.push(piece);
                Ok(())
            })?,
            (3, Kind::Integer) => rows = Some(thrift.integer()?),
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    let rows = rows.and_then(|rows| usize::try_from(rows).ok()).filter(|rows| *rows <= ROWS_PER_GROUP);
    let rows = rows.ok_or(ParquetProblem::Malformed)?;
    if columns == 0 || pieces.len() != columns {
        return Err(ParquetProblem::Malformed);
    }
    Ok(Group { rows, pieces })
}

fn piece(thrift: &mut Thrift<impl Read>) -> Result<Piece, ParquetProblem> {
    let mut found = None;
    thrift.fields(|thrift, field| match field {
        (3, Kind::Struct) => {
            found = Some(numbers(thrift)?);
            Ok(true)
        }
        // The numbers of a column may stand in another file: never in ours.
        (1, Kind::Bytes) => Err(ParquetProblem::NotOurs),
        _ => Ok(false),
    })?;
    found.ok_or(ParquetProblem::Malformed)
}

fn numbers(thrift: &mut Thrift<impl Read>) -> Result<Piece, ParquetProblem> {
    let (mut start, mut length, mut codec) = (None, None, None);
    thrift.fields(|thrift, field| {
        match field {
            (4, Kind::Integer) => codec = Some(thrift.integer()?),
            (7, Kind::Integer) => length = Some(thrift.integer()?),
            (9, Kind::Integer) => start = Some(thrift.integer()?),
            (11, Kind::Integer) => return Err(ParquetProblem::NotOurs),
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    let compressed = match codec {
        Some(UNCOMPRESSED) => false,
        Some(SNAPPY) => true,
        _ => return Err(ParquetProblem::NotOurs),
    };
    let number = |value: Option<i64>| value.and_then(|value| u64::try_from(value).ok());
    match (number(start), number(length)) {
        (Some(start), Some(length)) => Ok(Piece { start, length, compressed }),
        _ => Err(ParquetProblem::Malformed),
    }
}
