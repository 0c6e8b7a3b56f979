//! Rotors, friction and bounds of estimates: what the keys mean, and what is said of mistakes in them.

use std::sync::Arc;

use forwardstep_core::robot::tree::Tree;
use forwardstep_io::scenario::{Scenario, ScenarioError};
use forwardstep_sim::Adaptive;
use miette::Diagnostic;

use crate::read;

const ONE: &str = r#"
format = 2

[time]
end_s = 1

[[agents]]
name = "arm"
robot.urdf = { file = "panda.urdf", locked = { panda_joint1 = 0, panda_joint2 = 0, panda_joint3 = 0, panda_joint4 = 0, panda_joint5 = 0 }, DRIVES }
start.position_rad = [0.0, 0.0]

[reference.consensus]
roots_per_s = [1.0]
exchange = "position"

[law.adaptive]
LAW

[network]
edges = []
"#;

/// Keys that no other scenario of the tests has.
pub(super) const DRIVES: &str = r#"format = 2

[time]
end_s = 1

[[agents]]
name = "dry"
robot.urdf = { file = "gantry.urdf", armature = 0.2, friction.dry = { coulomb = [0.5, 0.1, 0.2], width = [0.02, 0.01, 0.01] } }
start.position_m = [0.0, 0.0, 0.0]

[[agents]]
name = "smooth"
robot.urdf = { file = "gantry.urdf", armature = [0.2, 0.1, 0.1], friction.smooth = { coulomb = 0.5, width = 0.02 } }
start.position_m = [0.0, 0.0, 0.0]

[[agents]]
name = "smoother"
robot.urdf = { file = "gantry.urdf", friction.smooth = { coulomb = [0.5, 0.1, 0.2], width = [0.02, 0.01, 0.01] } }
start.position_m = [0.0, 0.0, 0.0]

[reference.consensus]
roots_per_s = [1.0]
exchange = "position"

[law.adaptive]
bounds.within = 0.3

[network]
edges = [["dry", "smooth"], ["smooth", "smoother"]]
"#;

fn with(drives: &str, law: &str) -> Result<Scenario, ScenarioError> {
    read(&ONE.replace("DRIVES", drives).replace("LAW", law))
}

fn mistake(drives: &str, law: &str) -> String {
    let error = with(drives, law).unwrap_err();
    format!("{error} | {}", error.help().map(|help| help.to_string()).unwrap_or_default())
}

#[test]
fn armature_and_friction_are_read_for_all_joints_or_for_each() {
    let scenario =
        with("armature = [0.2, 0], friction.dry = { coulomb = [0, 0.5], width = 0.02, period_s = 0.004 }", "").unwrap();
    let robot = &scenario.setup.agents[0].robot;
    let drives = robot.kind.downcast::<Arc<Tree>>().unwrap().drives().clone();
    assert_eq!((drives.geared.as_slice(), drives.dry_s), (&[0][..], Some(0.004)));
    assert_eq!(drives.friction.iter().map(|f| (f.joint, f.width)).collect::<Vec<_>>(), [(1, 0.02)]);
    let own = robot.theta.len() - 2;
    assert_eq!(robot.theta[own..], [0.2, 0.5]);
    assert_eq!(robot.theta_names[own..], ["panda_joint6.armature_kg_m2", "panda_joint7.friction_n_m"]);

    let scenario = with("friction.smooth = { coulomb = 0.3 }", "").unwrap();
    let robot = &scenario.setup.agents[0].robot;
    let drives = robot.kind.downcast::<Arc<Tree>>().unwrap().drives().clone();
    assert_eq!((drives.dry_s, drives.friction.len(), drives.friction[0].width), (None, 2, 0.01));
    assert_eq!(robot.theta[robot.theta.len() - 2..], [0.3, 0.3]);
    // The file states none, and nothing else does.
    let scenario = with("friction.dry = {}", "").unwrap();
    assert!(scenario.setup.agents[0].robot.kind.downcast::<Arc<Tree>>().unwrap().drives().dry_s.is_none());
}

#[test]
fn bounds_of_estimates_are_shares_of_the_parameters_and_a_friction_lies_between_zero_and_twice_itself() {
    let scenario = with("friction.dry = { coulomb = 0.5 }", "bounds.within = 0.3").unwrap();
    let agent = &scenario.setup.agents[0];
    let law = agent.law.downcast::<Adaptive>().unwrap();
    let (theta, bounds) = (&agent.robot.theta, law.bounds.as_ref().unwrap());
    let mass = theta[0];
    assert!((bounds.lower[0] - 0.7 * mass).abs() < 1e-12 && (bounds.upper[0] - 1.3 * mass).abs() < 1e-12);
    assert!((bounds.margin[0] - 0.03 * mass).abs() < 1e-12);
    let last = theta.len() - 1;
    assert_eq!((bounds.lower[last], bounds.upper[last]), (0.0, 1.0));
    assert!(bounds.lower.iter().zip(&bounds.upper).all(|(low, high)| low < high));
    // Without a start, the nearest to zero within them.
    assert_eq!((law.estimate_start[0], law.estimate_start[last]), (bounds.lower[0], 0.0));
    let p = theta.len();
    let list = |entry: &str| vec![entry; p].join(", ");
    let given =
        format!("bounds.given = {{ lower = [{}], upper = [{}] }}\nestimate_start = \"zero\"", list("-1"), list("3"));
    let scenario = with("friction.dry = { coulomb = 0.5 }", &given).unwrap();
    let law = scenario.setup.agents[0].law.downcast::<Adaptive>().unwrap();
    assert_eq!(law.bounds.as_ref().unwrap().upper, vec![3.0; p]);
    assert_eq!(law.estimate_start, vec![0.0; p]);
}

#[test]
fn mistakes_in_drives_and_bounds_have_a_place_and_say_what_is_wrong() {
    for (drives, law, said) in [
        ("armature = [0.2]", "", "test.toml:9:"),
        ("armature = [0.2]", "", "`armature` has 1 entry, but `axes` has 2 entries"),
        ("armature = -0.2", "", "is -0.2, but must not be negative"),
        ("friction.dry = { coulomb = [0.1, -0.5] }", "", "is -0.5, but must not be negative"),
        ("friction.dry = { coulomb = 0.1, width = 0 }", "", "is 0, but must be positive"),
        ("friction.dry = { coulomb = 0.1, period_s = 0 }", "", "`period_s` is 0, but must be positive"),
        ("friction.smooth = { coulomb = 0.1, period_s = 1 }", "", "unknown key `period_s`"),
        ("friction = \"dry\"", "", "`dry` needs a value"),
        ("friction.dri = {}", "", "did you mean `dry`?"),
        ("", "bounds.within = 0", "`bounds.within` is 0, but must be positive"),
        ("", "bounds.given = { lower = [0], upper = [1] }", "`lower` has 1"),
        ("", "bounds.within = 0.3\nadaptation_gain = [[1]]", ""),
    ] {
        let words = mistake(drives, law);
        assert!(words.contains(said), "{drives} {law}: {words}");
        assert!(words.contains("test.toml:"), "{words}");
    }
}
