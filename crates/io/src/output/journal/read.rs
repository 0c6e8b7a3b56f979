//! Reading a journal: the longest part of it from the beginning that holds.

use std::io::{self, BufReader, Read};
use std::path::Path;

use serde::de::DeserializeOwned;
use thiserror::Error;

use super::super::summary::Summary;
use super::super::table::NamedColumns;
use super::{Chain, END, FORMAT, FRAME_HEAD, HEAD, Head, MAGIC, MOST_FRAME_BYTES, MOST_TEXT_BYTES, ROWS};
use crate::files::open_file;

/// Why no rows can be read from a journal.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// It cannot be read.
    #[error("it cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// It is something else.
    #[error("it is no journal of a run")]
    NotAJournal,
    /// A later version wrote it.
    #[error("its format is {found}, and this version of forwardstep reads format {FORMAT}")]
    Newer {
        /// Its format.
        found: u32,
    },
    /// Nothing of it can be trusted.
    #[error("its head, without which the rows mean nothing, was damaged")]
    Head,
}

/// What a journal says.
#[derive(Debug)]
pub struct ReadJournal {
    /// What the rows belong to.
    pub head: Head,
    /// The rows column by column, under the names that the head gives, `t_s` first.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Of a run that ended in order.
    pub end: Option<Summary>,
    /// Bytes behind all that holds.
    pub left_out: u64,
}

/// What a journal of `length` bytes begins with, and the frames behind it.
fn opened<R: Read>(mut input: R, length: u64) -> Result<(Head, Frames<R>), JournalError> {
    let mut opening = [0; 20];
    let opened = input.read_exact(&mut opening);
    let (magic, format) = opening.split_at(MAGIC.len());
    match opened {
        Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => return Err(error.into()),
        Ok(()) if magic == MAGIC => {}
        _ => return Err(JournalError::NotAJournal),
    }
    let found = format.try_into().map(u32::from_le_bytes).unwrap_or_default();
    if found != FORMAT {
        return Err(JournalError::Newer { found });
    }
    let mut frames = Frames { input, left: length.saturating_sub(opening.len() as u64), chain: Chain::start(&opening) };
    match frames.next(0) {
        Some((HEAD, text)) => Ok((told(&text).ok_or(JournalError::Head)?, frames)),
        _ => Err(JournalError::Head),
    }
}

/// What the rows of the journal at `path` belong to; nothing where it is no journal, or its head does not hold.
pub(crate) fn head(path: &Path) -> Option<Head> {
    let file = open_file(path).ok()?;
    let length = file.metadata().ok()?.len();
    opened(BufReader::new(file), length).ok().map(|(head, _)| head)
}

/// Reads a journal of `length` bytes. What is behind a frame that does not hold is left out, whatever it says.
///
/// # Errors
/// [`JournalError`] where nothing of it can be read. No bytes panic, and a length that is not true takes no memory.
pub fn read(input: impl Read, length: u64) -> Result<ReadJournal, JournalError> {
    let (head, mut frames) = opened(input, length)?;
    let mut columns: NamedColumns = head.columns.iter().map(|name| (name.clone(), Vec::new())).collect();
    let row_bytes = 8 * columns.len();
    if row_bytes == 0 {
        return Err(JournalError::Head);
    }
    let mut end = None;
    let mut left_out = frames.left;
    while end.is_none() {
        let Some((kind, content)) = frames.next(row_bytes as u64) else { break };
        match kind {
            ROWS if content.len().is_multiple_of(row_bytes) => add_rows(&mut columns, &content, row_bytes),
            END => match told(&content) {
                Some(summary) => end = Some(summary),
                None => break,
            },
            _ => break,
        }
        left_out = frames.left;
    }
    Ok(ReadJournal { head, columns, end, left_out })
}

/// A part that is JSON; read as text like the summaries beside it, so that a reader for bytes is not compiled too.
fn told<T: DeserializeOwned>(content: &[u8]) -> Option<T> {
    serde_json::from_str(core::str::from_utf8(content).ok()?).ok()
}

fn add_rows(columns: &mut NamedColumns, content: &[u8], row_bytes: usize) {
    for row in content.chunks_exact(row_bytes) {
        for ((_, values), bytes) in columns.iter_mut().zip(row.chunks_exact(8)) {
            values.extend(bytes.try_into().map(f64::from_le_bytes));
        }
    }
}

/// The frames that follow one another.
struct Frames<R> {
    input: R,
    /// Bytes that are not looked at yet.
    left: u64,
    chain: Chain,
}

impl<R: Read> Frames<R> {
    /// The next frame, its kind and its content, if there is one and it holds.
    fn next(&mut self, row_bytes: u64) -> Option<(u32, Vec<u8>)> {
        let mut head = [0; FRAME_HEAD];
        self.left.checked_sub(FRAME_HEAD as u64)?;
        self.input.read_exact(&mut head).ok()?;
        let kind = u32::from_le_bytes(head[..4].try_into().ok()?);
        let length = u64::from_le_bytes(head[4..12].try_into().ok()?);
        let most = if kind == ROWS { row_bytes.max(MOST_FRAME_BYTES as u64) } else { MOST_TEXT_BYTES };
        let left = self.left.checked_sub(FRAME_HEAD as u64)?.checked_sub(length)?;
        if length > most {
            return None;
        }
        // Room is made as bytes come: a length alone takes no memory.
        let mut content = Vec::new();
        self.input.by_ref().take(length).read_to_end(&mut content).ok()?;
        if content.len() as u64 != length || self.chain.next(kind, &content) != head[12..] {
            return None;
        }
        self.left = left;
        Some((kind, content))
    }
}
