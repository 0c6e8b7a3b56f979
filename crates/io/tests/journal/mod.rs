//! Journals that were cut short or changed, and what is made of them.

use std::cell::Cell;
use std::fs;
use std::ops::ControlFlow;
use std::time::Duration;

use forwardstep_check::{Practical, Report};
use forwardstep_sim::{
    Ending, Observers, Outcome, Recording, RowSink, Statistics, recorded_columns, simulate, simulate_with,
};

use forwardstep_io::SourceText;
use forwardstep_io::output::journal::{ReadJournal, read};
use forwardstep_io::output::{Journal, JournalError, Metrics, OutputError, Remark, RunFolder, RunRecord, SavedRun};
use forwardstep_io::scenario::kinds::Kinds;
use forwardstep_io::scenario::{Scenario, read_scenario};

use crate::support::{CARTS, plain_record};

mod faults;

const JOURNAL: &str = "rows.journal";
/// Kind, length and checksum of a frame.
const FRAME_HEAD: usize = 28;

fn carts() -> (Scenario, Report) {
    let text = CARTS.replace("record_every_s = 0.1", "record_every_s = 0.05");
    let scenario = read_scenario("carts", &SourceText::new("carts.toml", text), None).unwrap();
    let verdicts = forwardstep_check::check(&scenario.setup);
    (scenario, verdicts)
}

fn record<'a>((scenario, verdicts): &'a (Scenario, Report), outcome: &'a Outcome) -> RunRecord<'a> {
    plain_record(scenario, outcome, verdicts)
}

/// The outcome of the carts before their first step.
fn nothing((scenario, _): &(Scenario, Report)) -> Outcome {
    let recording = Recording { t_s: Vec::new(), columns: recorded_columns(&scenario.setup).unwrap() };
    Outcome { recording, ending: Ending::Interrupted { t_s: 0.0 }, statistics: Statistics::default() }
}

fn whole((scenario, _): &(Scenario, Report)) -> Outcome {
    simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Counts the rows that a journal has kept.
struct Counted<'f> {
    journal: Journal<'f>,
    rows: usize,
    kept: usize,
}

impl RowSink for Counted<'_> {
    fn row(&mut self, t_s: f64, values: &[f64]) {
        self.rows += 1;
        self.journal.row(t_s, values);
    }

    fn step(&mut self) -> ControlFlow<()> {
        let goes_on = self.journal.step();
        if goes_on.is_continue() {
            self.kept = self.rows;
        }
        goes_on
    }
}

/// Simulates the carts into the journal of `folder`, which is written after every step; how many rows it has kept, if it did not fail.
fn journaled(carts: &(Scenario, Report), folder: &RunFolder, ends: bool) -> (Outcome, usize, bool) {
    let start = nothing(carts);
    let journal = Journal::new(folder, record(carts, &start), || Duration::ZERO).every(Duration::ZERO);
    let mut sink = Counted { journal, rows: 0, kept: 0 };
    let outcome = simulate_with(
        &carts.0.setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { rows: Some(&mut sink), ..Observers::default() },
    )
    .unwrap();
    if ends {
        let record = record(carts, &outcome);
        sink.journal.end(&record, Metrics::of(record.setup, &record.outcome.recording, None, None));
    }
    let failed = sink.journal.failure().is_some();
    assert!(sink.journal.failure().is_none_or(|error| error.help().is_some()), "nothing says what to do");
    (outcome, sink.kept, failed)
}

/// The bytes of a journal of the carts, and all rows.
fn journal(ends: bool) -> (Vec<u8>, Outcome) {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let run = RunFolder::create(folder.path().join("run"), false).unwrap();
    let (outcome, ..) = journaled(&carts, &run, ends);
    (fs::read(run.path().join(JOURNAL)).unwrap(), outcome)
}

fn read_bytes(bytes: &[u8]) -> Result<ReadJournal, JournalError> {
    read(bytes, bytes.len() as u64)
}

/// So many rows were read, and they are the first of `outcome`, bit for bit.
fn first_rows(found: &ReadJournal, outcome: &Outcome) -> usize {
    let recording = &outcome.recording;
    let rows = found.columns[0].1.len();
    let columns = std::iter::once(&recording.t_s).chain(recording.columns.iter().map(|column| &column.values));
    assert_eq!(found.columns.len(), recording.columns.len() + 1);
    for ((name, values), written) in found.columns.iter().zip(columns) {
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(values), bits(&written[..rows]), "{name}");
    }
    rows
}

fn same_rows(run: &SavedRun, outcome: &Outcome, carts: &(Scenario, Report)) -> usize {
    let record = run.record(&carts.1, Practical::default(), None, &[]);
    let found = &record.outcome.recording;
    let rows = found.t_s.len();
    assert_eq!(found.t_s, outcome.recording.t_s[..rows]);
    for (one, other) in found.columns.iter().zip(&outcome.recording.columns) {
        assert!(one.values.iter().zip(&other.values).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!(one.values.len(), rows);
    }
    rows
}

#[test]
fn a_journal_has_every_row_and_a_run_into_it_the_same_bits() {
    let (bytes, outcome) = journal(false);
    assert_eq!(outcome.recording, whole(&carts()).recording);
    let found = read_bytes(&bytes).unwrap();
    assert_eq!(first_rows(&found, &outcome), 11);
    assert!(found.end.is_none() && found.left_out == 0);
    let (bytes, outcome) = journal(true);
    let found = read_bytes(&bytes).unwrap();
    assert_eq!((first_rows(&found, &outcome), found.left_out), (11, 0));
    assert_eq!(found.end.unwrap().metrics.rows, 11);
}

#[test]
fn a_journal_that_was_cut_anywhere_has_the_rows_before() {
    let (bytes, outcome) = journal(true);
    let mut most = None;
    for length in 0..=bytes.len() {
        match read_bytes(&bytes[..length]) {
            Ok(found) => {
                let rows = first_rows(&found, &outcome);
                assert!(most <= Some(rows), "{length}: no row that was whole is lost");
                assert_eq!(found.end.is_some(), length == bytes.len());
                most = Some(rows);
            }
            Err(JournalError::NotAJournal | JournalError::Head) => assert_eq!(most, None, "{length}"),
            Err(error) => panic!("{length}: {error}"),
        }
    }
    assert_eq!(most, Some(11));
    // Bytes behind the end are not rows.
    let found = read_bytes(&[&bytes[..], &bytes[bytes.len() / 2..]].concat()).unwrap();
    assert_eq!(first_rows(&found, &outcome), 11);
    assert!(found.left_out > 0);
}

#[test]
fn flipped_bits_never_give_rows_that_were_not_written() {
    let (bytes, outcome) = journal(true);
    let mut fewer = 0;
    for at in 0..bytes.len() {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        match read_bytes(&bytes) {
            Ok(found) => {
                assert!(found.left_out > 0, "{at}");
                fewer += usize::from(first_rows(&found, &outcome) < 11);
            }
            Err(JournalError::NotAJournal | JournalError::Head | JournalError::Newer { .. }) => {}
            Err(error) => panic!("{at}: {error}"),
        }
    }
    assert!(fewer > 100, "{fewer}");
}

/// Where the frames are.
fn frames(bytes: &[u8]) -> Vec<(usize, usize)> {
    let mut frames = Vec::new();
    let mut at = 20;
    while at < bytes.len() {
        let length = u64::from_le_bytes(bytes[at + 4..at + 12].try_into().unwrap()) as usize;
        frames.push((at, at + FRAME_HEAD + length));
        at += FRAME_HEAD + length;
    }
    frames
}

#[test]
fn frames_hold_only_where_they_were_written() {
    let (bytes, outcome) = journal(false);
    let frames = frames(&bytes);
    assert!(frames.len() > 3, "{frames:?}");
    let rows = |bytes: &[u8]| first_rows(&read_bytes(bytes).unwrap(), &outcome);
    // The first frame of rows is the second of all.
    for (k, (from, to)) in frames.iter().copied().enumerate().skip(1) {
        let without = [&bytes[..from], &bytes[to..]].concat();
        let before = rows(&bytes[..from]);
        assert_eq!(rows(&without), before, "frame {k} is missing");
        let twice = [&bytes[..to], &bytes[from..]].concat();
        assert_eq!(rows(&twice), rows(&bytes[..to]), "frame {k} stands twice");
    }
}

#[test]
fn a_length_that_is_not_true_takes_no_memory() {
    let (bytes, outcome) = journal(false);
    let frames = frames(&bytes);
    for (k, (from, _)) in frames.iter().copied().enumerate() {
        for length in [u64::MAX, 1 << 62, 1 << 40, 1 << 32, bytes.len() as u64, 0] {
            let mut bytes = bytes.clone();
            bytes[from + 4..from + 12].copy_from_slice(&length.to_le_bytes());
            // As if the file were as long as a forger likes.
            match read(&bytes[..], u64::MAX) {
                Ok(found) => assert!(k > 0 && first_rows(&found, &outcome) < 11),
                Err(error) => assert!(k == 0 && matches!(error, JournalError::Head), "{error}"),
            }
        }
    }
}

#[test]
fn it_is_written_once_in_a_while_and_not_for_a_short_run() {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let (now, start) = (Cell::new(0.0), nothing(&carts));
    let frames_at = |pace_s: f64, name: &str| {
        let run = RunFolder::create(folder.path().join(name), false).unwrap();
        now.set(0.0);
        let mut journal = Journal::new(&run, record(&carts, &start), || Duration::from_secs_f64(now.get()));
        let values = vec![0.25; start.recording.columns.len()];
        for k in 0..100 {
            journal.row(f64::from(k), &values);
            now.set(now.get() + pace_s);
            assert!(journal.step().is_continue());
        }
        fs::read(run.path().join(JOURNAL)).map_or(0, |bytes| frames(&bytes).len())
    };
    assert_eq!(frames_at(0.009, "short"), 0);
    // The head, and the rows of 2 s in two writes.
    assert_eq!(frames_at(0.025, "long"), 3);
}

#[test]
fn later_formats_and_other_files_are_named() {
    let (mut bytes, _) = journal(false);
    bytes[16] = 7;
    assert!(matches!(read_bytes(&bytes), Err(JournalError::Newer { found: 7 })));
    for other in [&b""[..], b"forwardstep", b"PAR1 and so on, whatever it may be"] {
        assert!(matches!(read_bytes(other), Err(JournalError::NotAJournal)));
    }
}

#[test]
fn what_was_cut_off_is_said_and_becomes_a_whole_folder() {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let path = folder.path().join("run");
    let run = RunFolder::create(&path, false).unwrap();
    let (outcome, ..) = journaled(&carts, &run, false);
    let saved = SavedRun::look_with(&path, &Kinds::shipped()).unwrap();
    assert_eq!(saved.remarks(&carts.1, "0.1.0"), [Remark::StillRunning]);
    assert!(saved.goes_on());
    // Its page says so, stands beside what the run writes, and is in no other's way.
    fs::write(path.join(".report.html.1.partial"), "a writer that was killed").unwrap();
    let (record, again) = (saved.record(&carts.1, Practical::default(), None, &[]), Duration::from_millis(6500));
    let page = saved.write_growing_page(&path, &record, again).unwrap();
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("running: 0.500 s of 0.5 s"), "{page}");
    assert!(
        page.contains("http-equiv=\"refresh\"") && page.contains("data-again-s=\"7\"") && !page.contains("Cut off")
    );
    assert!(page.contains("location.reload"));
    // What ended meanwhile wrote its own, and that stays.
    fs::rename(path.join(JOURNAL), path.join("away")).unwrap();
    fs::write(path.join("report.html"), "the whole page").unwrap();
    saved.write_growing_page(&path, &record, again).unwrap();
    assert_eq!(fs::read_to_string(path.join("report.html")).unwrap(), "the whole page");
    assert!(!path.join(format!(".report.html.{}.partial", std::process::id())).exists());
    fs::rename(path.join("away"), path.join(JOURNAL)).unwrap();
    // The run writes the same.
    fs::remove_file(path.join("report.html")).unwrap();
    let own = saved.write_own_growing_page(&run, &record, again).unwrap();
    assert_eq!(fs::read_to_string(own).unwrap(), page);
    fs::remove_file(path.join("report.html")).unwrap();
    drop(run);
    let saved = SavedRun::open(&path).unwrap();
    assert_eq!(saved.unfinished(), Some(&Ending::CutOff { t_s: 0.5 }));
    assert_eq!(saved.remarks(&carts.1, "0.1.0"), [Remark::FromJournal { rows: 11, cut_off: true }]);
    let record = saved.record(&carts.1, Practical::default(), None, &[]);
    let elsewhere = RunFolder::create(folder.path().join("elsewhere"), false).unwrap();
    saved.write_into(&elsewhere, &record).unwrap();
    assert!(path.join(JOURNAL).exists() && !path.join("summary.json").exists());
    drop(elsewhere);
    saved.write_report(&record).unwrap();
    assert!(!path.join(JOURNAL).exists());
    drop(saved);
    for path in [path, folder.path().join("elsewhere")] {
        let again = SavedRun::open(&path).unwrap();
        assert_eq!(same_rows(&again, &outcome, &carts), 11);
        let record = again.record(&carts.1, Practical::default(), None, &[]);
        assert_eq!(record.outcome.ending, Ending::CutOff { t_s: 0.5 });
        let summary = fs::read_to_string(path.join("summary.json")).unwrap();
        assert!(summary.contains("Was cut off at t = 0.5 s"), "{summary}");
    }
}

#[test]
fn a_journal_with_damage_stays_where_it_is() {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let (bytes, outcome) = journal(false);
    let path = folder.path();
    let (from, _) = frames(&bytes)[2];
    let mut damaged = bytes.clone();
    damaged[from + FRAME_HEAD] ^= 1;
    fs::write(path.join(JOURNAL), &damaged).unwrap();
    let run = SavedRun::open(path).unwrap();
    let bytes_left = (bytes.len() - from) as u64;
    assert!(run.remarks(&carts.1, "0.1.0").contains(&Remark::JournalDamaged { bytes: bytes_left }));
    let rows = same_rows(&run, &outcome, &carts);
    assert!(rows < 11);
    run.write_report(&run.record(&carts.1, Practical::default(), None, &[])).unwrap();
    assert_eq!(fs::read(path.join(JOURNAL)).unwrap(), damaged);
    drop(run);
    // The summary that stands beside it now is the newer.
    let again = SavedRun::open(path).unwrap();
    assert_eq!((same_rows(&again, &outcome, &carts), again.unfinished()), (rows, None));
}

/// A run that was cut off wrote its journal and no more: `report` and `--force` deleted tables beside it, and took any file of its name for one.
#[test]
fn regress_files_of_others_beside_a_journal_are_kept() {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let path = folder.path();
    fs::write(path.join(JOURNAL), journal(false).0).unwrap();
    assert!(matches!(RunFolder::create(path, false), Err(OutputError::FolderNotEmpty { cut_off: true, .. })));
    fs::create_dir(path.join("inputs")).unwrap();
    for name in [
        "scenario.toml",
        "trajectory.parquet",
        "trajectory.csv",
        "packets.csv",
        "phases.csv",
        "holds.csv",
        "shapes.json",
        "inputs/manifest.json",
        "plots/positions.svg",
    ] {
        let file = path.join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, "mine").unwrap();
        let run = SavedRun::look_with(path, &Kinds::shipped()).unwrap();
        let reported = run.write_report(&run.record(&carts.1, Practical::default(), None, &[])).map(|_| ());
        for refused in [reported, RunFolder::create(path, true).map(|_| ())] {
            assert!(matches!(&refused, Err(OutputError::Changed { path }) if *path == file), "{name}: {refused:?}");
        }
        assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
        assert!(path.join(JOURNAL).exists() && !path.join("summary.json").exists(), "{name}: nothing was changed");
        fs::remove_file(&file).unwrap();
    }
    // What the run would write itself may stand there, and so may what a growing page left.
    fs::write(path.join("scenario.toml"), carts.0.source.text()).unwrap();
    fs::write(path.join("report.html"), "running").unwrap();
    assert!(RunFolder::create(path, true).is_ok());
    for head in ["", "hello", "forwardstep rows"] {
        fs::write(path.join(JOURNAL), head).unwrap();
        assert!(matches!(RunFolder::create(path, true), Err(OutputError::NotOfARun { .. })), "{head}");
        assert!(matches!(RunFolder::create(path, false), Err(OutputError::FolderNotEmpty { cut_off: false, .. })));
    }
    // Half a summary says nothing of what stands beside it.
    fs::remove_file(path.join(JOURNAL)).unwrap();
    fs::write(path.join(".summary.json.partial"), "{").unwrap();
    assert!(matches!(RunFolder::create(path, true), Err(OutputError::NotOfARun { .. })));
}

/// Who wrote the tables of a run that was cut off, and was killed while files got their names, left some of them; and who tried again and was killed
/// before the new summary was whole left nothing that tells of them. They are as they would be written.
#[test]
fn regress_files_that_an_interrupted_report_left_are_known_by_what_they_hold() {
    let (carts, folder) = (carts(), tempfile::tempdir().unwrap());
    let (path, whole) = (folder.path().join("run"), folder.path().join("whole"));
    for path in [&path, &whole] {
        fs::create_dir(path).unwrap();
        fs::write(path.join(JOURNAL), journal(false).0).unwrap();
    }
    let report = |path: &std::path::Path| {
        let run = SavedRun::look_with(path, &Kinds::shipped()).unwrap();
        run.write_report(&run.record(&carts.1, Practical::default(), None, &[])).map(|_| ())
    };
    report(&whole).unwrap();
    for left in ["scenario.toml", "trajectory.parquet", "plots/torques.svg"] {
        fs::create_dir_all(path.join("plots")).unwrap();
        fs::copy(whole.join(left), path.join(left)).unwrap();
    }
    let bytes = fs::read(path.join(JOURNAL)).unwrap();
    report(&path).unwrap();
    assert!(!path.join(JOURNAL).exists());
    // The same with the new summary under its temporary name, as it is left beside what has got its own.
    fs::rename(path.join("summary.json"), path.join(".summary.json.partial")).unwrap();
    fs::write(path.join(JOURNAL), &bytes).unwrap();
    assert!(RunFolder::create(&path, true).is_ok());
    for (name, text) in [("scenario.toml", "mine"), ("trajectory.csv", "mine")] {
        let before = fs::read(path.join(name)).ok();
        fs::write(path.join(name), text).unwrap();
        for refused in [report(&path), RunFolder::create(&path, true).map(|_| ())] {
            assert!(matches!(refused, Err(OutputError::Changed { .. })), "{name}: {refused:?}");
        }
        match before {
            Some(bytes) => fs::write(path.join(name), bytes).unwrap(),
            None => fs::remove_file(path.join(name)).unwrap(),
        }
    }
    report(&path).unwrap();
    assert!(path.join("summary.json").exists() && !path.join(".summary.json.partial").exists());
}
