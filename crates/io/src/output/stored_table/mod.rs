//! `trajectory.parquet` read back, whoever wrote it.
//!
//! A general decoder of Parquet believes the lengths in a file; forged ones make it ask for more memory than there is, or panic. This
//! one knows only what [`super::parquet`] writes: doubles that are never missing, in pages without a dictionary, split by bytes or
//! plain, under Snappy or as they are. It sets nothing aside because a length says so:
//!
//! - pieces of columns follow each other in the file, so that no byte is read twice;
//! - a page holds no more rows than its group lacks, and a group at most [`ROWS_PER_GROUP`];
//! - a page takes as many bytes as its rows need, before it is compressed and, by Snappy's own bound, afterwards.
//!
//! Snappy makes at most 64 bytes out of three. So the numbers take no more than 22 times the memory that the file takes on the
//! disk, and a time that is proportional to it.

mod footer;
mod thrift;

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};

use thiserror::Error;

use self::footer::Piece;
use self::thrift::{Kind, Thrift};
use super::restore_error::TableError;
use super::table::NamedColumns;

/// What such a file begins and ends with.
const MAGIC: &[u8; 4] = b"PAR1";
/// Bytes before the first number.
const HEAD: u64 = 4;
/// Bytes behind the footer: its length, and the magic once more.
const TAIL: u64 = 8;
/// Encodings of numbers in the numbers of the format.
const PLAIN: i64 = 0;
const BYTE_STREAM_SPLIT: i64 = 9;
/// Kinds of pages in the numbers of the format.
const DATA_PAGE: i64 = 0;
const DATA_PAGE_V2: i64 = 3;

/// Why a table cannot be read as Parquet that a run wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ParquetProblem {
    /// It does not begin and end as Parquet does.
    #[error("it is no Parquet file, or its end is missing")]
    NotParquet,
    /// Something is longer than what is left.
    #[error("it ends within a value")]
    Ended,
    /// Its footer, or the head of a page, says what cannot be.
    #[error("it is damaged: what it says of its own columns and rows does not hold together")]
    Malformed,
    /// Its columns do not lie one behind the other.
    #[error("it is damaged: it says that its columns lie over each other or outside of it")]
    Misplaced,
    /// What is compressed is not.
    #[error("it is damaged: what it holds does not decompress")]
    Compressed,
    /// It uses what no run uses.
    #[error("it is Parquet that no run writes: other compressions, encodings or pages")]
    NotOurs,
    /// The operating system refused.
    #[error("{0}")]
    Refused(ErrorKind),
}

impl From<std::io::Error> for ParquetProblem {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::UnexpectedEof => ParquetProblem::Ended,
            kind => ParquetProblem::Refused(kind),
        }
    }
}

/// Reads columns back, whatever their names.
pub(crate) fn read(file: File) -> Result<NamedColumns, TableError> {
    let mut file = BufReader::new(file);
    let length = file.seek(SeekFrom::End(0)).map_err(ParquetProblem::from)?;
    let end = length.checked_sub(HEAD + TAIL).ok_or(ParquetProblem::NotParquet)? + HEAD;
    if bytes_at::<4>(&mut file, 0)? != *MAGIC || bytes_at::<4>(&mut file, end + 4)? != *MAGIC {
        return Err(ParquetProblem::NotParquet.into());
    }
    let said = u64::from(u32::from_le_bytes(bytes_at(&mut file, end)?));
    let start = end.checked_sub(said).filter(|start| *start >= HEAD).ok_or(ParquetProblem::Malformed)?;
    file.seek(SeekFrom::Start(start)).map_err(ParquetProblem::from)?;
    let footer = footer::read((&mut file).take(said), start)?;

    let mut columns: NamedColumns = footer.columns.into_iter().map(|name| (name, Vec::new())).collect();
    let mut scratch = Scratch::default();
    for group in footer.groups {
        for (piece, (_, values)) in group.pieces.iter().zip(&mut columns) {
            read_piece(&mut file, *piece, group.rows, &mut scratch, values)?;
        }
    }
    Ok(columns)
}

fn bytes_at<const N: usize>(file: &mut (impl Read + Seek), at: u64) -> Result<[u8; N], ParquetProblem> {
    let mut bytes = [0; N];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// What is read into, again and again.
#[derive(Default)]
struct Scratch {
    stored: Vec<u8>,
    plain: Vec<u8>,
}

/// Reads `rows` numbers, page by page.
fn read_piece(
    file: &mut BufReader<File>,
    piece: Piece,
    rows: usize,
    scratch: &mut Scratch,
    values: &mut Vec<f64>,
) -> Result<(), ParquetProblem> {
    file.seek(SeekFrom::Start(piece.start))?;
    let mut bytes = file.take(piece.length);
    let mut missing = rows;
    while missing > 0 {
        let page = Page::read(&mut Thrift(&mut bytes), piece.compressed, missing)?;
        scratch.stored.clear();
        (&mut bytes).take(page.stored as u64).read_to_end(&mut scratch.stored)?;
        if scratch.stored.len() != page.stored {
            return Err(ParquetProblem::Ended);
        }
        let plain = if page.compressed {
            scratch.plain.resize(page.rows * size_of::<f64>(), 0);
            decompress(&scratch.stored, &mut scratch.plain)?;
            &scratch.plain
        } else {
            &scratch.stored
        };
        if page.split {
            let byte = |row: usize, k: usize| plain[k * page.rows + row];
            values.extend((0..page.rows).map(|row| f64::from_le_bytes(std::array::from_fn(|k| byte(row, k)))));
        } else {
            values.extend(plain.as_chunks().0.iter().map(|eight| f64::from_le_bytes(*eight)));
        }
        missing -= page.rows;
    }
    Ok(())
}

/// Fills `plain` whole.
fn decompress(stored: &[u8], plain: &mut [u8]) -> Result<(), ParquetProblem> {
    let fits = snap::raw::decompress_len(stored).is_ok_and(|length| length == plain.len());
    let filled = fits.then(|| snap::raw::Decoder::new().decompress(stored, plain));
    match filled {
        Some(Ok(length)) if length == plain.len() => Ok(()),
        _ => Err(ParquetProblem::Compressed),
    }
}

/// What the head of a page says, as far as it can be.
struct Page {
    /// One at least.
    rows: usize,
    /// Bytes in the file behind the head.
    stored: usize,
    compressed: bool,
    /// First bytes first, then all second ones.
    split: bool,
}

impl Page {
    /// Reads the head of a page that has `most` rows or fewer.
    fn read(thrift: &mut Thrift<impl Read>, compressed: bool, most: usize) -> Result<Page, ParquetProblem> {
        let (mut kind, mut plain, mut stored) = (None, None, None);
        let (mut rows, mut encoding, mut levels, mut compressed) = (None, None, 0, compressed);
        thrift.fields(|thrift, field| {
            match field {
                (1, Kind::Integer) => kind = Some(thrift.integer()?),
                (2, Kind::Integer) => plain = Some(thrift.integer()?),
                (3, Kind::Integer) => stored = Some(thrift.integer()?),
                (5, Kind::Struct) => thrift.fields(|thrift, field| {
                    match field {
                        (1, Kind::Integer) => rows = Some(thrift.integer()?),
                        (2, Kind::Integer) => encoding = Some(thrift.integer()?),
                        _ => return Ok(false),
                    }
                    Ok(true)
                })?,
                (8, Kind::Struct) => thrift.fields(|thrift, field| {
                    match field {
                        (1, Kind::Integer) => rows = Some(thrift.integer()?),
                        (2 | 5 | 6, Kind::Integer) => levels |= thrift.integer()?,
                        (4, Kind::Integer) => encoding = Some(thrift.integer()?),
                        (7, Kind::Bool(false)) => compressed = false,
                        _ => return Ok(false),
                    }
                    Ok(true)
                })?,
                _ => return Ok(false),
            }
            Ok(true)
        })?;
        let split = match (kind, encoding) {
            (Some(DATA_PAGE | DATA_PAGE_V2), Some(BYTE_STREAM_SPLIT)) => true,
            (Some(DATA_PAGE | DATA_PAGE_V2), Some(PLAIN)) => false,
            _ => return Err(ParquetProblem::NotOurs),
        };
        let size = |value: Option<i64>| value.and_then(|value| usize::try_from(value).ok());
        let (Some(rows), Some(plain), Some(stored)) = (size(rows), size(plain), size(stored)) else {
            return Err(ParquetProblem::Malformed);
        };
        let fits = (1..=most).contains(&rows)
            && levels == 0
            && plain == rows * size_of::<f64>()
            && if compressed { stored <= snap::raw::max_compress_len(plain) } else { stored == plain };
        if fits { Ok(Page { rows, stored, compressed, split }) } else { Err(ParquetProblem::Malformed) }
    }
}
