//! `rows.journal`: the rows of a run while it runs.
//!
//! A run that takes longer than a second writes it, at most once per second, and brings it to the disk each time. It vanishes when the
//! tables are whole under their names. Where it stands, the run was cut off (or its tables could not be written), and it has all that
//! [`super::SavedRun`] needs. All numbers are little-endian:
//!
//! | bytes | content |
//! |---|---|
//! | 16 | `forwardstep rows` |
//! | 4 | the format, 1 |
//! | then frames | |
//! | 4 | kind: 1 head, 2 rows, 3 end |
//! | 8 | length of what follows the checksum |
//! | 16 | checksum: the first half of BLAKE3 (chain ‖ kind ‖ length ‖ content) |
//! | length | content |
//!
//! The chain is BLAKE3 of the first twenty bytes for the first frame, and the whole hash of the frame before for every other: a frame holds
//! behind those it was written behind and nowhere else. The first frame is the head, a JSON object: the scenario's text, the files
//! that it names, the columns, and a summary of the run before its first step with the version and the scenario's digest. A frame of rows
//! holds rows one after the other, every row its time and its columns as `f64`. The end, a whole `summary.json`, stands behind the last row of
//! a run that ended in order; behind it stands nothing.
//!
//! A reader takes frames as long as they hold and leaves out the rest. A writer appends to a file that it made itself, and after a
//! write or a sync that failed never again: nothing stands behind a torn frame. It cuts that off, if it can, since the tables need the space.

mod read;
mod write;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::summary::Summary;

pub(crate) use read::head;
pub use read::{JournalError, ReadJournal, read};
pub use write::Journal;

/// Its name in the folder of a run.
pub(crate) use crate::scenario::run_folder::JOURNAL;

const MAGIC: &[u8; 16] = b"forwardstep rows";
const FORMAT: u32 = 1;
const HEAD: u32 = 1;
const ROWS: u32 = 2;
const END: u32 = 3;
/// Kind, length and checksum.
const FRAME_HEAD: usize = 28;
/// A frame of rows holds no more, unless it is one row, so that a reader need not hold more at once, and where a disk is full most of the
/// rows are in frames that are whole.
const FRAME_BYTES: usize = 1 << 16;
/// Earlier versions wrote longer ones.
const MOST_FRAME_BYTES: usize = 1 << 24;
/// More text than this no head and no end has: what a scenario names is bounded, and a length that is not true must not take all memory.
const MOST_TEXT_BYTES: u64 = 1 << 30;

/// What the rows belong to.
#[derive(Debug, Serialize, Deserialize)]
pub struct Head {
    /// The names of the columns as in the tables, `t_s` first.
    pub columns: Vec<String>,
    /// The digest of the summary that stood in the folder when the run began: that of another run, which this one is to replace.
    pub replaces_blake3: Option<String>,
    /// The text of the scenario.
    pub scenario: String,
    /// The files that the scenario names, by their names in it.
    pub inputs: Vec<(String, String)>,
    /// What is known before the first step.
    pub summary: Summary,
}

/// Frames one behind the other.
#[derive(Default)]
struct Frames {
    bytes: Vec<u8>,
    /// Where each ends.
    ends: Vec<usize>,
}

/// What the checksum of the next frame begins with.
struct Chain([u8; 32]);

impl Chain {
    fn start(opening: &[u8]) -> Self {
        Chain(blake3::hash(opening).into())
    }

    /// Adds a frame.
    fn frame(&mut self, frames: &mut Frames, kind: u32, content: &[u8]) {
        let checksum = self.next(kind, content);
        let bytes = &mut frames.bytes;
        bytes.extend(kind.to_le_bytes());
        bytes.extend((content.len() as u64).to_le_bytes());
        bytes.extend(checksum);
        bytes.extend(content);
        frames.ends.push(bytes.len());
    }

    /// The checksum of the next frame, whose content is `content`.
    fn next(&mut self, kind: u32, content: &[u8]) -> [u8; 16] {
        let mut hasher = blake3::Hasher::new();
        hasher
            .update(&self.0)
            .update(&kind.to_le_bytes())
            .update(&(content.len() as u64).to_le_bytes())
            .update(content);
        self.0 = hasher.finalize().into();
        let mut half = [0; 16];
        half.copy_from_slice(&self.0[..16]);
        half
    }
}

/// Whether the file at `path` begins as a journal does, whole or torn.
pub(crate) fn is_one(path: &Path) -> bool {
    let mut first = Vec::new();
    let read = File::open(path).and_then(|file| file.take(MAGIC.len() as u64).read_to_end(&mut first));
    read.is_ok() && MAGIC.starts_with(&first)
}

/// The first twenty bytes.
fn opening() -> Vec<u8> {
    [MAGIC.as_slice(), &FORMAT.to_le_bytes()].concat()
}
