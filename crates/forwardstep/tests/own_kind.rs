//! A kind of robot and a law of one's own: scenario files, schema, messages, runs and reports know them.

#[path = "../examples/tank.rs"]
#[allow(dead_code, unreachable_pub, clippy::print_stderr, reason = "an example that is a program of its own")]
mod tank;

use std::fs;
use std::process::ExitCode;
use std::sync::Arc;

use crate::support::assert_report_is_rebuilt;
use forwardstep::check::{Answer, Id, Rigour, check};
use forwardstep::core::controller::{Balance, ControllerOutput, Feedback, FeedbackInput, Truth};
use forwardstep::core::plant::VectorField;
use forwardstep::io::SourceText;
use forwardstep::io::output::{LimitKind, Metrics};
use forwardstep::io::scenario::{Scenario, ScenarioError};
use forwardstep::own::{Fault, LawKind, LawReader, LawTable};
use forwardstep::{program_with, sim};
use miette::Diagnostic;
use schemars::JsonSchema;
use serde::Deserialize;
use sim::system::{Declaration, DeclaredClaim, Known};
use sim::{Assembly, Block, Exchange, Interface, Law, LawWords, ReferenceFamily, RobotSetup, SetupError, Signal};

const TANKS: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "tank"
count = 2
robot.tank = { area_m2 = 2, inflow_limit_m3_s = 0.5 }
parameter_variation = { seed = 1, relative = 0.1 }
start.position_m = [[0.2], [1.5]]
target.formulas = ["1 + 0.1*sin(t)"]

[law.level]
gain_per_s = 1.5

[reference.tracking]

[goal]
error_below = 1e-4
"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    tank::kinds().unwrap().read_scenario("tanks", &SourceText::new("tanks.toml", text), None)
}

fn forwardstep(arguments: &[&str]) -> ExitCode {
    let kinds = tank::kinds().unwrap();
    program_with(&kinds, ["forwardstep"].iter().chain(arguments).copied())
}

#[test]
fn it_runs_is_recorded_and_reported_and_the_report_is_rebuilt() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (folder.path().join("tanks.toml"), folder.path().join("run"));
    fs::write(&file, TANKS).unwrap();
    let (file, out_text) = (file.to_str().unwrap(), out.to_str().unwrap());
    assert_eq!(forwardstep(&["run", file, "--out", out_text, "--csv"]), ExitCode::SUCCESS, "the goal is met");
    let csv = fs::read_to_string(out.join("trajectory.csv")).unwrap();
    let header = csv.lines().next().unwrap();
    for column in ["tank-1.q.level", "tank-2.error.level", "tank-1.inflow", "tank-1.lyapunov", "tank-1.dissipation"] {
        assert!(header.split(',').any(|known| known == column), "no {column} in {header}");
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("family-inflow") && page.contains("<h3>Inflow"), "its signal has a card");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    let limit = &summary["metrics"]["limits_reached"][0];
    assert_eq!((limit["kind"].as_str(), limit["limit"].as_f64()), (Some("inflow"), Some(0.5)), "{limit}");
    let balance = summary["metrics"]["balance_residual"]["relative"].as_f64().unwrap();
    assert!(balance < 1e-5, "V + ∫ dissipation is constant to {balance}");

    assert_report_is_rebuilt(forwardstep, &out);
}

#[test]
fn its_mistakes_are_reported_at_their_place_with_near_matches() {
    let cases = [
        ("robot.tank =", "robot.tonk =", "7:7: unknown choice `tonk`", "did you mean `tank`?"),
        ("area_m2 = 2,", "aera_m2 = 2,", "7:16: unknown key `aera_m2`", "did you mean `area_m2`?"),
        ("area_m2 = 2,", "area_m2 = -2,", "7:26: `area_m2` is -2, but must be positive", ""),
        ("area_m2 = 2,", "area_m2 = 2e9,", "7:26: no tank is as large as this", "`area_m2` is in m²"),
        ("area_m2 = 2,", "", "7:14: the key `area_m2` is missing", ""),
        ("[law.level]", "[law.lever]", "12:6: unknown choice `lever`", "did you mean `level`?"),
        ("gain_per_s = 1.5", "gain_pers = 1.5", "13:1: unknown key `gain_pers`", "did you mean `gain_per_s`?"),
        (
            "[law.level]\ngain_per_s = 1.5",
            "[law.adaptive]",
            "12:2: agent `tank-1`: the law `adaptive` is made for arms and point masses",
            "for this robot there is `level`",
        ),
        (
            "start.position_m = [[0.2], [1.5]]",
            "start.velocity_m_s = [1]",
            "9:22: `velocity_m_s` says nothing about `tank-1`",
            "have `higher_states`",
        ),
    ];
    for (from, to, message, help) in cases {
        assert_eq!(TANKS.matches(from).count(), 1, "{from}");
        let error = read(&TANKS.replace(from, to)).unwrap_err();
        assert_eq!(error.to_string(), format!("tanks.toml:{message}"));
        let found = error.help().map(|help| help.to_string()).unwrap_or_default();
        assert!(found.contains(help), "{found}");
    }
    let arm = "robot.point_mass = { dimension = 1, mass_kg = 2 }";
    let error = read(&TANKS.replace("robot.tank = { area_m2 = 2, inflow_limit_m3_s = 0.5 }", arm)).unwrap_err();
    assert_eq!(error.to_string(), "tanks.toml:12:2: agent `tank-1`: the law `level` is made for tanks");
}

#[test]
fn its_usual_law_is_read_from_an_empty_table() {
    let error = read(&TANKS.replace("[law.level]\ngain_per_s = 1.5", "")).unwrap_err();
    assert_eq!(error.to_string(), "tanks.toml:7:1: the key `gain_per_s` is missing");
}

#[test]
fn its_limits_are_kept_where_they_are_enforced() {
    let text = TANKS.replace("count = 2", "count = 2\nenforce_limits = true");
    let setup = read(&text).unwrap().setup;
    let recording = sim::simulate(&setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap().recording;
    let limits = Metrics::of(&setup, &recording, None, None).limits_reached;
    assert_eq!(limits.len(), 2, "both start too far away");
    for limit in limits {
        assert_eq!((limit.enforced, limit.excess, limit.limit.abs()), (true, 0.0, 0.5));
        assert_eq!(limit.kind, LimitKind::Signal(Signal::Own(&tank::INFLOW)));
    }
}

#[test]
fn populations_of_it_differ() {
    let areas: Vec<f64> = read(TANKS).unwrap().setup.agents.iter().map(|agent| agent.robot.theta[0]).collect();
    assert!(areas[0] != areas[1] && areas.iter().all(|area| (1.8..=2.2).contains(area)), "{areas:?}");
}

#[test]
fn the_schema_holds_it() {
    let schema = tank::kinds().unwrap().schema().to_value();
    let holds = |choice: &str, key: &str, table: &str| {
        let all = schema["$defs"][choice]["oneOf"].as_array().unwrap();
        let own = all.iter().find(|one| one["required"][0] == key).unwrap();
        assert_eq!(own["properties"][key]["$ref"], format!("#/$defs/{table}"));
        assert_eq!(schema["$defs"][table]["additionalProperties"], false);
    };
    holds("RobotFile", "tank", "TankFile");
    holds("LawFile", "level", "LevelFile");
    holds("RobotFile", "point_mass", "PointMassFile");
}

#[test]
fn the_program_without_it_does_not_know_it() {
    let source = SourceText::new("tanks.toml", TANKS);
    let error = forwardstep::io::scenario::read_scenario("tanks", &source, None).unwrap_err();
    assert_eq!(error.to_string(), "tanks.toml:7:7: unknown choice `tank`");
}

#[test]
fn sampled_it_runs_as_well() {
    let text = format!("{TANKS}\n[control]\nsample_hz = 100\n");
    let outcome = sim::simulate(&read(&text).unwrap().setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
    let errors = outcome.recording.columns.iter().filter(|column| column.signal == Signal::Error);
    let last: Vec<f64> = errors.map(|column| *column.values.last().unwrap()).collect();
    assert!(last.len() == 2 && last.iter().all(|error| error.abs() < 5e-3), "{last:?}");
}

#[test]
fn what_its_author_says_of_it_is_reported_as_declared_and_never_as_shown() {
    let report = check(&read(TANKS).unwrap().setup);
    assert_eq!(report.theorem.name(), "declared");
    let declared: Vec<_> = report.hypotheses.iter().filter(|hypothesis| hypothesis.id == Id::Declared).collect();
    assert_eq!(declared.len(), 4, "a claim and a balance of each tank");
    for (index, hypothesis) in declared.into_iter().enumerate() {
        assert_eq!((hypothesis.answer(), hypothesis.rigour()), (Answer::NotShown, Rigour::Declared));
        let end = if index % 2 == 0 { "(declared, not shown)" } else { "it was so at 32 random states" };
        assert!(hypothesis.because().ends_with(end), "{}", hypothesis.because());
    }
}

#[test]
fn a_balance_that_is_not_what_happens_is_violated_with_the_state() {
    let mut setup = read(TANKS).unwrap().setup;
    setup.agents[1].law = Arc::new(Boasts);
    let report = check(&setup);
    assert_eq!(report.worst(), Answer::Violated);
    let violated: Vec<_> = report.hypotheses.iter().filter(|one| one.answer() == Answer::Violated).collect();
    assert_eq!(violated.len(), 1);
    assert!(violated[0].requires().contains("tank-2"), "{}", violated[0].requires());
    assert!(violated[0].because().contains("V̇ is what the law says at "), "{}", violated[0].because());
}

/// Moves as slowly as u = −(x − x_d)/10 does, and says that it is ten times as fast.
#[derive(Debug)]
struct Boasts;

impl Law for Boasts {
    fn words(&self) -> LawWords {
        LawWords { name: "the law that boasts", made_for: "tanks" }
    }

    fn interface(&self, _: &RobotSetup) -> Option<Interface> {
        Some(Interface::tracking(&["level"]))
    }

    fn known(&self) -> Known {
        let claim = DeclaredClaim { requires: "nothing".into(), because: "so it is".into() };
        Known::Declared(Declaration { source: "none".into(), promises: "speed".into(), claims: vec![claim] })
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let states = [(Signal::Position, 1)];
        let plant = VectorField::new(1, states, [(Signal::Torque, 1)], |_, u, dx| dx[0] = u[0]);
        let law = |given: FeedbackInput<'_>, asked: ControllerOutput<'_>| {
            let [x_d, dx_d, ..] = given.target(0);
            asked.input[0] = dx_d - 0.1 * (given.output[0] - x_d);
        };
        let balance = |_: Truth<'_, _>, given: FeedbackInput<'_>, _: &[f64]| {
            let error = given.output[0] - given.target(0)[0];
            Balance { value: 0.5 * error * error, dissipation: error * error }
        };
        let controller = Feedback::new(&plant, [], law, balance);
        assembly.solo(plant, controller)
    }
}

#[test]
fn a_law_from_outside_that_claims_nothing_or_to_be_checked_never_holds() {
    for known in [
        Known::Checked,
        Known::Declared(Declaration { source: "no proof".into(), promises: "much".into(), claims: Vec::new() }),
    ] {
        let mut setup = read(TANKS).unwrap().setup;
        for agent in &mut setup.agents {
            agent.law = Arc::new(Says { law: agent.law.clone(), known: known.clone() });
        }
        let report = check(&setup);
        assert_eq!(report.worst(), Answer::NotShown, "{known:?}");
    }
}

/// A law that says something else of itself.
#[derive(Debug)]
struct Says {
    law: Arc<dyn Law>,
    known: Known,
}

impl Law for Says {
    fn words(&self) -> LawWords {
        self.law.words()
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        self.law.interface(robot)
    }

    fn known(&self) -> Known {
        self.known.clone()
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        self.law.block(assembly)
    }
}

/// Its plant may have another number of axes than its robot, and it claims to send a velocity and to keep offsets, where it does neither.
#[derive(Debug)]
struct Unfit {
    axes: usize,
}

impl Law for Unfit {
    fn words(&self) -> LawWords {
        LawWords { name: "the law that does not fit", made_for: "tanks" }
    }

    fn interface(&self, _: &RobotSetup) -> Option<Interface> {
        let follows = &[ReferenceFamily::Target, ReferenceFamily::Consensus];
        let exchanges = &[Exchange::Position, Exchange::PositionVelocity];
        Some(Interface { exchanges, follows, offsets: true, ..Interface::tracking(&["level"]) })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let states = [(Signal::Position, 1)];
        let plant = VectorField::new(self.axes, states, [(Signal::Torque, 1)], |_, _, dx| dx.fill(0.0));
        let law = |_: FeedbackInput<'_>, asked: ControllerOutput<'_>| asked.input[0] = 0.0;
        let balance = |_: Truth<'_, _>, _: FeedbackInput<'_>, _: &[f64]| Balance { value: 0.0, dissipation: 0.0 };
        let controller = Feedback::new(&plant, [], law, balance);
        assembly.solo(plant, controller)
    }
}

/// Such a plant ran, or panicked when it was sampled.
#[test]
fn regress_a_plant_that_does_not_fit_its_robot_is_refused_in_continuous_time_and_sampled() {
    for text in [TANKS.to_owned(), format!("{TANKS}\n[control]\nsample_hz = 100\n")] {
        for axes in [0, 2] {
            let mut setup = read(&text).unwrap().setup;
            setup.agents[1].law = Arc::new(Unfit { axes });
            let error = sim::simulate(&setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap_err();
            assert!(
                matches!(&error, SetupError::Length { agent, error } if agent == "tank-2" && (error.need, error.got) == (1, axes)),
                "{error}"
            );
        }
    }
}

/// A velocity that a plant has not was the number behind its position.
#[test]
fn regress_what_a_law_claims_of_itself_is_held_against_its_plant_and_its_controller() {
    let consensus = "format = 2\ntime.end_s = 1\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = { dimension = 1, mass_kg = 1 }\n\
                     start.position_m = [[0], [1]]\n[reference.consensus]\nroots_per_s = [1]\nexchange = \"position\"\n[network]\nedges.ring = {}\n";
    for text in [TANKS.to_owned(), format!("{TANKS}\n[control]\nsample_hz = 100\n")] {
        let mut setup = read(&text).unwrap().setup;
        setup.agents.iter_mut().for_each(|agent| agent.law = Arc::new(Unfit { axes: 1 }));
        let refused =
            |setup: &sim::Setup| sim::simulate(setup, &mut |_| std::ops::ControlFlow::Continue(())).unwrap_err();
        let error = refused(&sim::Setup { exchange: Exchange::PositionVelocity, ..setup.clone() });
        assert!(matches!(error, SetupError::SendsPositionOnly { .. }), "{error}");
        setup.reference = read(consensus).unwrap().setup.reference;
        let error = refused(&setup);
        assert!(matches!(error, SetupError::NoOffsets { .. }), "{error}");
    }
}

/// Axes of one's own have no unit that is known; a signal of one's own says what it is in.
#[test]
fn regress_a_signal_of_ones_own_keeps_its_unit_on_axes_of_ones_own() {
    let mut setup = read(TANKS).unwrap().setup;
    let unit = |setup: &sim::Setup, signal| forwardstep::io::output::names::unit(setup, 0, signal, 0);
    assert_eq!(unit(&setup, Signal::Own(&tank::INFLOW)), "m^3/s");
    setup.agents[0].robot.axes[0].unit = sim::AxisUnit::Own;
    assert_eq!([Signal::Own(&tank::INFLOW), Signal::Position].map(|signal| unit(&setup, signal)), ["m^3/s", "1"]);
}

/// Its controller has a state that it does not show, and which reaches infinity at t = 1 s: χ̇ = χ².
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct HidingFile {}

impl LawKind for HidingFile {
    fn table() -> LawTable {
        LawTable { key: "hiding", description: "A state that nobody sees.", made_for: "tanks" }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<tank::Tank>()
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(Hiding))
    }
}

#[derive(Debug)]
struct Hiding;

impl Law for Hiding {
    fn words(&self) -> LawWords {
        LawWords { name: "the law that hides", made_for: "tanks" }
    }

    fn interface(&self, _: &RobotSetup) -> Option<Interface> {
        Some(Interface::tracking(&["level"]))
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let plant = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Torque, 1)], |_, _, dx| dx.fill(0.0));
        let law = |given: FeedbackInput<'_>, asked: ControllerOutput<'_>| {
            asked.input[0] = 0.0;
            asked.d_state[0] = given.state[0] * given.state[0];
        };
        let balance = |_: Truth<'_, _>, _: FeedbackInput<'_>, _: &[f64]| Balance { value: 0.0, dissipation: 0.0 };
        let controller = Feedback::new(&plant, [], law, balance).with_state([(Signal::Filter, vec![1.0])]);
        assembly.solo(plant, controller)
    }
}

/// The folder of such a run was one that `report` refused.
#[test]
fn regress_a_run_that_breaks_down_in_a_state_that_is_not_recorded_is_read_back() {
    fn program(arguments: &[&str]) -> ExitCode {
        let mut kinds = tank::kinds().unwrap();
        kinds.add_law::<HidingFile>().unwrap();
        program_with(&kinds, ["forwardstep"].iter().chain(arguments).copied())
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (folder.path().join("tanks.toml"), folder.path().join("run"));
    fs::write(&file, TANKS.replace("[law.level]\ngain_per_s = 1.5", "[law.hiding]")).unwrap();
    assert_ne!(program(&["run", file.to_str().unwrap(), "--out", out.to_str().unwrap()]), ExitCode::SUCCESS);
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("broke_down") && summary.contains(".y.level"), "{summary}");
    assert_report_is_rebuilt(program, &out);
}
