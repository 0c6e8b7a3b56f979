//! What a run leaves on disk, read back.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use crate::sampled::control;
use crate::support::{agent, outcome, record, setup, two_arms, verdicts};
use forwardstep_check::hypothesis::{GraphEvidence, KindEvidence, MotionEvidence, Named, Subject};
use forwardstep_check::{Hypothesis, Id};
use forwardstep_core::Gain;
use forwardstep_core::robot::PlanarArm;
use forwardstep_io::output::{GoalOutcome, Options, RunFolder, ending_sentence, names, write_run};
use forwardstep_io::scenario::Goal;
use forwardstep_sim::recording::BreakdownCause;
use forwardstep_sim::{Breakdown, Ending, GainRates, Known, Method, Outcome, Recording, Setup, Signal, Stiffness};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

pub(crate) fn write(path: &Path, setup: &Setup, outcome: &Outcome) {
    let report = verdicts();
    write_run(&RunFolder::create(path, false).unwrap(), &record(setup, outcome, &report), Options { csv: true })
        .unwrap();
}

/// What a Parquet file holds.
struct Contents {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
    metadata: HashMap<String, String>,
    row_groups: usize,
}

fn read_parquet(path: &Path) -> Contents {
    let reader = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    let file = reader.metadata().file_metadata();
    let columns = file.schema_descr().columns().iter().map(|c| c.name().to_owned()).collect();
    let pairs = file.key_value_metadata().unwrap().iter();
    let metadata = pairs.map(|kv| (kv.key.clone(), kv.value.clone().unwrap())).collect();
    let number = |field: &Field| match field {
        Field::Double(v) => *v,
        other => panic!("{other:?} is not a double"),
    };
    let rows = reader.get_row_iter(None).unwrap();
    let rows = rows.map(|row| row.unwrap().get_column_iter().map(|(_, field)| number(field)).collect()).collect();
    Contents { columns, rows, metadata, row_groups: reader.metadata().num_row_groups() }
}

fn bits(rows: &[Vec<f64>]) -> Vec<Vec<u64>> {
    rows.iter().map(|row| row.iter().map(|v| v.to_bits()).collect()).collect()
}

fn rows_of(recording: &Recording) -> Vec<Vec<f64>> {
    let row = |k: usize| std::iter::once(recording.t_s[k]).chain(recording.columns.iter().map(move |c| c.values[k]));
    (0..recording.t_s.len()).map(|k| row(k).collect()).collect()
}

#[test]
fn parquet_reads_back_bit_for_bit_in_several_row_groups() {
    let setup = setup(vec![agent("arm-1", 1, 1)], 200.0, 0.01);
    let mut outcome = outcome(&setup);
    outcome.recording.columns[0].values[5] = f64::NAN;
    outcome.recording.columns[1].values[6] = f64::NEG_INFINITY;
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &setup, &outcome);
    let Contents { columns, rows, metadata, row_groups } = read_parquet(&folder.path().join("trajectory.parquet"));
    assert_eq!(columns[..4], ["t_s", "arm-1.q.1", "arm-1.dq.1", "arm-1.z.1"]);
    assert_eq!(columns[columns.len() - 3..], ["arm-1.theta_hat.link_1.mass", "arm-1.lyapunov", "arm-1.dissipation"]);
    assert_eq!(bits(&rows), bits(&rows_of(&outcome.recording)));
    assert!(row_groups > 1, "{row_groups} row group for {} rows", rows.len());
    let value = |key: &str| metadata[key].as_str();
    assert_eq!(value("forwardstep.version"), "0.1.0");
    assert_eq!(value("forwardstep.scenario_digest_blake3").len(), 64);
    let units: serde_json::Value = serde_json::from_str(value("forwardstep.units")).unwrap();
    assert_eq!(units["arm-1.dz.1"], "rad/s^2");
    assert_eq!(units["t_s"], "s");
}

#[test]
fn csv_reads_back_bit_for_bit() {
    let (setup, mut outcome) = two_arms();
    outcome.recording.columns[0].values[..4].copy_from_slice(&[1e-300, -0.1 - 0.2, f64::INFINITY, 1.0]);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &setup, &outcome);
    let mut reader = csv::Reader::from_path(folder.path().join("trajectory.csv")).unwrap();
    assert_eq!(reader.headers().unwrap(), &names::table_header(&setup, &outcome.recording)[..]);
    let rows = reader.records().map(|row| row.unwrap().iter().map(|v| v.parse().unwrap()).collect::<Vec<f64>>());
    assert_eq!(bits(&rows.collect::<Vec<_>>()), bits(&rows_of(&outcome.recording)));
}

#[test]
fn tables_have_distinct_column_names() {
    let (mut setup, outcome) = two_arms();
    setup.agents[1].name = "arm-1".into();
    let header = names::table_header(&setup, &outcome.recording);
    let distinct: std::collections::HashSet<_> = header.iter().collect();
    assert_eq!(distinct.len(), header.len());
    assert!(header.contains(&"arm-1.q.1~2".to_owned()));
}

#[test]
fn a_run_is_written_the_same_twice_but_for_timings() {
    let (setup, mut outcome) = two_arms();
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write(one.path(), &setup, &outcome);
    outcome.statistics.wall = outcome.statistics.wall.map(|wall| 3 * wall);
    write(two.path(), &setup, &outcome);
    let text = |folder: &tempfile::TempDir, name: &str| fs::read(folder.path().join(name)).unwrap();
    for name in ["trajectory.parquet", "trajectory.csv", "report.html", "scenario.toml", "plots/positions.svg"] {
        assert!(text(&one, name) == text(&two, name), "{name} differs");
    }
    let summary = |folder| serde_json::from_slice::<serde_json::Value>(&text(folder, "summary.json")).unwrap();
    let (mut first, mut second) = (summary(&one), summary(&two));
    assert_ne!(first["timings"], second["timings"]);
    first["timings"].take();
    second["timings"].take();
    assert_eq!(first, second);
    assert_eq!(first["format"], 2);
    assert_eq!(first["ending"]["kind"], "completed");
    assert_eq!(first["verdicts"]["worst"], "not covered by the paper");
    assert_eq!(first["goal"], serde_json::json!({ "disagreement_below": 0.05, "met": true }));
}

#[test]
fn all_files_are_named_and_the_summary_comes_last() {
    let (setup, outcome) = two_arms();
    let (folder, report) = (tempfile::tempdir().unwrap(), verdicts());
    let run = RunFolder::create(folder.path().join("deep/er"), false).unwrap();
    let files = write_run(&run, &record(&setup, &outcome, &report), Options::default()).unwrap();
    assert_eq!(files.len(), 8);
    assert!(files.iter().all(|file| file.is_file()));
    assert_eq!(files.last(), Some(&run.path().join("summary.json")));
    assert!(!run.path().join("trajectory.csv").exists());
    let hidden = fs::read_dir(run.path()).unwrap().any(|e| e.unwrap().file_name().to_string_lossy().starts_with('.'));
    assert!(!hidden, "temporary files were left");
}

#[test]
fn names_given_by_users_are_escaped_everywhere() {
    let mut setup = setup(vec![agent("<script>alert(1)</script>", 1, 1), agent("a&\"b\"", 1, 1)], 1.0, 0.1);
    setup.agents[0].robot.theta_names[0] = "</script><img src=x onerror=alert(2)>".into();
    let outcome = outcome(&setup);
    let (folder, mut report) = (tempfile::tempdir().unwrap(), verdicts());
    let roots = vec![Named { index: 0, name: "<b onclick=alert(3)>".into() }];
    let tree = GraphEvidence::Window { length_s: 3.0, worst_start_s: 1.0, roots, for_all_time: true, drawn: false };
    report.hypotheses[0].evidence = tree.into();
    assert!(report.hypotheses[0].because().contains("<b onclick"));
    let mut it = record(&setup, &outcome, &report);
    (it.title, it.scenario_text) = ("</title><script>alert(4)</script>", "# </pre><script>alert(5)</script>");
    it.notices = vec!["<script>alert(6)</script>".into()];
    write_run(&RunFolder::create(folder.path(), false).unwrap(), &it, Options::default()).unwrap();
    let html = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(html.matches("<script").count(), 4, "index, block, uPlot and the page's own");
    for hostile in ["<script>alert", "<img", "<b onclick", "</title><script"] {
        assert!(!html.contains(hostile), "{hostile}");
    }
    for name in ["positions", "torques", "estimates", "disagreement"] {
        let svg = fs::read_to_string(folder.path().join(format!("plots/{name}.svg"))).unwrap();
        assert!(!svg.contains("<script"), "{name}");
        roxmltree::Document::parse(&svg).unwrap();
    }
}

#[test]
fn the_page_says_where_every_hypothesis_is_asked_for_and_whose_it_is() {
    let setup = setup(vec![agent("a", 1, 1), agent("b", 1, 1)], 1.0, 0.1);
    let (folder, report, outcome) = (tempfile::tempdir().unwrap(), verdicts(), outcome(&setup));
    let run = RunFolder::create(folder.path(), false).unwrap();
    write_run(&run, &record(&setup, &outcome, &report), Options::default()).unwrap();
    let html = fs::read_to_string(folder.path().join("report.html")).unwrap();
    for hypothesis in &report.hypotheses {
        let (id, rigour) = (hypothesis.id.name(), hypothesis.rigour());
        let way = format!("<span title=\"{}\">{}</span>", rigour.meaning(), rigour.word());
        let origin = format!("<code>{id}</code> · {} · {} · {way}", hypothesis.place(), hypothesis.source().words());
        assert!(html.contains(&origin), "{origin}");
    }
    assert!(!report.hypotheses.is_empty() && html.contains(&report.theorem.source().words()));
}

/// Which gain is to blame, and what is said when none is, or the closed loop is not stiff.
#[test]
fn a_run_that_outgrows_its_memory_says_what_to_lower() {
    let (mut setup, _) = two_arms();
    let sentence = |setup: &Setup, step_s: f64, rate_per_s: f64, gains: Option<GainRates>| {
        let stiffness = Some(Stiffness { rate_per_s, gains });
        let cause = BreakdownCause::MemoryFull { step_s, need_bytes: 3.2e12, stiffness };
        let breakdown = Breakdown { t_s: 0.5, agent: 1, signal: Signal::Velocity, axis: 1, cause };
        let sentence = ending_sentence(setup, &Ending::BrokeDown(breakdown));
        let (head, why) = sentence.split_once("; ").unwrap();
        (head.to_owned(), why.to_owned())
    };
    let gains =
        |damping_per_s, adaptation_per_s| Some(GainRates { damping_per_s, viscous_per_s: 0.0, adaptation_per_s });
    let (head, why) = sentence(&setup, 1e-8, 1e8, gains(200.0, Some(3e7)));
    assert_eq!(
        head,
        "Broke down at t = 0.5 s of 2 s: arm-2.dq.2 has the largest error in steps of 1 × 10⁻⁸ s, in which all that is sent within \
         the longest delay, 0.4 s, takes 3.2 × 10¹² bytes where `memory_budget_bytes` is 1073741824"
    );
    assert_eq!(
        why,
        "the closed loop is stiff, its fastest rate is about 1 × 10⁸ 1/s; at arm-2 K/λ_min(M) is about 200 1/s and \
         √(Γ‖Y‖²/λ_min(M)) is about 3 × 10⁷ 1/s: lower `law.adaptive.adaptation_gain`, or let it start nearer and slower: Y grows \
         with the motion."
    );
    let (_, why) = sentence(&setup, 1e-8, 1e8, gains(4e8, Some(1e3)));
    assert!(why.ends_with(": lower `law.adaptive.damping`."), "{why}");
    let (_, why) = sentence(&setup, 1e-8, 1e8, gains(6e8, Some(1e7)));
    assert!(why.contains("no gain of its law explains it"), "{why}");
    let rubs = Some(GainRates { damping_per_s: 50.0, viscous_per_s: 8e7, adaptation_per_s: Some(1e3) });
    let (_, why) = sentence(&setup, 1e-8, 1e8, rubs);
    assert!(why.contains(" D/λ_min(M) is about 8 × 10⁷ 1/s and ") && why.contains("state the `armature`"), "{why}");
    let (_, why) = sentence(&setup, 1e-8, 1e8, None);
    assert_eq!(why, "the closed loop is stiff, its fastest rate is about 1 × 10⁸ 1/s.");
    let (_, why) = sentence(&setup, 1e-8, 1e6, gains(1e6, None));
    assert_eq!(
        why,
        "the closed loop is not stiff, its fastest rate is about 1000000 1/s: loosen the tolerances, or raise the budget."
    );
    // Under the floor a transient may hide behind steps that are shorter still.
    let under_floor = |setup: &Setup, rate_per_s: f64| {
        let stiffness = Some(Stiffness { rate_per_s, gains: gains(rate_per_s, None) });
        let cause = BreakdownCause::StepUnderFloor { step_s: 1e-16, stiffness };
        ending_sentence(
            setup,
            &Ending::BrokeDown(Breakdown { t_s: 0.5, agent: 1, signal: Signal::Velocity, axis: 1, cause }),
        )
    };
    assert!(under_floor(&setup, 4e12).contains("under the floor of 1e-12 s; the closed loop is stiff"));
    let not_stiff = "the closed loop is not stiff, its fastest rate is about 200 1/s: loosen the tolerances, or look at where it starts.";
    assert!(under_floor(&setup, 200.0).ends_with(not_stiff));
    setup.agents[1].law = Arc::new(Known { damping: Gain::Number(1.0) });
    let (_, why) = sentence(&setup, 1e-8, 1e8, gains(1e8, None));
    assert!(why.ends_with("K/λ_min(M) is about 1 × 10⁸ 1/s: lower `law.known.damping`."), "{why}");
    setup.solver.max_step_s = Some(1e-8);
    let (_, why) = sentence(&setup, 1e-8, 1e3, None);
    assert!(why.ends_with("1000 1/s: raise `max_step_s`, loosen the tolerances, or raise the budget."), "{why}");
    setup.solver.method = Method::Fixed { step_s: 1e-8 };
    let (head, why) = sentence(&setup, 1e-8, 1e3, None);
    assert!(head.contains("arm-2.dq.2 moves fastest in steps of 1 × 10⁻⁸ s"), "{head}");
    assert!(why.ends_with("1000 1/s: raise `step_s`, or raise the budget."), "{why}");
}

/// Of hypotheses that are watched those failed whose quantity vanished, and of each agent its own.
#[test]
fn what_ended_a_run_is_the_failure_of_what_was_watched_of_that_agent_alone() {
    let (setup, whole) = two_arms();
    let about = |id, agent: Option<usize>| Hypothesis {
        id,
        subject: agent.map_or(Subject::Setup, |index| Subject::Agent(Named { index, name: format!("arm-{index}") })),
        evidence: MotionEvidence::OfAgent.into(),
    };
    let mut report = verdicts();
    report.hypotheses = vec![
        about(Id::RegularJacobian, Some(0)),
        about(Id::RegularJacobian, Some(1)),
        about(Id::NonzeroThrust, None),
        about(Id::InputFactor, None),
        Hypothesis { evidence: KindEvidence::ConstantFactor.into(), ..about(Id::InputFactor, None) },
    ];
    let failures = |signal: Signal, cause: BreakdownCause| {
        let ending = Ending::BrokeDown(Breakdown { t_s: 0.5, agent: 1, signal, axis: 0, cause });
        record(&setup, &Outcome { ending, ..whole.clone() }, &report).failures()
    };
    let vanished = BreakdownCause::Vanished { value: 0.0, floor: 1.0 };
    for (signal, id) in [
        (Signal::Determinant, "regular-jacobian"),
        (Signal::SingularValue, "regular-jacobian"),
        (Signal::Thrust, "nonzero-thrust"),
        (Signal::Divisor, "input-factor"),
    ] {
        assert_eq!(failures(signal, vanished), [format!("[{id}]: it failed, at t = 0.5 s")]);
    }
    assert!(failures(Signal::Divisor, BreakdownCause::NotFinite).is_empty());
    assert!(record(&setup, &whole, &report).failures().is_empty());
}

/// A thrust that vanished was only `it`, and who samples too slowly was told to look elsewhere.
#[test]
fn regress_a_thrust_that_vanishes_is_named_and_who_samples_is_told_to_sample_faster() {
    let (mut setup, _) = two_arms();
    let ended = |setup: &Setup, signal: Signal| {
        let cause = BreakdownCause::Vanished { value: 0.7267, floor: 1.0 };
        ending_sentence(setup, &Ending::BrokeDown(Breakdown { t_s: 0.5, agent: 1, signal, axis: 0, cause }))
    };
    let thrust = "sigma is 0.7267 N: the law divides by the thrust, which must stay away from zero by 1 N; ";
    let said = ended(&setup, Signal::Thrust);
    assert!(said.contains(&format!("{thrust}start elsewhere, or choose slower gains.")), "{said}");
    let said = ended(&setup, Signal::Divisor);
    assert!(said.contains("is 0.7267: the law divides by it, and it must stay away from zero by 1; start"), "{said}");
    setup.control = Some(control(20.0));
    let said = ended(&setup, Signal::Thrust);
    assert!(said.contains(&format!("{thrust}sample faster, start elsewhere, or choose slower gains.")), "{said}");
}

#[test]
fn a_broken_run_says_who_and_what_and_is_written() {
    let (setup, mut outcome) = two_arms();
    outcome.ending = Ending::BrokeDown(Breakdown {
        t_s: 0.5,
        agent: 1,
        signal: Signal::Velocity,
        axis: 1,
        cause: BreakdownCause::StepUnderFloor { step_s: 1e-14, stiffness: None },
    });
    let sentence = ending_sentence(&setup, &outcome.ending);
    let expected = "Broke down at t = 0.5 s of 2 s: arm-2.dq.2 asks for a step of 1e-14 s, under the floor of 1e-12 s.";
    assert_eq!(sentence, expected);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &setup, &outcome);
    let on_page = expected.replace("1e-14", "1 × 10⁻¹⁴").replace("1e-12", "1 × 10⁻¹²");
    assert!(fs::read_to_string(folder.path().join("report.html")).unwrap().contains(&on_page));
    let summary = fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["ending"]["breakdown"]["column"], "arm-2.dq.2");
    assert_eq!(summary["ending"]["breakdown"]["cause"]["step_under_floor"]["step_s"], 1e-14);
}

/// Shapes at the edges: no agents, no rows, one row, nothing finite, many of everything, columns that are missing or short.
#[test]
fn every_shape_of_run_is_written() {
    let mut shapes: Vec<(Setup, Outcome)> = Vec::new();
    let mut add = |setup: Setup, change: &dyn Fn(&mut Outcome)| {
        let mut outcome = outcome(&setup);
        change(&mut outcome);
        shapes.push((setup, outcome));
    };
    let arms = |n: usize, dof, parameters| (0..n).map(|k| agent(&format!("r{k}"), dof, parameters)).collect::<Vec<_>>();
    add(setup(Vec::new(), 1.0, 0.1), &|_| {});
    add(setup(arms(1, 1, 0), 1.0, 0.1), &|_| {});
    add(setup(arms(2, 0, 0), 1.0, 0.1), &|_| {});
    add(setup(arms(2, 2, 2), 1.0, 0.1), &|o| o.recording = Recording::default());
    for rows in 0..4 {
        add(setup(arms(2, 2, 2), 1.0, 0.1), &|o| {
            o.recording.t_s.truncate(rows);
            o.recording.columns.iter_mut().for_each(|c| c.values.truncate(rows));
        });
    }
    for value in [f64::NAN, f64::INFINITY, 0.0, f64::MAX, -f64::MAX, f64::MIN_POSITIVE] {
        add(setup(arms(2, 2, 2), 1.0, 0.01), &|o| o.recording.columns.iter_mut().for_each(|c| c.values.fill(value)));
    }
    add(setup(arms(2, 2, 2), 1.0, 0.1), &|o| o.recording.columns.retain(|c| c.agent == 1 && c.axis == 1));
    add(setup(arms(2, 2, 2), 1.0, 0.1), &|o| o.recording.columns.iter_mut().for_each(|c| c.values.truncate(3)));
    add(setup(arms(64, 2, 3), 1.0, 0.01), &|_| {});
    add(setup(arms(2, 32, 3), 1.0, 0.01), &|_| {});
    add(setup([arms(1, 2, 2), arms(1, 5, 0)].concat(), 1.0, 0.1), &|_| {});
    let mut known = setup(arms(2, 1, 2), 1.0, 0.1);
    known.agents.iter_mut().for_each(|a| a.law = Arc::new(Known { damping: forwardstep_core::Gain::Number(1.0) }));
    known.agents[0].robot.kind = Arc::new(PlanarArm);
    add(known, &|o| o.recording.columns.retain(|c| c.signal != Signal::Estimate));

    let report = verdicts();
    for (setup, outcome) in &shapes {
        let folder = tempfile::tempdir().unwrap();
        let mut it = record(setup, outcome, &report);
        it.goal = Some(GoalOutcome { goal: Goal::ExpectDiverges, met: false });
        write_run(&RunFolder::create(folder.path(), false).unwrap(), &it, Options { csv: true }).unwrap();
        let Contents { columns, rows, .. } = read_parquet(&folder.path().join("trajectory.parquet"));
        assert_eq!((columns.len(), rows.len()), (outcome.recording.columns.len() + 1, outcome.recording.t_s.len()));
    }
}

#[test]
fn a_page_of_six_arms_stays_under_six_megabytes() {
    let six = setup((1..=6).map(|k| agent(&format!("arm-{k}"), 6, 60)).collect(), 600.0, 0.02);
    let (outcome, folder) = (outcome(&six), tempfile::tempdir().unwrap());
    let report = verdicts();
    write_run(&RunFolder::create(folder.path(), false).unwrap(), &record(&six, &outcome, &report), Options::default())
        .unwrap();
    let size = fs::metadata(folder.path().join("report.html")).unwrap().len();
    assert!(size < 6_000_000, "{size} bytes");
}
