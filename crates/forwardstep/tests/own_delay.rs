//! A delay and a kind of switching of one's own: scenario files, schema, messages, verdicts, runs and reports know them.

#[path = "../examples/own_delay.rs"]
#[allow(dead_code, unreachable_pub, clippy::print_stderr, reason = "an example that is a program of its own")]
mod example;

use std::fs;
use std::ops::ControlFlow;
use std::process::ExitCode;

use crate::support::assert_report_is_rebuilt;
use forwardstep::check::{Answer, Id, Rigour, check, predict};
use forwardstep::io::SourceText;
use forwardstep::io::output::ending_sentence;
use forwardstep::io::scenario::{Scenario, ScenarioError};
use forwardstep::sim::delay::{Arrivals, Basis, Delay, DelayFunction, DelayPiece, Known};
use forwardstep::sim::quantity::QuantityError;
use forwardstep::sim::schedule::{Dwell, Extent};
use forwardstep::sim::{Ending, Setup, simulate};
use forwardstep::{program_with, sim};
use miette::Diagnostic;

const MASSES: &str = r#"format = 2
time = { end_s = 12 }

[[agents]]
name = "mass"
count = 3
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position_m = [[0], [1], [-0.5]]

[reference.consensus]
roots_per_s = [2, 1]
exchange = "position_velocity"

[law.adaptive]
damping.gain = 8
adaptation_gain = 10

[network]
delay.collatz = { step_s = 0.1, hold_s = 0.35 }
switching.thue_morse = { dwell_s = 0.5 }

[[network.phases]]
edges = [["mass-1", "mass-2"], ["mass-2", "mass-3"]]

[[network.phases]]
edges = [["mass-3", "mass-1"]]

[goal]
disagreement_below = 0.05
"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    example::kinds().unwrap().read_scenario("masses", &SourceText::new("masses.toml", text), None)
}

fn forwardstep(arguments: &[&str]) -> ExitCode {
    let kinds = example::kinds().unwrap();
    program_with(&kinds, ["forwardstep"].iter().chain(arguments).copied())
}

#[test]
fn they_run_are_reported_and_the_report_is_rebuilt() {
    let sampled = format!("{MASSES}\n[control]\nsample_hz = 200\n");
    for (text, name) in [(MASSES, "continuous"), (&sampled, "sampled")] {
        let folder = tempfile::tempdir().unwrap();
        let (file, out) = (folder.path().join("masses.toml"), folder.path().join(name));
        fs::write(&file, text).unwrap();
        let (file, out_text) = (file.to_str().unwrap(), out.to_str().unwrap());
        assert_eq!(forwardstep(&["run", file, "--out", out_text]), ExitCode::SUCCESS, "the goal is met, {name}");
        assert_report_is_rebuilt(forwardstep, &out);
    }
}

#[test]
fn the_file_says_what_they_are() {
    let setup = read(MASSES).unwrap().setup;
    let [delay] = &setup.network.delays[..] else { panic!("one for all edges") };
    // 1 is one number of the sequence of 1, 2 are those of 2, 8 those of 3, 3 of 4, 6 of 5.
    let values = [0.1, 0.5, 0.8, 1.2, 1.5].map(|t| (10.0 * delay.value(t)).round());
    assert_eq!(values, [1.0, 2.0, 0.0, 3.0, 2.0]);
    let graphs: Vec<usize> = setup.network.schedule.segments().take(8).map(|segment| segment.graph).collect();
    assert_eq!(graphs, [0, 1, 1, 0, 1, 0, 0, 1]);
    assert_eq!(setup.network.schedule.known().extent, Extent::Horizon);
}

#[test]
fn their_mistakes_are_reported_at_their_place_with_near_matches() {
    let cases = [
        ("delay.collatz", "delay.colatz", "19:7: unknown choice `colatz`", "did you mean `collatz`?"),
        ("step_s = 0.1", "stepp_s = 0.1", "19:19: unknown key `stepp_s`", "did you mean `step_s`?"),
        ("step_s = 0.1", "step_s = -0.1", "19:28: `step_s` is -0.1, but must be positive", ""),
        ("hold_s = 0.35", "hold_s = 1e-9", "19:42: ", "jumps of the delay"),
        ("switching.thue_morse", "switching.thue_mors", "20:11: unknown choice `thue_mors`", "`thue_morse`"),
        ("dwell_s = 0.5", "dwell = 0.5", "20:26: unknown key `dwell`", "did you mean `dwell_s`?"),
        ("dwell_s = 0.5", "dwell_s = 0", "20:36: `dwell_s` is 0, but must be positive", ""),
        ("switching.thue_morse = { dwell_s = 0.5 }", "switching = \"thue_morse\"", "20:13: ", ""),
    ];
    for (from, to, message, help) in cases {
        assert_eq!(MASSES.matches(from).count(), 1, "{from}");
        let error = read(&MASSES.replace(from, to)).unwrap_err();
        let (said, found) = (error.to_string(), error.help().map(|help| help.to_string()).unwrap_or_default());
        assert!(said.starts_with(&format!("masses.toml:{message}")), "{said}");
        assert!(format!("{said} {found}").contains(help), "{said} {found}");
    }
    let three = MASSES.replace("[goal]", "[[network.phases]]\nedges = []\n\n[goal]");
    let error = read(&three).unwrap_err().to_string();
    assert!(error.contains("the number of graphs is 3, but must be two"), "{error}");
}

#[test]
fn a_delay_of_ones_own_may_stand_wherever_one_may() {
    let own = "{ from = \"mass-3\", to = \"mass-1\", delay.collatz = { step_s = 0.05, hold_s = 0.2 } }";
    let text = MASSES.replace("[\"mass-3\", \"mass-1\"]", own);
    let network = read(&text).unwrap().setup.network;
    assert_eq!(network.delays.len(), 2);
    let own = &network.delays[network.schedule.graphs[1][0].delay];
    assert_eq!(own.max_s(), 3.0 * 0.05);
    // Two that are the same are one.
    let same = text.replace("step_s = 0.05, hold_s = 0.2", "hold_s = 0.35, step_s = 0.1");
    assert_eq!(read(&same).unwrap().setup.network.delays.len(), 1);
}

#[test]
fn the_schema_holds_them_and_the_program_without_them_does_not_know_them() {
    let schema = example::kinds().unwrap().schema().to_value();
    for (choice, key, table) in [
        ("DelayFile", "collatz", "CollatzFile"),
        ("SwitchingFile", "thue_morse", "ThueMorseFile"),
        ("DelayFile", "saw_tooth", "SawToothFile"),
        ("SwitchingFile", "random", "RandomSwitchingFile"),
    ] {
        let all = schema["$defs"][choice]["oneOf"].as_array().unwrap();
        let own = all.iter().find(|one| one["required"][0] == key).unwrap();
        assert_eq!(own["properties"][key]["$ref"], format!("#/$defs/{table}"));
        assert_eq!(schema["$defs"][table]["additionalProperties"], false);
    }
    let words = schema["$defs"]["SwitchingFile"]["oneOf"].as_array().unwrap();
    assert!(words.iter().any(|word| word["const"] == "repeat"));
    let source = SourceText::new("masses.toml", MASSES);
    let error = forwardstep::io::scenario::read_scenario("masses", &source, None).unwrap_err();
    assert_eq!(error.to_string(), "masses.toml:19:7: unknown choice `collatz`");
}

/// What is found of the hypothesis of this name.
fn found(setup: &Setup, id: Id) -> (Answer, Rigour, String) {
    let report = check(setup);
    let hypothesis = report.hypotheses.iter().find(|hypothesis| hypothesis.id == id).unwrap();
    (hypothesis.answer(), hypothesis.rigour(), hypothesis.because())
}

#[test]
fn what_their_authors_say_is_declared_and_never_holds() {
    let setup = read(MASSES).unwrap().setup;
    let (answer, rigour, because) = found(&setup, Id::BoundedDelays);
    assert_eq!((answer, rigour), (Answer::NotShown, Rigour::Declared));
    assert!(because.ends_with("(declared, not shown)"), "{because}");
    let (answer, rigour, _) = found(&setup, Id::SpanningTree);
    assert_eq!((answer, rigour), (Answer::HoldsOnHorizon, Rigour::Given));
    let (answer, rigour, _) = found(&setup, Id::DwellTime);
    assert_eq!((answer, rigour), (Answer::NotShown, Rigour::Declared));
    assert_eq!(setup.network.schedule.known().dwell, Dwell::Declared(0.5));
    assert!(predict(&setup).is_err());
}

/// A delay that says less than it is.
#[derive(Debug, PartialEq)]
struct Liar;

impl DelayFunction for Liar {
    fn words(&self) -> &'static str {
        "a liar"
    }

    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        Ok(())
    }

    fn piece(&self, _: u64) -> DelayPiece {
        DelayPiece::WHOLE
    }

    fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
        // Between two places of any raster, and where every step begins.
        if t_s > 1e-7 && t_s < 1e-2 || t_s > 6.0 { 0.5 } else { 0.2 }
    }

    fn known(&self) -> Known {
        Known { basis: Basis::Rule, ..Known::declared([0.0, 0.4]) }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}

#[test]
fn a_refuted_claim_is_violated_and_a_run_refuses_it_or_breaks_down() {
    let mut setup = read(MASSES).unwrap().setup;
    setup.network.delays = vec![Delay::new(Liar)];
    let (answer, _, because) = found(&setup, Id::BoundedDelays);
    assert_eq!(answer, Answer::Violated);
    assert!(because.contains("a liar") && because.contains("0.5 s at t = 6.0"), "{because}");
    let refused = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(refused.contains("a liar") && refused.contains("0.5 s at t = 6.0"), "{refused}");
    // What is found up to a shorter end is not enough to see it; the run does.
    setup.time.end_s = 5.0;
    assert_eq!(found(&setup, Id::BoundedDelays).0, Answer::NotShown);
    let outcome = sim::run(&setup).unwrap();
    assert!(matches!(outcome.ending, Ending::BrokeDown(_)), "{:?}", outcome.ending);
    let sentence = ending_sentence(&setup, &outcome.ending);
    assert!(sentence.contains("a liar") && sentence.contains("declared"), "{sentence}");
}
