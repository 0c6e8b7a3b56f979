//! A disk whose operations fail, each in its turn, while a run is journaled and its folder is written.

use std::cell::Cell;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use forwardstep_check::Report;
use forwardstep_sim::RowSink;

use forwardstep_io::output::{Disk, DiskFile, Journal, Options, Remark, RunFolder, SavedRun, write_run};
use forwardstep_io::scenario::Scenario;
use forwardstep_io::scenario::kinds::Kinds;

use super::{JOURNAL, carts, journaled, nothing, record, same_rows, whole};

/// How an operation fails.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// Once, and the disk is as it was: there is no space.
    Full,
    /// This operation and all after it: there is no space any more.
    FullForGood,
    /// Once, by a reason that cannot be removed from here.
    Broken,
    /// A write takes a part and says so; other operations are interrupted, or done. Nothing is lost by it.
    Short,
}

impl Fault {
    fn error(self) -> io::Error {
        match self {
            Fault::Full | Fault::FullForGood => io::ErrorKind::StorageFull.into(),
            Fault::Broken | Fault::Short => io::Error::from_raw_os_error(5),
        }
    }
}

/// A disk that fails once or for good.
#[derive(Debug)]
struct Faulty(Arc<Mutex<Faults>>);

#[derive(Debug)]
struct Faults {
    /// So many operations succeed before one fails.
    left: usize,
    fault: Fault,
    fired: bool,
}

impl Faults {
    fn next(&mut self) -> io::Result<()> {
        match self.turn() && self.fault != Fault::Short {
            true => Err(self.fault.error()),
            false => Ok(()),
        }
    }

    /// Whether it is the turn of this operation.
    fn turn(&mut self) -> bool {
        if self.fired {
            return self.fault == Fault::FullForGood;
        }
        self.fired = self.left == 0;
        self.left = self.left.saturating_sub(1);
        self.fired
    }
}

impl Faulty {
    fn next(&self) -> io::Result<()> {
        self.0.lock().unwrap().next()
    }
}

impl Disk for Faulty {
    fn create_folders(&self, path: &Path) -> io::Result<()> {
        self.next()?;
        fs::create_dir_all(path)
    }

    fn create_file(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        self.next()?;
        let file = fs::File::create_new(path)?;
        let is_journal = path.to_string_lossy().contains(JOURNAL);
        Ok(Box::new(FaultyFile {
            file,
            faults: self.0.clone(),
            synced: 0,
            length: 0,
            spoilt: false,
            lost: false,
            is_journal,
        }))
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.next()?;
        fs::rename(from, to)
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        self.next()?;
        fs::remove_file(path)
    }

    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        self.next()
    }
}

/// A write that fails has written a part; a sync that fails has lost what was not synced before.
struct FaultyFile {
    file: fs::File,
    faults: Arc<Mutex<Faults>>,
    synced: u64,
    length: u64,
    /// A write failed, and what is behind the last whole frame was not cut off.
    spoilt: bool,
    /// A sync failed.
    lost: bool,
    is_journal: bool,
}

impl Write for FaultyFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        assert!(!((self.spoilt || self.lost) && self.is_journal), "nothing is written behind what failed");
        let mut faults = self.faults.lock().unwrap();
        let (turn, fault) = (faults.turn(), faults.fault);
        let part = if turn { &bytes[..bytes.len() / 2] } else { bytes };
        self.file.write_all(part)?;
        self.length += part.len() as u64;
        self.spoilt = turn && fault != Fault::Short;
        match (self.spoilt, turn && part.is_empty()) {
            (true, _) => Err(fault.error()),
            (false, true) => Err(io::ErrorKind::Interrupted.into()),
            (false, false) => Ok(part.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl DiskFile for FaultyFile {
    fn sync(&mut self) -> io::Result<()> {
        assert!(!(self.spoilt && self.is_journal), "what is torn is cut off first");
        assert!(!(self.lost && self.is_journal), "a sync that failed is not tried again");
        let result = self.faults.lock().unwrap().next();
        match result {
            Ok(()) => self.synced = self.length,
            Err(_) => {
                self.lost = true;
                self.file.set_len(self.synced)?;
            }
        }
        result
    }

    fn cut(&mut self, bytes: u64) -> io::Result<()> {
        self.faults.lock().unwrap().next()?;
        assert!(bytes <= self.length, "nothing is made longer");
        self.file.set_len(bytes)?;
        (self.length, self.synced, self.spoilt) = (bytes, self.synced.min(bytes), false);
        Ok(())
    }
}

/// Runs the carts in `path` on a disk whose operation number `left` fails. Whether it did, and the rows that must be there.
fn run_on_faulty(carts: &(Scenario, Report), path: PathBuf, left: usize, fault: Fault) -> (bool, usize) {
    let faults = Arc::new(Mutex::new(Faults { left, fault, fired: false }));
    let Ok(folder) = RunFolder::create_on(Arc::new(Faulty(faults.clone())), path, true) else { return (true, 0) };
    let (outcome, kept, journal_failed) = journaled(carts, &folder, true);
    let written = write_run(&folder, &record(carts, &outcome), Options::default());
    let fired = faults.lock().unwrap().fired;
    let rows = outcome.recording.t_s.len();
    assert!(written.is_ok() || fired);
    if let Err(error) = &written {
        assert!(error.help().is_some(), "{error}: nothing says what to do");
    }
    assert!(fault != Fault::Short || written.is_ok() && !journal_failed, "{left}: nothing was lost");
    (fired, if written.is_ok() || !journal_failed { rows } else { kept })
}

#[test]
fn whatever_fails_the_rows_that_were_kept_are_found() {
    let carts = carts();
    let outcome = whole(&carts);
    for fault in [Fault::Full, Fault::FullForGood, Fault::Broken, Fault::Short] {
        for earlier in [false, true] {
            let mut left = 0;
            loop {
                let folder = tempfile::tempdir().unwrap();
                let path = folder.path().join("run");
                if earlier {
                    // An earlier run under the same names, which this one replaces.
                    let before = RunFolder::create(&path, false).unwrap();
                    write_run(&before, &record(&carts, &nothing(&carts)), Options::default()).unwrap();
                }
                let (fired, kept) = run_on_faulty(&carts, path.clone(), left, fault);
                match SavedRun::look_with(&path, &Kinds::shipped()) {
                    Ok(run) => {
                        let rows = same_rows(&run, &outcome, &carts);
                        assert!(rows >= kept, "{fault:?} at operation {left}: {rows} of {kept} rows");
                        // Somebody looks at it again on a disk that works, and then once more.
                        let record = run.record(&carts.1, forwardstep_check::Practical::default(), None, &[]);
                        run.write_report(&record).unwrap();
                        let again = SavedRun::open(&path).unwrap();
                        assert_eq!(same_rows(&again, &outcome, &carts), rows);
                        assert!(again.unfinished().is_none());
                    }
                    Err(error) => assert_eq!(kept, 0, "{fault:?} at operation {left}: {error}"),
                }
                if !fired {
                    break;
                }
                left += if std::env::var_os("FORWARDSTEP_LONG").is_some() { 1 } else { 5 };
            }
            assert!(left > 60, "{left} operations");
        }
    }
}

/// A disk with so much room.
#[derive(Debug)]
struct Small(Arc<Mutex<u64>>);

struct SmallFile {
    file: fs::File,
    room: Arc<Mutex<u64>>,
    length: u64,
}

impl Disk for Small {
    fn create_folders(&self, path: &Path) -> io::Result<()> {
        fs::create_dir_all(path)
    }

    fn create_file(&self, path: &Path) -> io::Result<Box<dyn DiskFile>> {
        Ok(Box::new(SmallFile { file: fs::File::create_new(path)?, room: self.0.clone(), length: 0 }))
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        let length = path.metadata()?.len();
        fs::remove_file(path)?;
        *self.0.lock().unwrap() += length;
        Ok(())
    }

    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }
}

impl Write for SmallFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut room = self.room.lock().unwrap();
        let taken = bytes.len().min(*room as usize);
        if taken == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.file.write_all(&bytes[..taken])?;
        (*room, self.length) = (*room - taken as u64, self.length + taken as u64);
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl DiskFile for SmallFile {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn cut(&mut self, bytes: u64) -> io::Result<()> {
        self.file.set_len(bytes)?;
        *self.room.lock().unwrap() += self.length - bytes;
        self.length = bytes;
        Ok(())
    }
}

#[test]
fn regress_a_disk_that_is_full_at_the_first_write_keeps_the_rows_it_took() {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let (room, now, start) = (Arc::new(Mutex::new(400_000)), Cell::new(0.0), nothing(&carts));
    let path = folder.path().join("run");
    let run = RunFolder::create_on(Arc::new(Small(room.clone())), &path, false).unwrap();
    let values = vec![0.25; start.recording.columns.len()];
    let row_bytes = 8 * (values.len() as u64 + 1);
    {
        let mut journal = Journal::new(&run, record(&carts, &start), || Duration::from_secs_f64(now.get()));
        for k in 0..2_000_000 / row_bytes as u32 {
            journal.row(f64::from(k), &values);
        }
        now.set(2.0);
        assert!(journal.step().is_break());
        assert!(
            journal.failure().is_some_and(|error| error.help().is_some_and(|help| help.contains("free some space")))
        );
    }
    // What was torn is cut off and its space is there for the tables.
    let kept = path.join(JOURNAL).metadata().unwrap().len();
    let left = *room.lock().unwrap();
    assert!(kept + left == 400_000 && (1..70_000).contains(&left), "{kept} + {left}");
    drop(run);
    let saved = SavedRun::open(&path).unwrap();
    let rows =
        saved.record(&carts.1, forwardstep_check::Practical::default(), None, &[]).outcome.recording.t_s.len() as u64;
    assert!(rows * row_bytes > 300_000, "{rows} rows");
    assert!(!saved.remarks(&carts.1, "0.1.0").iter().any(|remark| matches!(remark, Remark::JournalDamaged { .. })));
    // Where the head alone has no room, there is nothing to keep.
    let run = RunFolder::create_on(Arc::new(Small(Arc::new(Mutex::new(1000)))), folder.path().join("tiny"), false);
    let run = run.unwrap();
    let mut journal = Journal::new(&run, record(&carts, &start), || Duration::from_secs_f64(now.get()));
    journal.row(0.0, &values);
    now.set(4.0);
    assert!(journal.step().is_break());
    assert_eq!(fs::read_dir(run.path()).unwrap().count(), 0);
}

/// A run that is too short for a journal, and whose files do not all get their names, leaves a folder that is known as a run's.
#[test]
fn regress_files_of_a_run_without_a_journal_are_known_whatever_fails() {
    let carts = carts();
    let outcome = whole(&carts);
    let mut half_named = 0;
    for left in 0.. {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run");
        let faults = Arc::new(Mutex::new(Faults { left, fault: Fault::Broken, fired: false }));
        let Ok(run) = RunFolder::create_on(Arc::new(Faulty(faults.clone())), &path, false) else { continue };
        let written = write_run(&run, &record(&carts, &outcome), Options::default());
        drop(run);
        if !faults.lock().unwrap().fired {
            assert!(left > 20, "{left} operations");
            break;
        }
        let is_named = path.join("scenario.toml").exists() && !path.join("summary.json").exists();
        half_named += usize::from(is_named);
        let again = RunFolder::create(&path, true);
        assert!(again.is_ok(), "operation {left}, {written:?}: {again:?}");
    }
    assert!(half_named > 3, "{half_named}");
}
