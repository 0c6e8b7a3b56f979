//! Folders of runs, read back whole and after somebody was at them.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use forwardstep_io::SourceText;
use forwardstep_io::output::summary::Summary;
use forwardstep_io::output::{
    FirstInjection, Injected, InjectedCourse, Options, Remark, RestoreError, RunFolder, RunRecord, SavedRun,
    TableError, write_run,
};
use forwardstep_io::scenario::read_scenario;
use forwardstep_sim::{
    Breakdown, BreakdownCause, Ending, GainRates, Outcome, Setup, Signal, Stiffness, recorded_columns, simulate,
};
use proptest::prelude::*;

use crate::support::CARTS;

const LED: &str = r#"[reference.leader]
design = "continuous"
roots_per_s = [1]
gain = 30
[law.known]
damping.gain = 10
[leader]
name = "guide"
motion.sinusoids = [{ waves = [{ amplitude = 2, rad_per_s = 3 }] }]
"#;

/// What changed V of the second cart, as if it had been sampled.
fn injected() -> Vec<Injected> {
    vec![Injected {
        agent: 1,
        start_j: 3.0,
        end_j: 1.5,
        dissipated_j: -2.0,
        held_j: 0.125,
        reconstructed_j: 0.0,
        measured_j: 0.25,
        limited_j: 0.0625,
        rubbed_j: 0.03125,
        pushed_j: 0.0,
        adaptation_j: 0.03125,
        residual_j: 0.0,
        first: Some(FirstInjection { cause: "measured".into(), t_s: 0.75 }),
    }]
}

/// The same over time; a number that was not finite is not known.
fn injected_course() -> InjectedCourse {
    let known = |values: [f64; 3]| values.into_iter().map(Some).collect();
    InjectedCourse {
        t_s: vec![0.0, 0.25, 0.5],
        v: known([2.0, 1.5, 1.25]),
        by: [
            ("dissipated".to_owned(), known([0.0, -0.5, -0.8])),
            ("held".to_owned(), vec![Some(0.0), None, Some(0.05)]),
        ]
        .into(),
    }
}

/// Runs the carts, lets `change` have its way with the outcome, and writes their folder.
fn write(folder: &Path, change: impl FnOnce(&Setup, &mut Outcome)) -> Outcome {
    write_of(CARTS, folder, change)
}

fn write_of(text: &str, folder: &Path, change: impl FnOnce(&Setup, &mut Outcome)) -> Outcome {
    let scenario = read_scenario("carts", &SourceText::new("carts.toml", text), None).unwrap();
    let mut outcome = simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap();
    change(&scenario.setup, &mut outcome);
    let record = RunRecord {
        title: &scenario.title,
        scenario_name: &scenario.name,
        scenario_text: text,
        inputs: &scenario.inputs,
        version: "0.1.0",
        setup: &scenario.setup,
        outcome: &outcome,
        verdicts: &forwardstep_check::check(&scenario.setup),
        practical: forwardstep_check::practical(&scenario.setup),
        predicted_agreement: None,
        prediction: None,
        goal: None,
        digital: None,
        injected: injected(),
        injected_course: Some(injected_course()),
        notices: vec!["one".into()],
        shapes: None,
    };
    write_run(&RunFolder::create(folder, true).unwrap(), &record, Options { csv: true }).unwrap();
    outcome
}

/// Reads a folder and writes its report anew.
fn rebuild(folder: &Path) -> Result<(), RestoreError> {
    let run = SavedRun::open(folder)?;
    let verdicts = forwardstep_check::check(run.setup());
    let remarks = run.remarks(&verdicts, "0.1.0");
    run.write_report(&run.record(&verdicts, forwardstep_check::Practical::default(), None, &remarks))?;
    Ok(())
}

/// A motion that leads stands in the tables beside those that follow, and is worked out again where they are read; one of a name that
/// looks like a column of theirs as well.
#[test]
fn a_leader_has_columns_of_its_own() {
    let led = CARTS
        .replace("[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\n", LED)
        .replace(
            "[[\"cart-1\", \"cart-2\"], [\"cart-2\", \"cart-1\"]]",
            "[[\"guide\", \"cart-1\"], [\"cart-1\", \"cart-2\"]]",
        )
        .replace("delay.constant_s = 0.1\n", "");
    let folder = tempfile::tempdir().unwrap();
    let outcome = write_of(&led, folder.path(), |_, _| {});
    let mut table = csv::Reader::from_path(folder.path().join("trajectory.csv")).unwrap();
    let header: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header[header.len() - 2..], ["guide.q.1", "guide.dq.1"]);
    assert_eq!(header.len(), outcome.recording.columns.len() + 3);
    let mut rows = 0;
    for row in table.records() {
        let row: Vec<f64> = row.unwrap().iter().map(|v| v.parse().unwrap()).collect();
        let (t_s, [q, dq]) = (row[0], [row[row.len() - 2], row[row.len() - 1]]);
        assert!((q - 2.0 * (3.0 * t_s).sin()).abs() < 1e-12 && (dq - 6.0 * (3.0 * t_s).cos()).abs() < 1e-12, "{row:?}");
        rows += 1;
    }
    assert_eq!(rows, 6);
    for table in ["trajectory.parquet", "trajectory.csv"] {
        let back = SavedRun::open(folder.path()).unwrap();
        let verdicts = forwardstep_check::check(back.setup());
        assert_eq!(back.remarks(&verdicts, "0.1.0"), [], "{table}");
        assert_eq!(
            back.record(&verdicts, forwardstep_check::Practical::default(), None, &[]).outcome.recording,
            outcome.recording,
            "{table}"
        );
        drop(back);
        let _ = fs::remove_file(folder.path().join("trajectory.parquet"));
    }
}

#[test]
fn a_run_comes_back_as_it_was() {
    let endings = [
        Ending::Completed,
        Ending::Interrupted { t_s: 0.1 + 0.2 },
        Ending::BrokeDown(Breakdown {
            t_s: 0.5,
            agent: 1,
            signal: Signal::Estimate,
            axis: 0,
            cause: BreakdownCause::StepUnderFloor {
                step_s: 1.1e-13,
                stiffness: Some(Stiffness { rate_per_s: 7.0, gains: None }),
            },
        }),
        Ending::BrokeDown(Breakdown {
            t_s: 0.5,
            agent: 1,
            signal: Signal::Velocity,
            axis: 0,
            cause: BreakdownCause::MemoryFull {
                step_s: 1.1e-13,
                need_bytes: 3e15,
                stiffness: Some(Stiffness {
                    rate_per_s: 1.3e12,
                    gains: Some(GainRates { damping_per_s: 3.0, viscous_per_s: 0.5, adaptation_per_s: Some(1.2e12) }),
                }),
            },
        }),
        Ending::BrokeDown(Breakdown {
            t_s: 0.5,
            agent: 1,
            signal: Signal::Position,
            axis: 0,
            cause: BreakdownCause::PositionLimit { value: f64::INFINITY, limits: [-1.0, 1.0] },
        }),
    ];
    for ending in endings {
        let folder = tempfile::tempdir().unwrap();
        let written = write(folder.path(), |_, outcome| {
            outcome.ending = ending;
            let position = |c: &&mut forwardstep_sim::Column| c.agent == 1 && c.signal == Signal::Position;
            *outcome.recording.columns.iter_mut().find(position).unwrap().values.last_mut().unwrap() = f64::INFINITY;
        });
        let run = SavedRun::open(folder.path()).unwrap();
        let verdicts = forwardstep_check::check(run.setup());
        assert_eq!(run.remarks(&verdicts, "0.1.0"), []);
        let record = run.record(&verdicts, forwardstep_check::Practical::default(), None, &[]);
        assert_eq!(record.outcome.recording, written.recording);
        assert_eq!((&record.outcome.ending, &record.outcome.statistics), (&written.ending, &written.statistics));
        assert_eq!((record.title, record.scenario_name, record.version), ("Two carts", "carts", "0.1.0"));
        assert_eq!(record.notices, ["one"]);
        assert_eq!(record.injected, injected());
    }
}

#[test]
fn a_summary_reads_back_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    // Numbers that are not finite become null, and null again.
    write(folder.path(), |_, outcome| outcome.recording.columns[1].values[2] = f64::NAN);
    let text = fs::read_to_string(folder.path().join("summary.json")).unwrap();
    assert!(text.contains("\"value\": null"), "{text}");
    let summary: Summary = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string_pretty(&summary).unwrap() + "\n", text);
}

#[test]
fn verdicts_of_older_summaries_are_read_without_names() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), |_, _| {});
    let path = folder.path().join("summary.json");
    let text = fs::read_to_string(&path).unwrap();
    let written: Summary = serde_json::from_str(&text).unwrap();
    let of = |id: &str| written.verdicts.hypotheses.iter().find(|verdict| verdict.id.as_deref() == Some(id)).unwrap();
    let delays = of("bounded-delays");
    let said = [&delays.place, &delays.source, &delays.rigour].map(|entry| entry.as_deref().unwrap());
    assert_eq!(said, ["Section III-A", "the paper", "exact"]);
    assert_eq!(of("common-first-root").source.as_deref(), Some("the paper as corrected (E1)"));
    let theorem = [&written.verdicts.id, &written.verdicts.source].map(|entry| entry.as_deref().unwrap());
    assert_eq!(theorem, ["theorem-2", "the paper"]);

    let remarks = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        change(&mut summary["verdicts"]);
        fs::write(&path, summary.to_string()).unwrap();
        let run = SavedRun::open(folder.path()).unwrap();
        run.remarks(&forwardstep_check::check(run.setup()), "0.1.0")
    };
    let hypotheses = |verdicts: &mut serde_json::Value,
                      change: &dyn Fn(&mut serde_json::Map<String, serde_json::Value>)| {
        verdicts["hypotheses"].as_array_mut().unwrap().iter_mut().for_each(|v| change(v.as_object_mut().unwrap()));
    };
    let strip = |verdicts: &mut serde_json::Value| {
        hypotheses(verdicts, &|verdict| {
            ["id", "place", "source", "rigour"].iter().for_each(|key| drop(verdict.remove(*key)))
        });
        ["id", "source"].iter().for_each(|key| drop(verdicts.as_object_mut().unwrap().remove(*key)));
    };
    assert_eq!(remarks(&strip), []);
    for key in ["id", "place", "source", "rigour", "requires", "because"] {
        let change = |verdicts: &mut serde_json::Value| {
            hypotheses(verdicts, &|verdict| drop(verdict.insert(key.to_owned(), "another".into())));
        };
        assert_eq!(remarks(&change), [Remark::VerdictsDiffer], "{key}");
    }
    for key in ["id", "source", "theorem"] {
        assert_eq!(remarks(&|verdicts| verdicts[key] = "another".into()), [Remark::VerdictsDiffer], "{key}");
    }
    // A hypothesis fewer, without names.
    let fewer = |verdicts: &mut serde_json::Value| {
        strip(verdicts);
        verdicts["hypotheses"].as_array_mut().unwrap().pop();
    };
    assert_eq!(remarks(&fewer), [Remark::VerdictsDiffer]);
}

#[test]
fn columns_are_known_before_a_run() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), |setup, outcome| {
        let mut columns = outcome.recording.columns.clone();
        columns.iter_mut().for_each(|column| column.values.clear());
        assert_eq!(recorded_columns(setup).unwrap(), columns);
    });
}

#[test]
fn columns_may_stand_in_any_order_and_some_may_be_missing() {
    let folder = tempfile::tempdir().unwrap();
    let written = write(folder.path(), |_, _| {});
    fs::remove_file(folder.path().join("trajectory.parquet")).unwrap();
    let path = folder.path().join("trajectory.csv");
    let table = fs::read_to_string(&path).unwrap();
    let reversed = |line: &str| line.split(',').rev().collect::<Vec<_>>().join(",") + "\n";
    fs::write(&path, table.lines().map(reversed).collect::<String>()).unwrap();
    let run = SavedRun::open(folder.path()).unwrap();
    let verdicts = forwardstep_check::check(run.setup());
    assert_eq!(
        run.record(&verdicts, forwardstep_check::Practical::default(), None, &[]).outcome.recording,
        written.recording
    );
    drop(run);
    // A version that records more meets the tables of one that did not.
    let shorter = |line: &str| line.rsplit_once(',').unwrap().0.to_owned() + "\n";
    fs::write(&path, table.lines().map(shorter).collect::<String>()).unwrap();
    let run = SavedRun::open(folder.path()).unwrap();
    let said: Vec<_> = run.remarks(&verdicts, "0.1.0").iter().map(ToString::to_string).collect();
    assert!(said.contains(&"the tables have no column `cart-2.dissipation`".to_owned()), "{said:?}");
    let columns =
        run.record(&verdicts, forwardstep_check::Practical::default(), None, &[]).outcome.recording.columns.len();
    assert_eq!(columns, written.recording.columns.len() - 1);
}

#[test]
fn a_table_of_another_kind_is_refused() {
    use std::sync::Arc;

    use parquet::data_type::Int64Type;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), |_, _| {});
    let path = folder.path().join("trajectory.parquet");
    let schema = Arc::new(parse_message_type("message other { required int64 t_s; }").unwrap());
    let mut file = SerializedFileWriter::new(fs::File::create(&path).unwrap(), schema, Arc::default()).unwrap();
    let mut group = file.next_row_group().unwrap();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<Int64Type>().write_batch(&[1, 2], None, None).unwrap();
    column.close().unwrap();
    group.close().unwrap();
    file.close().unwrap();
    let reason = |folder: &Path| match SavedRun::open(folder) {
        Err(RestoreError::Table { reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    assert!(matches!(reason(folder.path()), TableError::Digest));
    // Even when somebody makes the summary fit.
    let summary = fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let digest = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
    let mut value: serde_json::Value = serde_json::from_str(&summary).unwrap();
    value["tables"][0]["digest_blake3"] = digest(&fs::read(&path).unwrap()).into();
    fs::write(folder.path().join("summary.json"), value.to_string()).unwrap();
    assert!(matches!(reason(folder.path()), TableError::NotNumbers { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn prop_no_edit_of_a_folder_panics(
        file in prop::sample::select(vec!["summary.json", "scenario.toml", "trajectory.csv", "trajectory.parquet"]),
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0..8usize, prop::sample::select(vec![
                "", "0", "-1", "9", "1e999", "NaN", "null", "\"", ",", "{", "]", "\n", "é", "inputs/../x", "\u{0}",
            ])),
            1..4,
        ),
    ) {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), |_, _| {});
        if file == "trajectory.csv" {
            fs::remove_file(folder.path().join("trajectory.parquet")).unwrap();
        }
        let path = folder.path().join(file);
        let mut bytes = fs::read(&path).unwrap();
        for (at, length, text) in edits {
            let start = at.index(bytes.len() + 1);
            let end = (start + length).min(bytes.len());
            bytes.splice(start..end, text.bytes());
        }
        fs::write(&path, bytes).unwrap();
        let _ = rebuild(folder.path());
    }
}

#[test]
fn the_page_says_what_changed_v_and_what_came_first() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), |_, _| {});
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    let (_, section) = page.split_once("<section id=\"injected\">").unwrap();
    let (section, _) = section.split_once("</section>").unwrap();
    let numbers: Vec<&str> = section.split("<td>").skip(1).filter_map(|cell| cell.split("</td>").next()).collect();
    // Causes that put nothing in have no column.
    assert_eq!(numbers, ["3", "−2", "0.125", "0.25", "0.0625", "0.03125", "0.03125", "1.5", "measured, t = 0.75 s"]);
    assert!(section.contains("cart-2") && !section.contains("cart-1"), "{section}");
    let heads = ["dissipated", "held", "measured", "limited", "rubbed", "adaptation"];
    assert!(heads.iter().all(|head| section.contains(&format!(">{head}</th>"))), "{section}");
    assert!(!section.contains("reconstructed") && !section.contains("pushed"), "{section}");
}
