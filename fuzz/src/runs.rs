//! Scenarios: read as the program reads them, judged, and run for a while.

use std::ops::ControlFlow;
use std::path::Path;

use forwardstep::check;
use forwardstep::io::SourceText;
use forwardstep::io::output::{self, GoalOutcome, Metrics, RunFolder, RunRecord, ending_sentence};
use forwardstep::io::scenario::{OpenError, Scenario, open_scenario, read_scenario};
use forwardstep::sim::schedule::Extent;
use forwardstep::sim::{Outcome, RecordAt, simulate};

use crate::{Scratch, complaint, one_line, prompt, within};

/// Scenarios with more of anything are read and judged, but not run: what is large may take long.
const MOST_NUMBERS: usize = 50_000;
/// Steps of a run.
const MOST_STEPS: usize = 8;
/// Rows of a recording.
const MOST_ROWS: f64 = 200.0;
/// Every so many of the small runs are written out.
const WRITTEN_EVERY: u64 = 32;

/// Opens the scenario at `path`, twice; `None` when it is refused, with a message that can be shown.
pub fn open(path: &Path) -> Option<Scenario> {
    let name = path.to_str().expect("a path of our own");
    match prompt("reading", || open_scenario(name)) {
        Ok(scenario) => {
            let source = SourceText::new(name, scenario.source.text());
            let again = read_scenario(&scenario.name, &source, path.parent()).expect("what was read can be read again");
            if small(&scenario) {
                assert_eq!(format!("{:?}", again.setup), format!("{:?}", scenario.setup), "read twice");
            }
            one_line(&scenario.title);
            scenario.notices.iter().for_each(|notice| one_line(&notice.to_string()));
            Some(scenario)
        }
        Err(error) => {
            let shown = complaint(&error);
            let OpenError::Scenario(_) = error else { return None };
            let again = open_scenario(name).expect_err("what was refused is refused again");
            assert_eq!(complaint(&again), shown, "read twice");
            None
        }
    }
}

/// Whether a few steps of a scenario are quick and fit into memory.
fn small(scenario: &Scenario) -> bool {
    let setup = &scenario.setup;
    let per_agent = |agent: &forwardstep::sim::AgentSetup| {
        let (axes, parameters) = (agent.robot.axes.len(), agent.robot.theta.len());
        // Gains are matrices.
        axes * (8 + agent.roots_per_s.len()) + axes * axes + parameters * parameters
    };
    let agents: usize = setup.agents.iter().map(per_agent).sum();
    let edges: usize = setup.network.schedule.graphs.iter().map(|graph| graph.len()).sum();
    agents + edges <= MOST_NUMBERS
}

/// Judges a scenario, takes some steps, and now and then writes the run. What the reader lets pass, the others accept.
pub fn tried(scratch: &Scratch, mut scenario: Scenario) {
    // Every switch of a random schedule is looked at.
    let schedule = &scenario.setup.network.schedule;
    let switches = match schedule.known().extent {
        Extent::Horizon | Extent::Drawn => {
            schedule.segments().take_while(|segment| segment.start_s < scenario.setup.time.end_s).count()
        }
        Extent::Whole | Extent::Period(_) => 0,
    };
    let verdicts = within(3.0 + 2e-5 * switches as f64, "judging", || check::check(&scenario.setup));
    for hypothesis in &verdicts.hypotheses {
        assert!(!hypothesis.requires().is_empty());
        let because = hypothesis.because();
        assert!(!because.is_empty() && because.len() < 1 << 20, "{} bytes of reasons", because.len());
    }
    let prediction = prompt("predicting", || check::predict(&scenario.setup));
    if let Err(reason) = &prediction {
        one_line(&reason.to_string());
    }
    if !small(&scenario) {
        return;
    }
    // A first step may last for the whole run.
    let time = &mut scenario.setup.time;
    time.record_at = RecordAt::Intervals;
    time.record_every_s = time.record_every_s.max(time.end_s / MOST_ROWS);
    let mut steps = 0;
    let outcome = simulate(&scenario.setup, &mut |_| {
        steps += 1;
        if steps < MOST_STEPS { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    let outcome = outcome.unwrap_or_else(|error| panic!("was read, but cannot be simulated: {error:?}"));
    one_line(&ending_sentence(&scenario.setup, &outcome.ending));
    let predicted = prediction.ok().map(|prediction| prediction.value);
    let metrics = Metrics::of(&scenario.setup, &outcome.recording, predicted.as_deref(), scenario.goal);
    if digest(scenario.source.text()).is_multiple_of(WRITTEN_EVERY) && outcome.recording.columns.len() <= 400 {
        prompt("writing", || write(scratch, &scenario, &outcome, &metrics, &verdicts, predicted));
    }
}

fn write(
    scratch: &Scratch,
    scenario: &Scenario,
    outcome: &Outcome,
    metrics: &Metrics,
    verdicts: &check::Report,
    predicted_agreement: Option<Vec<f64>>,
) {
    let setup = &scenario.setup;
    let record = RunRecord {
        title: &scenario.title,
        scenario_name: &scenario.name,
        scenario_text: scenario.source.text(),
        inputs: &scenario.inputs,
        version: "0",
        setup,
        outcome,
        verdicts,
        practical: check::practical(setup),
        predicted_agreement,
        prediction: None,
        goal: scenario.goal.map(|goal| GoalOutcome { goal, met: goal.is_met(setup, outcome, metrics) }),
        digital: None,
        injected: Vec::new(),
        injected_course: None,
        notices: scenario.notices.iter().map(ToString::to_string).collect(),
        shapes: None,
    };
    let folder = RunFolder::create(&scratch.folder().join("run"), true).expect("a folder for the run");
    output::write_run(&folder, &record, output::Options { csv: true }).expect("a run can be written");
}

/// A number that looks random but is the same every time.
fn digest(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}
