//! Pushes: what is read of them, and what every mistake gets.

use std::path::Path;

use forwardstep_core::robot::tree::Axes;
use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, ScenarioError, read_scenario};
use forwardstep_sim::push::{AttachmentPoint, Between, Course, Effect, Function, Push};
use forwardstep_sim::simulate;

use super::{as_stated, read};

/// Every way to push once, but for CSV files, which need a folder.
pub(super) const PUSHES: &str = r#"format = 2
time = { end_s = 10 }
[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
[[agents]]
name = "ur"
robot.urdf = { file = "ur5e.urdf", locked = { shoulder_lift_joint = 0, elbow_joint = 1, wrist_2_joint = 0, wrist_3_joint = 0 } }
[[agents]]
name = "cart"
robot.point_mass = { dimension = 2, mass_kg = 4.0 }
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
manipulability_gain = 2.0
[law.known]
[network]
edges.ring = {}
[[external_wrenches]]
on = ["arm", "ur"]
from_s = 1
for_s = 0.5
by.torque_n_m = [5, "2*sin(3*t)"]
[[external_wrenches]]
on = ["cart"]
by.force_n.rows = { times_s = [2, 3, 4], values = [[0, 0], [1, 2], [0, 0]], interpolate = "hold" }
[[external_wrenches]]
on = ["cart", "arm-1"]
from_s = 3
by.effort = [0.5, 0]
[[external_wrenches]]
on = ["ur"]
from_s = 2
for_s = 1
by.wrench = { link = "tool0", at_m = [0, 0, 0.1], axes = "link", force_n = [0, 0, 9], torque_n_m = [1, 0, 0] }
[[external_wrenches]]
on = ["arm-2"]
from_s = 2
for_s = 1
by.wrench = { force_n = [3, 4], torque_n_m = [0.5] }
[[external_wrenches]]
on = ["arm-1"]
from_s = 5
for_s = 2
by.virtual_spring_on_axes = { axes = ["elbow"], stiffness = 40, damping = [3], target_rad.rows = { times_s = [5, 7], values = [0, 1] } }
[[external_wrenches]]
on = ["ur"]
from_s = 6
for_s = 1
by.virtual_spring_on_point = { link = "tool0", stiffness_n_per_m = 200, damping_n_s_m = 20, target_m = [0.4, "0.1*t", 0.5] }
"#;

fn pushes(text: &str) -> Vec<Vec<Push>> {
    let scenario = read(text).unwrap_or_else(|error| panic!("{error}"));
    scenario.setup.agents.into_iter().map(|agent| agent.pushes).collect()
}

fn numbers(course: &Course) -> Vec<f64> {
    match course {
        Course::Each(functions) => functions
            .iter()
            .map(|function| match function {
                Function::Constant(value) => *value,
                Function::Formula(formula) => formula.eval(1.0),
            })
            .collect(),
        Course::Table(table) => table.values.clone(),
    }
}

#[test]
fn pushes_reach_the_agents_they_name() {
    let [first, second, ur, cart] = <[Vec<Push>; 4]>::try_from(pushes(PUSHES)).unwrap();
    assert_eq!([first.len(), second.len(), ur.len(), cart.len()], [3, 3, 4, 2]);

    // A population by its name, every member alike.
    assert_eq!((first[0].from_s, first[0].until_s), (1.0, 1.5));
    assert_eq!(first[0], second[0]);
    let Effect::Torque(course) = &first[0].effect else { panic!("{first:?}") };
    assert!((numbers(course)[1] - 2.0 * 3.0_f64.sin()).abs() < 1e-14);

    assert_eq!(cart[0].span_s(), [2.0, 4.0]);
    let Effect::Torque(Course::Table(table)) = &cart[0].effect else { panic!("{cart:?}") };
    assert_eq!((table.between, &table.values), (Between::Hold, &vec![0.0, 0.0, 1.0, 2.0, 0.0, 0.0]));
    assert_eq!(cart[1].span_s(), [3.0, f64::INFINITY]);

    // Force and torque apart, each with zeros for the other.
    for (push, want) in ur[1..3].iter().zip([[0.0, 0.0, 9.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]]) {
        let Effect::Wrench { at: AttachmentPoint::Link { point, axes }, wrench } = &push.effect else {
            panic!("{push:?}")
        };
        assert_eq!((numbers(wrench).as_slice(), point.at, *axes), (&want[..], [0.0, 0.0, 0.1], Axes::Link));
        // tool0 is rigid with the last joint that is not locked.
        assert_eq!(point.link.body, Some(1));
    }
    for (push, want) in second[1..3].iter().zip([[3.0, 4.0, 0.0], [0.0, 0.0, 0.5]]) {
        let Effect::Wrench { at: AttachmentPoint::Tip(tip), wrench } = &push.effect else { panic!("{push:?}") };
        assert_eq!((numbers(wrench).as_slice(), tip.length_m), (&want[..], [1.0, 0.8]));
    }

    let Effect::SpringOnAxes { axes, stiffness, damping, target } = &first[2].effect else { panic!("{first:?}") };
    assert_eq!((axes, stiffness, damping, numbers(target)), (&vec![1], &vec![40.0], &vec![3.0], vec![0.0, 1.0]));
    let Effect::SpringOnPoint { stiffness, damping, target, .. } = &ur[3].effect else { panic!("{ur:?}") };
    assert_eq!((*stiffness, *damping, numbers(target)), (200.0, 20.0, vec![0.4, 0.1, 0.5]));
}

/// A rotorcraft, a vehicle and a mass without velocity; chains; a spacecraft. Each with what acts on it.
const KINDS: [&str; 3] = [
    r#"format = 2
time = { end_s = 1 }
[[agents]]
name = "rotor"
robot.rotorcraft = { mass_kg = 1.2, inertia_kg_m2 = [0.02, 0.02, 0.04] }
law.thrust.design.differentiable = { damping_per_s = 3 }
[[agents]]
name = "vehicle"
robot.vehicle = { mass_kg = 1.5 }
law.thrust.design.differentiable = { damping_per_s = 3 }
[[agents]]
name = "blind"
robot.point_mass = { dimension = 3, mass_kg = 2 }
law.position_only = { damping = 20 }
[reference.consensus]
roots_per_s = [1.0, 1.5, 2.0]
exchange = "position"
[network]
edges.ring = {}
[[external_wrenches]]
on = ["rotor"]
by.body_torque_n_m = [0.1, 0.2, 0.3]
[[external_wrenches]]
on = ["rotor", "vehicle", "blind"]
by.force_n = [1, 2, "3*t"]
[[external_wrenches]]
on = ["rotor", "blind"]
by.virtual_spring_on_axes = { axes = ["z"], stiffness = 4, target_m = [0.5] }
"#,
    r#"format = 2
time = { end_s = 1 }
[[agents]]
name = "chain"
robot.chain = { order = 3 }
law.linearising = { gain_per_s = 2 }
[[agents]]
name = "cascade"
robot.strict_feedback = { regressors = [["x1^2"], ["0"]], parameters = [0.5] }
law.adaptive_backstepping = { gains_per_s = 1, adaptation_gain = 1 }
[reference.consensus]
roots_per_s = [1.0, 1.5]
exchange = "position"
[network]
edges.ring = {}
[[external_wrenches]]
on = ["chain"]
by.disturbance = [0.5]
[[external_wrenches]]
on = ["cascade"]
by.disturbance.rows = { times_s = [0, 1], values = [[0, 1], [0, 2]] }
"#,
    r#"format = 2
time = { end_s = 1 }
[[agents]]
name = "craft"
robot.spacecraft = { inertia_kg_m2 = [10, 8, 6] }
law.attitude = { error_gain_per_s2 = 0.5, rate_gain_per_s = 1.2, filter_gain_per_s = 1, damping = 3 }
target.formulas = [0, 0, 0, 1]
[reference.tracking]
[[external_wrenches]]
on = ["craft"]
by.body_torque_n_m = [0.1, 0.2, "0.3*t"]
"#,
];

#[test]
fn what_acts_on_a_kind_stands_where_its_equations_take_it() {
    let torques = |pushes: &[Push]| -> Vec<Vec<f64>> {
        let course = |push: &Push| match &push.effect {
            Effect::Torque(course) => Some(numbers(course)),
            _ => None,
        };
        pushes.iter().filter_map(course).collect()
    };
    let [crafts, chains, spacecraft] = KINDS.map(pushes);
    // Forces on the axes, then torques on the body.
    assert_eq!(torques(&crafts[0]), [vec![0.0, 0.0, 0.0, 0.1, 0.2, 0.3], vec![1.0, 2.0, 3.0, 0.0, 0.0, 0.0]]);
    assert_eq!([&crafts[1], &crafts[2]].map(|own| torques(own)), [[vec![1.0, 2.0, 3.0]], [vec![1.0, 2.0, 3.0]]]);
    let hand = |push: &Push| matches!(&push.effect, Effect::SpringOnAxes { axes, .. } if *axes == [2]);
    assert!(hand(&crafts[0][2]) && hand(&crafts[2][1]));
    assert_eq!(torques(&chains[0]), [[0.5]]);
    assert_eq!(torques(&chains[1]), [[0.0, 1.0, 0.0, 2.0]]);
    assert_eq!(torques(&spacecraft[0]), [[0.1, 0.2, 0.3]]);
    for text in KINDS {
        assert!(simulate(&read(text).unwrap().setup, &mut |_| std::ops::ControlFlow::Continue(())).is_ok());
    }
}

#[test]
fn pushed_scenarios_run() {
    let scenario = read(PUSHES).unwrap();
    let mut setup = scenario.setup;
    setup.time.end_s = 0.5;
    assert!(simulate(&setup, &mut |_| std::ops::ControlFlow::Continue(())).is_ok());
    assert!(scenario.notices.iter().all(|notice| !notice.to_string().contains("push")));
}

#[test]
fn arms_that_differ_are_held_at_their_own_tips() {
    let text = PUSHES.replace("count = 2\n", "count = 2\nparameter_variation = { seed = 1, relative = 0.2 }\n");
    let agents = pushes(&text.replace("on = [\"arm-2\"]", "on = [\"arm\"]"));
    let tip = |pushes: &[Push]| {
        pushes.iter().find_map(|push| match push.effect {
            Effect::Wrench { at: AttachmentPoint::Tip(tip), .. } => Some(tip.length_m),
            _ => None,
        })
    };
    let (first, second) = (tip(&agents[0]).unwrap(), tip(&agents[1]).unwrap());
    assert_ne!(first, second);
    assert!(first != [1.0, 0.8] && (0.8..1.2).contains(&first[0]));
}

#[test]
fn pushes_that_come_too_late_are_noted() {
    for late in ["from_s = 10\n", "from_s = 20\nfor_s = 1\n"] {
        let text = PUSHES.replace("on = [\"cart\", \"arm-1\"]\nfrom_s = 3\n", &format!("on = [\"cart\"]\n{late}"));
        let notices: Vec<_> = read(&text).unwrap().notices.iter().map(ToString::to_string).collect();
        assert!(notices.contains(&"the push on line 28 does not act during the run".into()), "{notices:?}");
    }
}

/// What to replace in [`PUSHES`], by what, the first line of the error, and a part of the help.
type Case = (&'static str, &'static str, &'static str, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    ("[[external_wrenches]]\non = [\"cart\"]", "[external_wrenches]\non = [\"cart\"]",
        "test.toml:25:2: not valid TOML: duplicate key", ""),
    ("on = [\"arm\", \"ur\"]", "on = []",
        "test.toml:21:6: `on` is empty", ""),
    ("on = [\"arm\", \"ur\"]", "on = \"arm\"",
        "test.toml:21:6: found \"arm\" where a list should stand", ""),
    ("on = [\"arm\", \"ur\"]", "on = [\"arm\", \"ur3\"]",
        "test.toml:21:14: there is no agent `ur3`", "did you mean `ur`? the agents are `arm-1`, `arm-2`, `ur`, `cart`, `arm`"),
    ("on = [\"arm\", \"ur\"]", "on = [\"arm\", \"arm-2\"]",
        "test.toml:21:14: `arm-2` is named twice in `on`", "the name of a counted population stands for all of it"),
    ("on = [\"arm\", \"ur\"]\n", "",
        "test.toml:20:1: the key `on` is missing", ""),
    ("by.torque_n_m = [5, \"2*sin(3*t)\"]\n", "",
        "test.toml:20:1: the key `by` is missing", ""),
    ("from_s = 1\nfor_s = 0.5", "from_s = -1\nfor_s = 0.5",
        "test.toml:22:10: `from_s` is -1, but must not be negative", ""),
    ("from_s = 1\nfor_s = 0.5", "from_s = 1\nfor_s = 0",
        "test.toml:23:9: `for_s` is 0, but must be positive", ""),
    ("from_s = 1\nfor_s = 0.5", "from = 1\nfor_s = 0.5",
        "test.toml:22:1: unknown key `from`", "did you mean `from_s`?"),
    ("from_s = 1\nfor_s = 0.5", "from_s = 1\nuntil_s = 0.5",
        "test.toml:23:1: unknown key `until_s`", "allowed here: `on`, `from_s`, `for_s`, `by`"),
    ("by.torque_n_m = [5,", "by.torque_nm = [5,",
        "test.toml:24:4: unknown choice `torque_nm`", "did you mean `torque_n_m`?"),
    ("by.torque_n_m = [5,", "by.effort = [0, 0]\nby.torque_n_m = [5,",
        "test.toml:25:4: both `effort` and `torque_n_m` are given, but only one can be", ""),
    ("by.torque_n_m = [5,", "by.torque_n_m = [5, 6,",
        "test.toml:24:17: `torque_n_m` has 3 entries, but `arm-1` needs 2", ""),
    ("by.torque_n_m = [5, \"2*sin(3*t)\"]", "by.torque_n_m = 5",
        "test.toml:24:17: found 5 where a list of numbers and formulas, or a table of csv or rows should stand", ""),
    ("by.torque_n_m = [5, \"2*sin(3*t)\"]", "by.torque_n_m = [5, true]",
        "test.toml:24:21: found true where a number or a formula in t should stand", ""),
    ("by.torque_n_m = [5, \"2*sin(3*t)\"]", "by.torque_n_m = {}",
        "test.toml:24:17: nothing is chosen here", "choose one of `csv`, `rows`"),
    ("by.torque_n_m = [5, \"2*sin(3*t)\"]", "by = \"torque_n_m\"",
        "test.toml:24:6: `torque_n_m` needs a value", "write it with its value"),
    ("\"2*sin(3*t)\"", "\"2*sine(3*t)\"",
        "test.toml:24:24: there is no function `sine`", "did you mean `sin`?"),
    ("\"2*sin(3*t)\"", "\"2*sin(3*t\"",
        "test.toml:24:27: this parenthesis is not closed", ""),
    ("\"2*sin(3*t)\"", "\"sqrt(1.2 - t)\"",
        "test.toml:24:21: this formula cannot be shown to have a value at all times from 1 s to 1.5 s", "let the push begin later or end sooner"),
    ("by.force_n.rows", "by.torque_n_m.rows",
        "test.toml:27:4: `torque_n_m` does not fit `cart`, whose axis `x` is measured in m", "`effort` takes N m or N as each axis has it"),
    ("by.torque_n_m = [5,", "by.force_n = [5,",
        "test.toml:24:14: `force_n` does not fit `arm-1`, whose axis `shoulder` is measured in rad", "`effort` takes N m or N as each axis has it"),
    ("times_s = [2, 3, 4]", "times_s = [2, 3, 3]",
        "test.toml:27:38: `times_s` goes from 3 to 3, but must rise", ""),
    ("times_s = [2, 3, 4]", "times_s = [2, 3]",
        "test.toml:27:48: `values` has 3 entries, but `times_s` has 2 entries", ""),
    ("times_s = [2, 3, 4], values = [[0, 0], [1, 2], [0, 0]]", "times_s = [2], values = [[0, 0]]",
        "test.toml:27:4: a table over time needs at least 2 rows, but this one has 1", ""),
    ("[1, 2], [0, 0]]", "[1], [0, 0]]",
        "test.toml:27:60: `force_n` has 1 entry, but `cart` needs 2", ""),
    ("[1, 2], [0, 0]]", "1, [0, 0]]",
        "test.toml:27:60: `force_n` has 1 entry, but `cart` needs 2", ""),
    ("interpolate = \"hold\"", "interpolate = \"cubic\"",
        "test.toml:27:91: unknown choice `cubic`", "choose one of `linear`, `hold`"),
    ("link = \"tool0\", at_m", "link = \"tool\", at_m",
        "test.toml:36:22: `ur` has no link `tool`", "did you mean `tool0`?"),
    ("link = \"tool0\", at_m", "link = \"base_link\", at_m",
        "test.toml:36:22: the link `base_link` of `ur` is fixed to the base, so that pushing it does nothing", ""),
    ("link = \"tool0\", at_m", "at_m",
        "test.toml:36:1: `ur` has 8 links, but the push does not say on which it acts", "name one, such as `link = \"tool0\"`"),
    ("axes = \"link\"", "axes = \"tool\"",
        "test.toml:36:58: unknown choice `tool`", "choose one of `base`, `link`"),
    ("at_m = [0, 0, 0.1]", "at_m = [0, 0.1]",
        "test.toml:36:38: found a list of 2 where 3 are needed", ""),
    ("force_n = [0, 0, 9]", "force_n = [0, 9]",
        "test.toml:36:76: `force_n` has 2 entries, but `ur` needs 3", ""),
    ("force_n = [0, 0, 9], torque_n_m = [1, 0, 0] }", "}",
        "test.toml:36:1: the wrench has neither `force_n` nor `torque_n_m`", "for example `force_n = [0, 0, 10]`"),
    ("{ force_n = [3, 4]", "{ link = \"tip\", force_n = [3, 4]",
        "test.toml:41:22: `arm-2` is a planar arm, which is pushed at its end-effector", "delete `link`"),
    ("{ force_n = [3, 4]", "{ axes = \"link\", force_n = [3, 4]",
        "test.toml:41:22: `arm-2` is a planar arm, which is pushed at its end-effector", "delete `axes`"),
    ("{ force_n = [3, 4]", "{ at_m = [0, 0, 1], force_n = [3, 4]",
        "test.toml:41:22: `arm-2` is a planar arm, which is pushed at its end-effector", "delete `at_m`"),
    ("{ force_n = [3, 4]", "{ force_n = [3, 4, 5]",
        "test.toml:41:25: `force_n` has 3 entries, but `arm-2` needs 2", ""),
    ("torque_n_m = [0.5]", "torque_n_m = [0, 0, 0.5]",
        "test.toml:41:46: `torque_n_m` has 3 entries, but `arm-2` needs 1", ""),
    ("on = [\"arm-2\"]", "on = [\"cart\"]",
        "test.toml:41:1: `cart` has no links", "use `by.force_n`"),
    ("axes = [\"elbow\"]", "axes = [\"elbo\"]",
        "test.toml:46:39: `arm-1` has no axis `elbo`", "did you mean `elbow`? its axes are `shoulder`, `elbow`"),
    ("axes = [\"elbow\"]", "axes = [\"elbow\", \"elbow\"]",
        "test.toml:46:48: the axis `elbow` is named twice", ""),
    ("axes = [\"elbow\"]", "axes = []",
        "test.toml:46:38: `axes` is empty", ""),
    ("stiffness = 40", "stiffness = -40",
        "test.toml:46:61: `stiffness` is -40, but must not be negative", ""),
    ("stiffness = 40", "stiffness = [40, 40]",
        "test.toml:46:61: `stiffness` has 2 entries, but the virtual spring holds 1 of the axes of `arm-1`", ""),
    ("stiffness = 40, ", "",
        "test.toml:46:29: the key `stiffness` is missing", ""),
    ("damping = [3]", "damping = [-3]",
        "test.toml:46:76: `damping` is -3, but must not be negative", ""),
    ("target_rad.rows", "target_m.rows",
        "test.toml:46:80: `target_m` does not fit `arm-1`, whose axis `elbow` is measured in rad", "`target` takes rad or m as each axis has it"),
    ("target_rad.rows", "target = [1], target_rad.rows",
        "test.toml:46:89: both `target_rad` and `target` are given, but they say the same", ""),
    (", target_rad.rows = { times_s = [5, 7], values = [0, 1] }", "",
        "test.toml:46:1: the virtual spring has no target", "`target_rad`, `target_m`, or `target` for any axes"),
    ("stiffness_n_per_m = 200", "stiffness_n_m = 200",
        "test.toml:51:48: unknown key `stiffness_n_m`", "did you mean `stiffness_n_per_m`?"),
    ("stiffness_n_per_m = 200", "stiffness_n_per_m = -200",
        "test.toml:51:68: `stiffness_n_per_m` is -200, but must not be negative", ""),
    ("target_m = [0.4, \"0.1*t\", 0.5]", "target_m = [0.4, \"0.1*t\"]",
        "test.toml:51:104: `target_m` has 2 entries, but `ur` needs 3", ""),
    ("target_m = [0.4, \"0.1*t\", 0.5]", "target_m = [0.4, \"log(t-8)\", 0.5]",
        "test.toml:51:110: this formula cannot be shown to have a value at all times from 6 s to 7 s", "keep roots, logarithms and quotients"),
    ("by.force_n.rows = {", "by.force_n.csv = { file = \"push.csv\", interpolate = \"hold\" } #",
        "test.toml:27:27: cannot read the table `push.csv`: there is no such file", ""),
];

fn changed(from: &str, to: &str) -> String {
    assert_eq!(PUSHES.matches(from).count(), 1, "{from:?} must occur once");
    PUSHES.replace(from, to)
}

#[test]
fn every_mistake_in_a_push_is_reported_at_its_place() {
    let cases = CASES.iter().map(|(from, to, line, help)| ((*to).to_owned(), read(&changed(from, to)), *line, *help));
    as_stated(cases);
}

fn beside(folder: &Path, interpolate: &str) -> Result<Scenario, ScenarioError> {
    let csv = format!("by.torque_n_m.csv = {{ file = \"push.csv\"{interpolate} }}");
    let text = changed("by.torque_n_m = [5, \"2*sin(3*t)\"]", &csv).replace("[\"arm\", \"ur\"]", "[\"arm\"]");
    read_scenario("test", &SourceText::new("test.toml", text), Some(folder))
}

#[test]
fn tables_over_time_are_read_by_the_names_of_the_axes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("push.csv"), "elbow, t_s, shoulder\n1,0.5,2\n3,1.25,4\n5,3,6\n").unwrap();
    for (interpolate, between) in [("", Between::Linear), (", interpolate = \"hold\"", Between::Hold)] {
        let scenario = beside(folder.path(), interpolate).unwrap_or_else(|error| panic!("{error}"));
        for agent in &scenario.setup.agents[..2] {
            let Effect::Torque(Course::Table(table)) = &agent.pushes[0].effect else { panic!("{agent:?}") };
            assert_eq!(table.times_s, [0.5, 1.25, 3.0]);
            assert_eq!((&table.values, table.between), (&vec![2.0, 1.0, 4.0, 3.0, 6.0, 5.0], between));
            // Cut to the times of the push.
            assert_eq!(agent.pushes[0].span_s(), [1.0, 1.5]);
        }
    }
}

/// A table, the first line of the error after the folder, and a part of the help.
#[rustfmt::skip]
const TABLES: &[(&str, &str, &str)] = &[
    ("", "push.csv: the table is empty", "they are `t_s`, `shoulder`, `elbow`"),
    ("t_s,shoulder\n", "push.csv:1:1: the column `elbow` is missing", "they are `t_s`, `shoulder`, `elbow`"),
    ("t_s,shoulder,elbo\n", "push.csv:1:14: unknown column `elbo`", "did you mean `elbow`?"),
    ("t_s,shoulder,elbow,elbow\n", "push.csv:1:20: a second column is named `elbow`", ""),
    ("t_s,shoulder,elbow\n1,2,\n", "push.csv:2:5: `elbow` is empty", ""),
    ("t_s,shoulder,elbow\n1,2,x\n", "push.csv:2:5: found \"x\" where a number should stand", ""),
    ("t_s,shoulder,elbow\n1,2,inf\n", "push.csv:2:5: inf is not a finite number", ""),
    ("t_s,shoulder,elbow\n1,2,3\n1,4,5\n", "push.csv:3:1: `t_s` goes from 1 to 1, but must rise", ""),
    ("t_s,shoulder,elbow\n1,2\n", "push.csv:2:1: this line has 2 entries, but there are 3 columns", ""),
    ("t_s,shoulder,elbow\n1,2,3\n", "test.toml:24:4: a table over time needs at least 2 rows, but this one has 1", ""),
];

#[test]
fn every_mistake_in_a_table_over_time_is_reported_at_its_place() {
    as_stated(TABLES.iter().map(|(table, line, help)| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("push.csv"), table).unwrap();
        crate::seeds::keep("csv", table);
        ((*table).to_owned(), beside(folder.path(), ""), *line, *help)
    }));
}
