//! Tables that somebody forged, with a summary that fits them: no panic, no memory beyond what the file justifies, no rows that
//! it does not hold.

use std::collections::BTreeSet;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use allocation_counter::measure;
use forwardstep_io::SourceText;
use forwardstep_io::output::{Options, ParquetProblem, RestoreError, RunFolder, SavedRun, TableError, write_run};
use forwardstep_io::scenario::read_scenario;
use forwardstep_sim::recording::Recording;
use forwardstep_sim::simulate;

use crate::support::plain_record;

const CART: &str = r#"format = 2
title = "A cart"
time = { end_s = 0.5, record_every_s = 0.1 }
[[agents]]
name = "cart"
robot.point_mass = { dimension = 1, mass_kg = 2 }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
edges = []
"#;
const TABLE: &str = "trajectory.parquet";
const SUMMARY: &str = "summary.json";
/// For what is needed beside the numbers: the scenario, the summary, what reads.
const BESIDE: u64 = 1 << 20;

/// Runs the cart, lets `change` have its way with the rows, and writes the folder.
fn write(folder: &Path, change: impl FnOnce(&mut Recording)) -> Recording {
    let scenario = read_scenario("cart", &SourceText::new("cart.toml", CART), None).unwrap();
    let mut outcome = simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap();
    change(&mut outcome.recording);
    let verdicts = forwardstep_check::check(&scenario.setup);
    let record = plain_record(&scenario, &outcome, &verdicts);
    write_run(&RunFolder::create(folder, true).unwrap(), &record, Options::default()).unwrap();
    outcome.recording
}

/// A folder of a run whose table is exchanged for others.
struct Forge {
    folder: tempfile::TempDir,
    table: Vec<u8>,
    summary: serde_json::Value,
    recording: Recording,
}

impl Forge {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let recording = write(folder.path(), |_| {});
        let table = fs::read(folder.path().join(TABLE)).unwrap();
        let summary = serde_json::from_str(&fs::read_to_string(folder.path().join(SUMMARY)).unwrap()).unwrap();
        Forge { folder, table, summary, recording }
    }

    /// Where the footer begins.
    fn footer(&self) -> usize {
        let end = self.table.len() - 8;
        end - u32::from_le_bytes(self.table[end..end + 4].try_into().unwrap()) as usize
    }

    /// Puts a table into the place of the run's, and makes the summary fit.
    fn open(&mut self, table: &[u8]) -> Result<SavedRun, RestoreError> {
        let path = self.folder.path();
        self.summary["tables"][0]["digest_blake3"] = blake3::hash(table).to_hex().to_string().into();
        fs::write(path.join(TABLE), table).unwrap();
        fs::write(path.join(SUMMARY), self.summary.to_string()).unwrap();
        let mut opened = None;
        let used = measure(|| opened = Some(SavedRun::open(path)));
        assert!(used.bytes_max <= BESIDE + 44 * table.len() as u64, "{} bytes at once", used.bytes_max);
        opened.unwrap()
    }

    /// What is wrong with a table; that of one which is read holds as many rows as the run.
    fn problem(&mut self, table: &[u8]) -> Option<ParquetProblem> {
        match self.open(table) {
            Ok(run) => {
                let verdicts = forwardstep_check::check(run.setup());
                let rows = self.recording.t_s.len();
                let read = &run.record(&verdicts, forwardstep_check::Practical::default(), None, &[]).outcome.recording;
                assert!(read.t_s.len() == rows && read.columns.iter().all(|column| column.values.len() == rows));
                None
            }
            Err(RestoreError::Table { reason: TableError::Parquet(problem), .. }) => Some(problem),
            Err(RestoreError::Table { .. }) => None,
            Err(other) => panic!("{other:?}"),
        }
    }
}

#[test]
fn tables_of_many_groups_come_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let written = write(folder.path(), |recording| {
        let rows = 20_000;
        recording.t_s = (0..rows).map(|k| f64::from(k) * 0.001).collect();
        for (k, column) in recording.columns.iter_mut().enumerate() {
            // Some that compress, some that hardly do.
            let value = |row: i32| if k % 2 == 0 { f64::from(row % 7) } else { (f64::from(row) * 0.7).sin() };
            column.values = (0..rows).map(value).collect();
        }
    });
    let run = SavedRun::open(folder.path()).unwrap();
    let verdicts = forwardstep_check::check(run.setup());
    assert_eq!(run.record(&verdicts, forwardstep_check::Practical::default(), None, &[]).outcome.recording, written);
}

#[test]
fn a_table_that_is_cut_anywhere_is_refused() {
    let mut forge = Forge::new();
    let table = forge.table.clone();
    assert_eq!(forge.problem(&table), None);
    for length in (0..table.len()).step_by(3) {
        assert!(forge.problem(&table[..length]).is_some(), "cut to {length} of {} bytes", table.len());
    }
}

#[test]
fn forged_bytes_neither_panic_nor_take_memory() {
    let mut forge = Forge::new();
    let (table, footer) = (forge.table.clone(), forge.footer());
    let mut seen = BTreeSet::new();
    let mut tried = 0;
    let mut try_one = |mutant: &[u8]| {
        tried += 1;
        if let Some(problem) = forge.problem(mutant) {
            seen.insert(format!("{problem:?}"));
        }
    };
    for at in 0..table.len() {
        for byte in [[0, 0x7f, 0xff][at % 3], table[at] ^ 1 << (at % 8)] {
            let mut mutant = table.clone();
            mutant[at] = byte;
            try_one(&mutant);
        }
    }
    // Numbers that are much longer, with a footer whose length fits.
    for at in (footer..table.len() - 8).step_by(3) {
        let long: &[u8] = if at % 2 == 0 {
            &[0xfe, 0xff, 0xff, 0xff, 0x0f]
        } else {
            &[0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f]
        };
        let mut mutant = [&table[..at], long, &table[at + 1..table.len() - 8]].concat();
        let length = u32::try_from(mutant.len() - footer).unwrap();
        mutant.extend(length.to_le_bytes());
        mutant.extend(b"PAR1");
        try_one(&mutant);
    }
    assert!(tried > 4000, "{tried}");
    let all = ["Compressed", "Ended", "Malformed", "Misplaced", "NotOurs", "NotParquet"];
    assert_eq!(seen, all.map(String::from).into());
}

#[test]
fn a_table_that_is_much_too_large_is_not_even_read() {
    let forge = Forge::new();
    let path = forge.folder.path();
    // It takes no room on the disk.
    fs::OpenOptions::new().write(true).open(path.join(TABLE)).unwrap().set_len(1 << 40).unwrap();
    let opened = SavedRun::open(path);
    assert!(
        matches!(opened, Err(RestoreError::Table { reason: TableError::TooLarge { written: 6 }, .. })),
        "{opened:?}"
    );
}

#[cfg(unix)]
#[test]
fn a_pipe_in_the_place_of_a_table_is_refused_at_once() {
    let forge = Forge::new();
    let path = forge.folder.path();
    fs::remove_file(path.join(TABLE)).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(path.join(TABLE)).status().unwrap().success());
    let said = SavedRun::open(path).unwrap_err().to_string();
    assert!(said.contains("it is a pipe, and no file"), "{said}");
}
