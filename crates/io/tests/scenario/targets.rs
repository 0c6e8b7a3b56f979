//! Targets from tables, and attitudes in both ways of writing them.

use std::ops::ControlFlow;
use std::path::Path;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, ScenarioError, read_scenario};
use forwardstep_sim::{Outcome, simulate};

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
    super::seeds::keep("csv", table);
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
