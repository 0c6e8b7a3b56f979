//! Targets from tables, and attitudes in both ways of writing them.

use std::ops::ControlFlow;
use std::path::Path;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, ScenarioError, read_scenario};
use forwardstep_sim::{Ending, Method, Outcome, Signal, simulate};

use super::spacecraft::SPACECRAFT;
use super::tips::TIP;
use super::vehicles::VEHICLES;
use super::{as_stated, read};

const TARGET: &str = "target.formulas = [0, 0, \"sin(t)\", 1]";
const FROM_TABLE: &str = "target.csv.file = \"slew.csv\"";

fn craft(target: &str) -> String {
    assert_eq!(SPACECRAFT.matches(TARGET).count(), 1);
    SPACECRAFT.replace(TARGET, target)
}

fn beside(folder: &Path, text: &str) -> Result<Scenario, ScenarioError> {
    read_scenario("test", &SourceText::new("test.toml", text), Some(folder))
}

/// The scenario with this table beside it.
fn tabled(text: &str, table: &str) -> Result<Scenario, ScenarioError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("slew.csv"), table).unwrap();
    crate::seeds::keep("csv", table);
    beside(folder.path(), text)
}

fn run(scenario: &Scenario) -> Outcome {
    simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn bits(outcome: &Outcome) -> Vec<u64> {
    let columns = outcome.recording.columns.iter().map(|column| &column.values);
    columns.chain([&outcome.recording.t_s]).flatten().map(|value| value.to_bits()).collect()
}

#[test]
fn a_run_from_a_table_has_the_bits_of_the_run_from_the_same_points() {
    let points = "target.points = { times_s = [1, 3.5, 6], \
                  positions = [[0, 0, 0, 1], [0.1, 0.25, 0.3, 0.9], [0.2, 0.1, 0.7, 0.7]] }";
    let table = "o, x,y,z, t_s\n1,0,0,0,1\n0.9, 0.1,0.25,0.3, 3.5\n\n0.7,0.2,0.1,0.7,6\n";
    let [written, read] = [read(&craft(points)).unwrap(), tabled(&craft(FROM_TABLE), table).unwrap()];
    assert_eq!(written.setup.agents[0].target, read.setup.agents[0].target);
    assert_eq!(bits(&run(&written)), bits(&run(&read)));
    // The file is among what the run keeps.
    assert_eq!(read.inputs.iter().map(|input| input.name.as_str()).collect::<Vec<_>>(), ["slew.csv"]);
}

#[test]
fn columns_are_named_by_axes_and_those_of_tips_by_coordinates() {
    let first = |scenario: &Scenario| {
        let mut jets = [[0.0; 5]; 3];
        scenario.setup.agents.last().unwrap().target.as_ref().unwrap().jets(0.0, &mut jets);
        jets.map(|jet| jet[0])
    };
    let formulas = "target.formulas = [\"sin(t)\", 0, 0]";
    let text = VEHICLES.replace(formulas, FROM_TABLE);
    assert_eq!(first(&tabled(&text, "t_s,z,y,x\n0,3,2,1\n").unwrap()), [1.0, 2.0, 3.0]);
    let formulas = "target.formulas = [\"-0.6 + 0.1*cos(t)\", -0.4, 0.45]";
    let text = TIP.replace(formulas, FROM_TABLE).replace("[\"x\", \"y\", \"z\"]", "[\"z\", \"x\", \"y\"]");
    assert_eq!(first(&tabled(&text, "t_s,x,y,z\n0,-0.6,-0.4,0.45\n").unwrap()), [0.45, -0.6, -0.4]);
    // A leader moves along the axes of those who follow.
    let leader = r#"
        format = 2
        time.end_s = 5
        leader.motion.csv.file = "slew.csv"
        reference.leader = { design = "continuous", roots_per_s = [1.5], gain = 3 }
        network.edges = [["leader", "cart"]]
        [[agents]]
        name = "cart"
        robot.point_mass = { dimension = 2, mass_kg = 2 }
    "#;
    let setup = tabled(leader, "t_s,y,x\n0,2,1\n").unwrap().setup;
    let mut jets = [[0.0; 5]; 2];
    setup.following().unwrap().motion().unwrap().trajectory.jets(0.0, &mut jets);
    assert_eq!(jets.map(|jet| jet[0]), [1.0, 2.0]);
}

/// A table, the first line of the error, and a part of the help.
#[rustfmt::skip]
const TABLES: &[(&str, &str, &str)] = &[
    ("", "slew.csv: the table is empty", "they are `t_s`, `x`, `y`, `z`, `o`"),
    ("t_s,x,y,z,o\n", "test.toml:6:19: a table of points needs at least one row", ""),
    ("t_s,x,y,z\n0,0,0,0\n", "slew.csv:1:1: the column `o` is missing", "they are `t_s`, `x`, `y`, `z`, `o`"),
    ("t_s,x,y,z,w\n0,0,0,0,1\n", "slew.csv:1:11: unknown column `w`", "they are `t_s`, `x`, `y`, `z`, `o`"),
    ("time,x,y,z,o\n0,0,0,0,1\n", "slew.csv:1:1: unknown column `time`", "they are `t_s`, `x`, `y`, `z`, `o`"),
    ("t_s,x,y,z,o,o\n0,0,0,0,1,1\n", "slew.csv:1:13: a second column is named `o`", ""),
    ("t_s,x,y,z,o\n0,0,0,0,1\n1,0,0,1\n", "slew.csv:3:1: this line has 4 entries, but there are 5 columns", ""),
    ("t_s,x,y,z,o\n0,0,0,,1\n", "slew.csv:2:7: `z` is empty", ""),
    ("t_s,x,y,z,o\n0,0,0,0,one\n", "slew.csv:2:9: found \"one\" where a number should stand", ""),
    ("t_s,x,y,z,o\n0,0,0,0,nan\n", "slew.csv:2:9: nan is not a finite number", ""),
    ("t_s,x,y,z,o\n0,0,0,0,1e40\n", "slew.csv:2:9: 1e40 is too large a number", "up to 1e30"),
    ("t_s,x,y,z,o\n0,0,0,0,1\n2,0,0,0,1\n1,0,0,0,1\n", "slew.csv:4:1: `t_s` goes from 2 to 1, but must rise", ""),
    ("t_s,x,y,z,o\n0,0,0,0,1\n0,0,0,0,1\n", "slew.csv:3:1: `t_s` goes from 0 to 0, but must rise", ""),
    ("t_s,x,y,z,o\n0,0,0,0,1\n1e-100,0,0,1,1\n", "slew.csv:2:1: the points around row 1 are too close in time, or too far apart in value, for a smooth curve", ""),
    ("t_s,x,y,z,o\n0,0,0,0,0\n", "test.toml:6:1: this is no attitude at 0 s: its four entries are zero there", "any length but zero"),
];

#[test]
fn every_mistake_in_a_table_of_a_target_is_reported_at_its_place() {
    let text = craft(FROM_TABLE);
    as_stated(TABLES.iter().map(|(table, line, help)| ((*table).to_owned(), tabled(&text, table), *line, *help)));
}

#[test]
fn tables_with_other_names_are_offered_to_targets() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("slews.csv"), "t_s,x,y,z,o\n0,0,0,0,1\n").unwrap();
    let message = "test.toml:6:19: cannot read the table `slew.csv`: there is no such file";
    let case = (String::new(), beside(folder.path(), &craft(FROM_TABLE)), message, "did you mean `slews.csv`?");
    as_stated([case].into_iter());
}

#[test]
fn attitudes_are_read_in_both_ways_by_vehicles_and_spacecraft() {
    let quaternion = "start.attitude = [0, 0, 2, 2]";
    let turn = "start.attitude = { axis = [0, 0, 3], angle_rad = 1.5707963267948966 }";
    let near = |found: &[f64]| {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let gap = found.iter().zip([0.0, 0.0, half, half]).map(|(q, wanted)| (q - wanted).abs()).fold(0.0, f64::max);
        assert!(gap < 1e-15, "{found:?}");
    };
    let whole = SPACECRAFT.split("[agents.start.spacecraft]").next().unwrap();
    let after = SPACECRAFT.split("[agents.robot.spacecraft]").nth(1).unwrap();
    for attitude in [quaternion, turn] {
        let vehicle = VEHICLES.replace("start.attitude = [0, 0, 0, 1]", attitude);
        near(&read(&vehicle).unwrap().setup.agents[0].start.rest);
        let craft = format!("{whole}{attitude}\n[agents.robot.spacecraft]{after}");
        near(&read(&craft).unwrap().setup.agents[0].start.q);
    }
    // Both tables speak of spacecraft: the attitude from one, the wheels from the other.
    let both = SPACECRAFT.replace("[agents.start.spacecraft]\naxis = [1, 2, -1]\nangle_rad = 3.1\nrate_rad_s = [0.05, -0.03, 0.04]", "[agents.start]\nattitude = [0, 0, 1, 1]\nangular_velocity_rad_s = [0.05, -0.03, 0.04]\n[agents.start.spacecraft]");
    let start = &read(&both).unwrap().setup.agents[0].start;
    near(&start.q);
    assert_eq!((&start.dq[..], &start.rest[..]), (&[0.05, -0.03, 0.04][..], &[0.3, -0.2, 0.1][..]));
}

/// With small errors of integration.
fn exactly(mut scenario: Scenario) -> Outcome {
    scenario.setup.solver.method = Method::Adaptive { rtol: 1e-11, atol: 1e-13 };
    let outcome = run(&scenario);
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

/// Roots of what follows a target, from the fastest: as many as are asked for.
fn roots(count: usize) -> Vec<f64> {
    (0..count).map(|k| 3.0 - 2.2 * k as f64 / count as f64).collect()
}

/// The r-th derivative at zero of a sin(ω t + φ) and of an error c e^(−ρ t), with ρ the slowest of `count` roots.
fn begun([a, omega, phase]: [f64; 3], error: f64, count: usize, r: usize) -> f64 {
    let slowest = roots(count)[count - 1];
    let turn = phase + r as f64 * std::f64::consts::FRAC_PI_2;
    a * omega.powi(r as i32) * turn.sin() + error * (-slowest).powi(r as i32)
}

const WAVE: [f64; 3] = [0.8, 0.7, 0.3];

/// An agent of order `order` that is to follow the wave by `count` roots, and starts where its error is c e^(−ρ t) for ever, s being zero.
fn on_one_root(robot: &str, law: &str, order: usize, count: usize, axes: usize) -> String {
    let at = |r: usize| format!("{:?}", vec![begun(WAVE, 0.4, count, r); axes]);
    let names = ["position_m", "velocity_m_s"];
    let mut start: Vec<String> = (0..order.min(2)).map(|r| format!("start.{} = [{}]", names[r], at(r))).collect();
    if order > 2 {
        let all = (2..order).map(|r| begun(WAVE, 0.4, count, r)).collect::<Vec<_>>();
        start.push(format!("start.higher_states = [{all:?}]"));
    }
    let derivatives = (order..count).map(|r| format!("[{}]", at(r))).collect::<Vec<_>>().join(", ");
    // z is x^(order − 1).
    start.push(format!("start.reference = {{ z = [{}], derivatives = [{derivatives}] }}", at(order - 1)));
    let [a, omega, phase] = WAVE;
    let target = vec![format!("\"{a}*sin({omega}*t + {phase})\""); axes].join(", ");
    format!(
        "format = 2\ntime = {{ end_s = 12, record_every_s = 0.5 }}\n\
         [[agents]]\nname = \"one\"\nrobot.{robot}\n{}\ntarget.formulas = [{target}]\n\
         [reference.tracking]\nroots_per_s = {:?}\n{law}",
        start.join("\n"),
        roots(count)
    )
}

#[test]
fn eq_43_a_target_is_followed_by_as_many_derivatives_as_are_asked_for() {
    let chain = |order: usize| format!("chain = {{ order = {order}, chi = \"-x^3\", psi = \"2 + sin(x)\" }}");
    let vector = "vector_chain = { order = 2, chi = [\"-x1*x2\", \"sin(dx1)\"], psi = [[\"2\", \"sin(x1)\"], [\"-0.5\", \"2\"]] }";
    let linearising = "[law.linearising]\ngain_per_s = 2\n";
    let known = "[law.known]\ndamping.gain = 8\n";
    let cases = [
        (chain(1), linearising, 1, 6, 1),
        (chain(2), linearising, 2, 5, 1),
        (chain(3), linearising, 3, 7, 1),
        (chain(4), linearising, 4, 12, 1),
        (chain(6), linearising, 6, 9, 1),
        (vector.to_owned(), linearising, 2, 6, 2),
        ("point_mass = { dimension = 2, mass_kg = 3.0 }".to_owned(), known, 2, 6, 2),
    ];
    for (robot, law, order, count, axes) in cases {
        let text = on_one_root(&robot, law, order, count, axes);
        let scenario = read(&text).unwrap_or_else(|error| panic!("{text}\n{:?}", miette::Report::new(error)));
        let outcome = exactly(scenario);
        let slowest = roots(count)[count - 1];
        for axis in 0..axes {
            let of = |signal: Signal| {
                let found = outcome.recording.columns.iter().find(|c| (c.signal, c.axis) == (signal, axis));
                &found.unwrap_or_else(|| panic!("{signal:?}")).values
            };
            for ((t_s, x), error) in outcome.recording.t_s.iter().zip(of(Signal::Position)).zip(of(Signal::Error)) {
                let expected = 0.4 * (-slowest * t_s).exp();
                let desired = WAVE[0] * (WAVE[1] * t_s + WAVE[2]).sin();
                assert!((x - desired - expected).abs() < 1e-7, "{robot} {count} roots, {t_s}: {x}");
                assert!((error - expected).abs() < 1e-7, "{robot} {count} roots, {t_s}: {error}");
            }
        }
    }
}

#[test]
fn a_curve_through_points_is_followed_by_four_derivatives_and_by_more_it_is_refused() {
    let text = on_one_root("point_mass = { dimension = 1, mass_kg = 3.0 }", "[law.known]\ndamping.gain = 8\n", 2, 5, 1);
    let curve = text.replace(
        text.lines().find(|line| line.starts_with("target")).unwrap(),
        "target.points = { times_s = [0, 3, 6], positions = [[0.0], [1.0], [0.5]] }",
    );
    let error = read(&curve).unwrap_err();
    let said = format!("{:?}", miette::Report::new(error));
    assert!(said.contains("5 derivatives") && said.contains("at most 4 roots"), "{said}");
    let four = curve.replace(&format!("{:?}", roots(5)), &format!("{:?}", roots(4)));
    let four = four.lines().filter(|line| !line.starts_with("start.reference")).collect::<Vec<_>>().join("\n");
    assert!(read(&four).is_ok());
}

#[test]
fn more_derivatives_are_followed_at_samples_too() {
    let text = on_one_root(
        "chain = { order = 2, chi = \"-x^3\", psi = \"2\" }",
        "[law.linearising]\ngain_per_s = 2\n",
        2,
        6,
        1,
    );
    let errors = [100, 400].map(|rate| {
        let scenario = read(&format!("{text}\n[control]\nsample_hz = {rate}\n")).unwrap();
        let outcome = exactly(scenario);
        let column = outcome.recording.columns.iter().find(|c| c.signal == Signal::Error).unwrap();
        let slowest = roots(6)[5];
        let off = outcome.recording.t_s.iter().zip(&column.values);
        off.map(|(t_s, error)| (error - 0.4 * (-slowest * t_s).exp()).abs()).fold(0.0, f64::max)
    });
    // The hold is of the first order.
    assert!(errors[0] < 0.02 && errors[1] < 0.3 * errors[0], "{errors:?}");
}
