//! Reference dynamics of one's own: scenario files, schema, messages, verdicts, runs and reports know them.

#[path = "../examples/own_reference.rs"]
#[allow(dead_code, unreachable_pub, clippy::print_stderr, reason = "an example that is a program of its own")]
mod example;

use std::fs;
use std::ops::ControlFlow;
use std::process::ExitCode;
use std::sync::Arc;

use crate::support::assert_report_is_rebuilt;
use example::Anchored;
use forwardstep::check::derivation::explain;
use forwardstep::check::derivation::residual::{Missing, Residuals};
use forwardstep::check::{Answer, Footing, Id, Report, Rigour, Theorem, check, predict};
use forwardstep::io::SourceText;
use forwardstep::io::output::{TextLine, explanation_lines};
use forwardstep::io::scenario::{Scenario, ScenarioError};
use forwardstep::own::*;
use forwardstep::program_with;
use forwardstep::sim::delay::Delay;
use forwardstep::sim::delay::Sinusoid;
use forwardstep::sim::graph::Edge;
use forwardstep::sim::push::{Course, Effect, Function, Push};
use forwardstep::sim::reference::Consensus;
use forwardstep::sim::schedule::{Phase, Schedule};
use forwardstep::sim::{AgentSetup, Network, Observers, Outcome, Setup, Signal, simulate, simulate_with};
use miette::Diagnostic;

const HOMES: &str = r#"format = 2
time = { end_s = 30 }

[[agents]]
name = "mass"
count = 3
robot.point_mass = { dimension = 2, mass_kg = 2 }
start.position_m = [[0, 2], [1, -1], [-0.5, 0]]

[reference.anchored]
roots_per_s = [1, 2]
homes = [[0.5, 0], [0.5, 0], [0.5, 0]]
weight = 0.7

[law.adaptive]
damping.gain = 8
adaptation_gain = 10

[network]
delay.constant_s = 0.3
edges = [["mass-1", "mass-2"], ["mass-2", "mass-3"], ["mass-3", "mass-1"]]

[goal]
disagreement_below = 0.01
"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    example::kinds().unwrap().read_scenario("homes", &SourceText::new("homes.toml", text), None)
}

fn forwardstep(arguments: &[&str]) -> ExitCode {
    let kinds = example::kinds().unwrap();
    program_with(&kinds, ["forwardstep"].iter().chain(arguments).copied())
}

#[test]
fn their_linear_form_is_explained() {
    let setup = read(HOMES).unwrap().setup;
    let explanation = explain(&setup);
    let design = &explanation.designs[0];
    assert_eq!((design.agents.len(), design.order, design.degrees), (3, Some(3), Some([2, 1])));
    let lines = explanation_lines(&setup, &explanation, &Footing::default());
    let has = |part: &str| lines.iter().any(|line| matches!(line, TextLine::Formula(text, _) if text.contains(part)));
    // ℓ = 2, α = (2, 3, 1) and the weight 0.7 of a home.
    let own = "z\u{308}_i = −3.7 z\u{307}_i − 4.1 q\u{307}_i − 1.4 q_i − Σ_j w_ij";
    assert!(has(own) && has("[z\u{307}_i + 3 q\u{307}_i + 2 q_i − 2 q_j(t − T_ij)] + c_i"), "{lines:?}");
    assert!(has("q\u{308}_i = z\u{307}_i + s\u{307}_i"), "{lines:?}");
    // Along a run it holds, with c as it is at the first row.
    let mut residuals = Residuals::of(&setup).unwrap();
    simulate_with(
        &setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { moments: Some(&mut |moment| residuals.look(moment)), ..Observers::default() },
    )
    .unwrap();
    let found = residuals.found().remove(0).1;
    assert!(found.iter().all(|one| one.holds() != Some(false)), "{found:?}");
    assert_eq!(found.iter().filter(|one| one.largest == Err(Missing::Term)).count(), 0, "{found:?}");
    assert!(found.iter().filter(|one| one.holds() == Some(true)).count() >= 8, "{found:?}");
}

/// The same, but the linear form that it gives is not quite its own.
#[derive(Debug)]
struct Misdescribed(Arc<dyn ReferenceDynamics>);

impl ReferenceDynamics for Misdescribed {
    fn words(&self) -> ReferenceWords {
        self.0.words()
    }
    fn interface(&self) -> ReferenceInterface {
        self.0.interface()
    }
    fn free_derivatives(&self, roots: usize) -> usize {
        self.0.free_derivatives(roots)
    }
    fn known(&self) -> Known {
        self.0.known()
    }
    fn linear(&self, agent: &AgentSetup, exchange: Exchange) -> Option<LinearReference> {
        let mut linear = self.0.linear(agent, exchange)?;
        linear.coupled.z[1] += 1e-3;
        Some(linear)
    }
    fn check(&self, setup: &Setup) -> Result<(), SetupError> {
        self.0.check(setup)
    }
    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        self.0.dynamics(assembly)
    }
}

#[test]
fn a_linear_form_that_is_not_theirs_is_found_out_and_nothing_is_derived_from_it() {
    let mut setup = read(HOMES).unwrap().setup;
    let probed = |setup: &Setup| {
        let report = check(setup);
        let hypothesis =
            report.hypotheses.iter().find(|one| one.because().contains("they are what they are stepped as"));
        hypothesis.map(|one| (one.answer(), one.because())).unwrap()
    };
    assert_eq!(probed(&setup).0, Answer::NotShown);
    setup.reference = Arc::new(Misdescribed(setup.reference));
    let (answer, words) = probed(&setup);
    assert_eq!(answer, Answer::Violated);
    assert!(
        words.contains("z^(ℓ) is the linear form that `linear` says it is") && words.contains(" in place of "),
        "{words}"
    );
    let explanation = explain(&setup);
    assert_eq!((explanation.designs[0].order, explanation.designs[0].degrees), (None, None));
    let lines = explanation_lines(&setup, &explanation, &Footing::default());
    assert!(lines.iter().all(|line| !matches!(line, TextLine::Formula(..))), "{lines:?}");
    let said = |part: &str| lines.iter().any(|line| matches!(line, TextLine::Words(words) if words.contains(part)));
    assert!(
        said("they are not what they say") && said("until what `linear` returns is z^(ℓ) of the dynamics"),
        "{lines:?}"
    );
    assert_eq!(Residuals::of(&setup).unwrap().found()[0].1, []);
}

#[test]
fn they_run_are_reported_and_the_report_is_rebuilt() {
    let sampled = format!("{HOMES}\n[control]\nsample_hz = 200\n");
    let pushed =
        format!("{HOMES}\n[[external_wrenches]]\non = [\"mass-1\"]\nfrom_s = 1\nfor_s = 1\nby.force_n = [3, -2]\n");
    for (text, name) in [(HOMES, "continuous"), (&sampled, "sampled"), (&pushed, "pushed")] {
        let folder = tempfile::tempdir().unwrap();
        let (file, out) = (folder.path().join("homes.toml"), folder.path().join(name));
        fs::write(&file, text).unwrap();
        let (file, out_text) = (file.to_str().unwrap(), out.to_str().unwrap());
        assert_eq!(forwardstep(&["run", file, "--out", out_text]), ExitCode::SUCCESS, "the goal is met, {name}");
        assert_report_is_rebuilt(forwardstep, &out);
    }
}

#[test]
fn their_mistakes_are_reported_at_their_place_with_near_matches() {
    let cases = [
        ("reference.anchored", "reference.anchord", "10:12: unknown choice `anchord`", "did you mean `anchored`?"),
        ("weight = 0.7", "wieght = 0.7", "13:1: unknown key `wieght`", "did you mean `weight`?"),
        ("weight = 0.7", "weight = 0", "13:10: `weight` is 0, but must be positive", ""),
        ("[[0.5, 0], [0.5, 0], ", "[[0.5, 0], ", "12:9: `homes` is 2, but must be as many as agents", ""),
        ("[0.5, 0]]", "[0.5]]", "12:30: ", "2"),
        ("roots_per_s = [1, 2]\n", "", "10:2: ", "`roots_per_s` to [reference.anchored]"),
        ("roots_per_s = [1, 2]", "roots_per_s = [1, -2]", "11:19: ", "positive"),
        ("count = 3", "count = 3\nreference.consensus = {}", "7:1: ", "`reference.anchored`"),
        ("count = 3", "count = 3\nreference.anchored.manipulability_gain = 1", "7:", "`roots_per_s`"),
        ("[goal]", "[leader]\nmotion.formulas = [\"t\", \"0\"]\n\n[goal]", "23:1: ", "delete the leader"),
        ("disagreement_below", "error_below", "24:15: ", "write `disagreement_below`"),
        ("count = 3", "count = 3\ntarget.formulas = [\"0\", \"0\"]", "7:1: ", "leave its `target` out"),
        (
            "[law.adaptive]\ndamping.gain = 8\nadaptation_gain = 10",
            "[law.position_only]",
            "10:2: ",
            "`reference.consensus`",
        ),
        ("[network]", "[network]\ncoupling.tanh = 1", "20:1: ", "coupling"),
    ];
    for (from, to, place, help) in cases {
        assert_eq!(HOMES.matches(from).count(), 1, "{from}");
        let error = read(&HOMES.replace(from, to)).unwrap_err();
        let (said, found) = (error.to_string(), error.help().map(|help| help.to_string()).unwrap_or_default());
        assert!(said.starts_with(&format!("homes.toml:{place}")), "{said}");
        assert!(format!("{said} {found}").contains(help), "{said} {found}");
    }
}

#[test]
fn the_schema_holds_them_and_the_program_without_them_does_not_know_them() {
    let schema = example::kinds().unwrap().schema().to_value();
    for (choice, table) in [("ReferenceFile", "AnchoredFile"), ("AgentReferenceFile", "AgentReferenceTable")] {
        let all = schema["$defs"][choice]["oneOf"].as_array().unwrap();
        let own = all.iter().find(|one| one["required"][0] == "anchored").unwrap();
        assert_eq!(own["properties"]["anchored"]["$ref"], format!("#/$defs/{table}"));
        assert_eq!(schema["$defs"][table]["additionalProperties"], false);
    }
    let source = SourceText::new("homes.toml", HOMES);
    let error = forwardstep::io::scenario::read_scenario("homes", &source, None).unwrap_err();
    assert_eq!(error.to_string(), "homes.toml:10:12: unknown choice `anchored`");
}

#[test]
fn agents_have_roots_of_their_own() {
    let text = HOMES.replace("count = 3", "count = 3\nreference.anchored.roots_per_s = [1, 2, 3]");
    let Setup { agents, .. } = read(&text).unwrap().setup;
    assert!(agents.iter().all(|agent| agent.roots_per_s.real == [1.0, 2.0, 3.0]));
}

#[test]
fn what_its_author_says_is_declared_and_nothing_is_predicted() {
    let setup = read(HOMES).unwrap().setup;
    let Report { theorem, promises, hypotheses } = check(&setup);
    assert!(matches!(theorem, Theorem::Declared(source) if source.starts_with("Theorem 3")));
    assert!(promises.contains("come to rest"));
    let declared: Vec<_> = hypotheses.iter().filter(|hypothesis| hypothesis.id == Id::Declared).collect();
    assert_eq!(declared.len(), 2, "what it says, and what was tried");
    assert!(declared.iter().all(|hypothesis| hypothesis.answer() == Answer::NotShown));
    assert!(declared.iter().all(|hypothesis| hypothesis.rigour() == Rigour::Declared));
    assert!(predict(&setup).is_err());
}

/// Three masses, agent by agent with these roots.
fn masses(roots: [&[f64]; 3]) -> Vec<AgentSetup> {
    let mass = |k: usize| {
        let robot = RobotSetup::point_mass(2, 1.0 + 0.5 * k as f64);
        let law = forwardstep::sim::Adaptive {
            damping: forwardstep::core::Gain::Number(6.0),
            adaptation: forwardstep::core::Gain::Number(4.0),
            estimate_start: vec![0.3],
            bounds: None,
        };
        AgentSetup::new(format!("mass-{k}"), robot, law).roots(roots[k]).at(&[k as f64 - 1.0, 0.4 * k as f64])
    };
    (0..3).map(mass).collect()
}

/// What stands at a home: nothing moves it, and it hears nobody.
fn standing(k: usize, at: &[f64]) -> AgentSetup {
    let known = forwardstep::sim::Known::gain(1.0);
    AgentSetup::new(format!("home-{k}"), RobotSetup::point_mass(2, 1.0), known).roots([1.0, 2.0]).at(at)
}

const HOME: [[f64; 2]; 3] = [[0.2, -0.4], [1.0, 0.3], [-0.6, 0.9]];
const WEIGHT: f64 = 0.7;

/// The same network twice: with homes, and with agents that stand there.
fn both(roots: [&[f64]; 3]) -> [Setup; 2] {
    let over = |agents, schedule| Network {
        schedule,
        delays: vec![
            Delay::new(Sinusoid { mean_s: 0.3, amplitude_s: 0.2, period_s: 1.7, phase_rad: 0.4 }),
            Delay::constant(0.0),
        ],
        ..Network::silent(agents)
    };
    let schedule = |homes: bool| {
        let home = |k: usize| Edge { from: 3 + k, to: k, weight: WEIGHT.into(), delay: 1 };
        let graph = |edges: [(usize, usize, f64); 2]| {
            let mut edges: Vec<Edge> =
                edges.into_iter().map(|(from, to, w)| Edge { from, to, weight: w.into(), delay: 0 }).collect();
            edges.extend((0..3).filter(|_| homes).map(home));
            edges
        };
        Schedule::periodic(vec![
            Phase { edges: graph([(0, 1, 1.0), (1, 2, 0.4)]), dwell_s: 1.3 },
            Phase { edges: graph([(2, 0, 0.8), (1, 0, 0.5)]), dwell_s: 0.9 },
        ])
    };
    let agents = masses(roots);
    let anchored = Anchored { homes: HOME.map(Vec::from).to_vec(), weight: WEIGHT };
    let network = over(3, schedule(false));
    let own = Setup::new(agents.clone(), Arc::new(anchored), Exchange::Position, network, 12.0);
    let all: Vec<AgentSetup> =
        agents.into_iter().chain(HOME.iter().enumerate().map(|(k, at)| standing(k, at))).collect();
    let network = over(6, schedule(true));
    [own, Setup::new(all, Arc::new(Consensus), Exchange::Position, network, 12.0)]
}

fn run(mut setup: Setup) -> Outcome {
    setup.solver.method = forwardstep::sim::Method::Adaptive { rtol: 1e-10, atol: 1e-12 };
    simulate(&setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap()
}

/// Every column of the three masses is the same in both.
fn assert_same(setups: [Setup; 2], within: f64, name: &str) {
    let [own, others] = setups.map(run);
    let mut compared = 0;
    for column in &own.recording.columns {
        let other = others.recording.values(column.agent, column.signal, column.axis).unwrap();
        for (a, b) in column.values.iter().zip(other) {
            assert!((a - b).abs() < within * (1.0 + b.abs()), "{name}: {} {a} {b}", column.signal.name());
        }
        compared += 1;
    }
    assert!(compared > 30, "{name}: {compared}");
    assert!(own.recording.last(0, Signal::Position, 0).abs() > 1e-3);
}

#[test]
fn prop_a_home_is_a_neighbour_that_stands_still() {
    for (roots, name) in [
        ([&[1.5][..]; 3], "order one"),
        ([&[1.0, 2.0][..]; 3], "order two"),
        ([&[1.0, 2.0, 0.7, 3.0][..]; 3], "order four"),
        ([&[1.0, 2.0], &[0.5], &[2.0, 1.0, 1.5]], "orders of their own"),
    ] {
        assert_same(both(roots), 1e-7, name);
        assert_same(both(roots).map(|setup| setup.sampled(100.0)), 1e-7, &format!("{name}, sampled"));
        let pushed = both(roots).map(|mut setup| {
            let force = Course::Each([2.0, -1.0].map(Function::Constant).to_vec());
            setup.agents[1].pushes = vec![Push { effect: Effect::Torque(force), from_s: 1.0, until_s: 2.5 }];
            setup
        });
        assert_same(pushed, 1e-7, &format!("{name}, pushed"));
    }
}
