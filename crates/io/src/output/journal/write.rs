//! Writing a journal while a run goes on.

use std::io::{self, ErrorKind};
use std::ops::ControlFlow;
use std::time::Duration;

use forwardstep_sim::RowSink;

use super::super::disk::DiskFile;
use super::super::error::{Action, EncodeError, OutputError};
use super::super::folder::{RunFolder, SEAL, io_error};
use super::super::inputs::file_digest;
use super::super::metrics::Metrics;
use super::super::names;
use super::super::record::RunRecord;
use super::super::summary::Summary;
use super::{Chain, END, FRAME_BYTES, Frames, HEAD, Head, JOURNAL, MOST_TEXT_BYTES, ROWS, opening};

/// As often it is written at most.
const EVERY: Duration = Duration::from_secs(1);

/// Keeps the rows of a run in its folder while it goes on; [`super::super::write_run`] takes the file away when the tables are whole.
///
/// Nothing is written before the first second is over. When it cannot be written any more, the run is stopped: what it would compute from then
/// on could not be kept.
pub struct Journal<'f> {
    folder: &'f RunFolder,
    /// The run before its first step.
    start: RunRecord<'f>,
    /// The time since some moment: a library reads no clock of its own.
    clock: Box<dyn Fn() -> Duration + 'f>,
    every: Duration,
    /// When it was written last, or began to wait.
    written: Duration,
    /// Once there is one.
    file: Option<Box<dyn DiskFile>>,
    /// How much of it is on the disk.
    length: u64,
    chain: Chain,
    /// Rows that are not written yet.
    rows: Vec<u8>,
    row_bytes: usize,
    failure: Option<OutputError>,
}

impl<'f> Journal<'f> {
    /// A journal of the run that is to begin. `start` is the record of it with the columns that it will record and no rows, `clock` the time
    /// since any moment.
    pub fn new(folder: &'f RunFolder, start: RunRecord<'f>, clock: impl Fn() -> Duration + 'f) -> Self {
        Journal {
            folder,
            every: EVERY,
            written: clock(),
            clock: Box::new(clock),
            file: None,
            length: 0,
            chain: Chain::start(&opening()),
            rows: Vec::new(),
            row_bytes: 8 * (start.outcome.recording.columns.len() + 1),
            failure: None,
            start,
        }
    }

    /// The same, but written at most once in `every`, and not before.
    #[must_use]
    pub fn every(self, every: Duration) -> Self {
        Journal { every, ..self }
    }

    /// Why it is no longer written, if that is so.
    pub fn failure(&self) -> Option<&OutputError> {
        self.failure.as_ref()
    }

    /// Writes the rows that wait and how the run ended, if there is a file; a run that was short needs none.
    pub fn end(&mut self, record: &RunRecord<'_>, metrics: Metrics) {
        if self.file.is_some() && self.failure.is_none() {
            self.failure = self.write_end(record, metrics).err();
        }
    }

    fn write_end(&mut self, record: &RunRecord<'_>, metrics: Metrics) -> Result<(), OutputError> {
        let text = serde_json::to_vec(&Summary::of(record, metrics, Vec::new()));
        let text = text.map_err(|error| self.unencodable(error.into()))?;
        let mut frames = Frames::default();
        self.frame_rows(&mut frames);
        self.frame_text(&mut frames, END, &text)?;
        self.append(&frames)
    }

    /// Writes the rows that wait; the first time into a file that gets its name when all of that is on the disk.
    fn write(&mut self) -> Result<(), OutputError> {
        let mut frames = Frames::default();
        if self.file.is_some() {
            self.frame_rows(&mut frames);
            return self.append(&frames);
        }
        self.folder.ready()?;
        let head = serde_json::to_vec(&self.head()).map_err(|error| self.unencodable(error.into()))?;
        frames.bytes.extend(opening());
        self.frame_text(&mut frames, HEAD, &head)?;
        let head_bytes = frames.bytes.len() as u64;
        self.frame_rows(&mut frames);
        let disk = self.folder.disk();
        let (path, partial) = (self.folder.path().join(JOURNAL), self.folder.partial(JOURNAL));
        let _ = disk.remove_file(&partial); // of a writer that was killed
        self.file = Some(disk.create_file(&partial).map_err(io_error(Action::CreateFile, &path))?);
        let appended = self.append(&frames);
        let mut named = false;
        // Where the disk is full, the rows that it took are kept.
        let kept = if self.length <= head_bytes {
            Ok(())
        } else {
            let renamed = disk.rename(&partial, &path).map_err(io_error(Action::RenameFile, &path));
            named = renamed.is_ok();
            renamed.and_then(|()| disk.sync_folder(self.folder.path()).map_err(io_error(Action::WriteFile, &path)))
        };
        if !named {
            let _ = disk.remove_file(&partial);
        }
        appended.and(kept)
    }

    /// Writes to the end of the file, to the disk. Of what could not be written to the end the frames that are whole stay; the rest takes
    /// space that the tables may need.
    fn append(&mut self, frames: &Frames) -> Result<(), OutputError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let (bytes, written) = write_until_refused(file, &frames.bytes);
        let appended = match written {
            Ok(()) => match file.sync() {
                Ok(()) => {
                    self.length += bytes as u64;
                    Ok(())
                }
                // What was not synced before is lost, whatever a second attempt says.
                Err(error) => {
                    let _ = file.cut(self.length);
                    Err(error)
                }
            },
            Err(error) => {
                let whole = frames.ends.iter().rev().find(|end| **end <= bytes).map_or(0, |end| *end as u64);
                if file.cut(self.length + whole).and_then(|()| file.sync()).is_ok() {
                    self.length += whole;
                }
                Err(error)
            }
        };
        appended.map_err(io_error(Action::WriteFile, &self.folder.path().join(JOURNAL)))
    }

    /// Puts the rows that wait into frames.
    fn frame_rows(&mut self, frames: &mut Frames) {
        let most = (FRAME_BYTES / self.row_bytes).max(1) * self.row_bytes;
        for rows in self.rows.chunks(most) {
            self.chain.frame(frames, ROWS, rows);
        }
        self.rows.clear();
    }

    fn frame_text(&mut self, frames: &mut Frames, kind: u32, text: &[u8]) -> Result<(), OutputError> {
        if text.len() as u64 > MOST_TEXT_BYTES {
            let path = self.folder.path().join(JOURNAL);
            return Err(io_error(Action::WriteFile, &path)(ErrorKind::FileTooLarge.into()));
        }
        self.chain.frame(frames, kind, text);
        Ok(())
    }

    fn head(&self) -> Head {
        let record = &self.start;
        // What leads is in no row: it is worked out again.
        let mut columns = names::table_header(record.setup, &record.outcome.recording);
        columns.truncate(1 + record.outcome.recording.columns.len());
        let text = |input: &crate::scenario::InputFile| (input.name.clone(), input.source.text().to_owned());
        Head {
            columns,
            replaces_blake3: file_digest(&self.folder.path().join(SEAL)).ok(),
            scenario: record.scenario_text.to_owned(),
            inputs: record.inputs.iter().map(text).collect(),
            summary: Summary::of(record, super::super::metrics(record), Vec::new()),
        }
    }

    fn unencodable(&self, reason: EncodeError) -> OutputError {
        OutputError::Encode { path: self.folder.path().join(JOURNAL), reason }
    }
}

/// Writes as much as is taken: how much that is, and why no more.
fn write_until_refused(file: &mut Box<dyn DiskFile>, bytes: &[u8]) -> (usize, io::Result<()>) {
    let mut at = 0;
    while at < bytes.len() {
        match file.write(&bytes[at..]) {
            Ok(0) => return (at, Err(ErrorKind::WriteZero.into())),
            Ok(more) => at += more,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return (at, Err(error)),
        }
    }
    (at, Ok(()))
}

impl RowSink for Journal<'_> {
    fn row(&mut self, t_s: f64, values: &[f64]) {
        if self.failure.is_none() && 8 * (values.len() + 1) == self.row_bytes {
            self.rows.extend(t_s.to_le_bytes());
            values.iter().for_each(|value| self.rows.extend(value.to_le_bytes()));
        }
    }

    fn step(&mut self) -> ControlFlow<()> {
        // Time counts from the end of the last write: a slow disk must not hold up a run for more than half of it.
        if self.failure.is_none() && !self.rows.is_empty() && (self.clock)().saturating_sub(self.written) >= self.every
        {
            self.failure = self.write().err();
            self.written = (self.clock)();
        }
        if self.failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
