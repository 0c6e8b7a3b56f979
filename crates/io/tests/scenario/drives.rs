//! Rotors, friction and bounds of estimates: what the keys mean, and what is said of mistakes in them.

use forwardstep_core::robot::{Drives, PlanarArm, PointMass};
use forwardstep_io::scenario::{Scenario, ScenarioError};
use forwardstep_sim::Adaptive;
use miette::Diagnostic;

use super::read;

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
robot.urdf = { file = "gantry.urdf", damping = 0.3, armature = 0.2, friction.dry = { coulomb = [0.5, 0.1, 0.2], width = [0.02, 0.01, 0.01] } }
start.position_m = [0.0, 0.0, 0.0]

[[agents]]
name = "smooth"
robot.urdf = { file = "gantry.urdf", damping = [0.3, 0, 0.1], armature = [0.2, 0.1, 0.1], friction.smooth = { coulomb = 0.5, width = 0.02 } }
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

/// The same for robots in closed form, which agree with nobody.
pub(super) const CLOSED: &str = r#"format = 2

[time]
end_s = 1

[[agents]]
name = "arm"
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8], damping = 0.2, armature = 0.1, friction.dry = { coulomb = 0.5, width = 0.02, period_s = 0.002 } }
start.position_rad = [0.5, 1.0]

[[agents]]
name = "other-arm"
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8], damping = [0.2, 0], armature = [0, 0.1], friction.smooth = { coulomb = [0.5, 0.2], width = [0.02, 0.01] } }
start.position_rad = [0.5, 1.0]

[[agents]]
name = "dry-arm"
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8], friction.dry = { coulomb = [0.5, 0], width = [0.02, 0.01] } }
start.position_rad = [0.5, 1.0]

[[agents]]
name = "smooth-arm"
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8], friction.smooth = { coulomb = 0.5, width = 0.02 } }
start.position_rad = [0.5, 1.0]

[[agents]]
name = "mass"
robot.point_mass = { dimension = 2, mass_kg = 3.0, damping = 0.2, friction.dry = { coulomb = 0.5, width = 0.02, period_s = 0.002 } }
start.position_m = [0.5, 1.0]

[[agents]]
name = "other-mass"
robot.point_mass = { dimension = 2, mass_kg = 3.0, damping = [0.2, 0], friction.smooth = { coulomb = [0.5, 0.2], width = [0.02, 0.01] } }
start.position_m = [0.5, 1.0]

[reference.consensus]
roots_per_s = [1.0]
exchange = "position"

[law.adaptive]
bounds.within = 0.3

[network]
edges = []
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
    let drives = robot.interface().drives;
    assert_eq!((drives.geared.as_slice(), drives.dry_s), (&[0][..], Some(0.004)));
    assert_eq!(drives.friction.iter().map(|f| (f.joint, f.width)).collect::<Vec<_>>(), [(1, 0.02)]);
    let own = robot.theta.len() - 2;
    assert_eq!(robot.theta[own..], [0.2, 0.5]);
    assert_eq!(robot.theta_names[own..], ["panda_joint6.armature_kg_m2", "panda_joint7.friction_n_m"]);

    let scenario = with("friction.smooth = { coulomb = 0.3 }", "").unwrap();
    let robot = &scenario.setup.agents[0].robot;
    let drives = robot.interface().drives;
    assert_eq!((drives.dry_s, drives.friction.len(), drives.friction[0].width), (None, 2, 0.01));
    assert_eq!(robot.theta[robot.theta.len() - 2..], [0.3, 0.3]);
    // The file states none, and nothing else does.
    let scenario = with("friction.dry = {}", "").unwrap();
    assert!(scenario.setup.agents[0].robot.interface().drives.dry_s.is_none());
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

#[test]
fn a_small_damping_is_not_measured_by_the_torques_of_gravity() {
    // ϑ of the arm reaches 34 N m; a damping of 0.2 N m s is known to 30 % of itself.
    let scenario = read(CLOSED).unwrap();
    let bounds = scenario.setup.agents[0].law.downcast::<Adaptive>().unwrap().bounds.clone().unwrap();
    assert!((bounds.lower[5] - 0.14).abs() < 1e-12 && (bounds.upper[5] - 0.26).abs() < 1e-12, "{:?}", bounds.lower);
    // The armature, 0.1 kg m², and the friction, 0.5 N m.
    assert!((bounds.lower[7] - 0.07).abs() < 1e-12 && (bounds.upper[8] - 0.13).abs() < 1e-12);
    assert_eq!((bounds.lower[9], bounds.upper[10]), (0.0, 1.0));
}

#[test]
fn a_damping_in_the_scenario_is_a_parameter_of_every_joint_where_it_is_not_zero() {
    let damping = |keys: &str| with(keys, "").unwrap().setup.agents[0].robot.clone();
    let (none, some, all) = (damping("damping = 0"), damping("damping = [0, 0.7]"), damping("damping = 0.5"));
    assert_eq!((none.damping(), some.damping(), all.damping()), (vec![0.0; 2], vec![0.0, 0.7], vec![0.5; 2]));
    let bodies = none.theta.len();
    assert_eq!(some.theta_names[bodies..], ["panda_joint7.damping_n_m_s"]);
    assert_eq!((some.theta[bodies], all.theta.len()), (0.7, bodies + 2));
}

#[test]
fn robots_in_closed_form_have_the_same_keys_and_none_leaves_them_as_they_were() {
    let robots: Vec<_> = read(CLOSED).unwrap().setup.agents.into_iter().map(|agent| agent.robot).collect();
    let [arm, other, dry, _, mass, sliding] = &robots[..] else { panic!("{} robots", robots.len()) };
    let drives = |robot: &forwardstep_sim::RobotSetup| robot.interface().drives;
    assert_eq!((arm.damping(), arm.armature(), arm.coulomb()), (vec![0.2; 2], vec![0.1; 2], vec![0.5; 2]));
    assert_eq!((other.damping(), other.armature(), other.coulomb()), (vec![0.2, 0.0], vec![0.0, 0.1], vec![0.5, 0.2]));
    assert_eq!((drives(arm).dry_s, drives(other).dry_s, drives(dry).dry_s), (Some(0.002), None, Some(0.001)));
    assert_eq!(drives(other).friction.iter().map(|f| f.width).collect::<Vec<_>>(), [0.02, 0.01]);
    assert_eq!(mass.theta_names, ["mass", "x.damping_n_s_m", "y.damping_n_s_m", "x.friction_n", "y.friction_n"]);
    assert_eq!((sliding.theta.as_slice(), drives(sliding).dry_s), (&[3.0, 0.2, 0.5, 0.2][..], None));

    let text = |robot: &str| {
        CLOSED.split_once("robot.").unwrap().0.to_owned()
            + robot
            + "\nstart.position = [0.5, 1.0]\n"
            + CLOSED.split_once("[reference").unwrap().1.replacen(".consensus]", "[reference.consensus]", 1).as_str()
    };
    let plain = |robot: &str| read(&text(robot)).unwrap().setup.agents[0].robot.clone();
    let bare = plain(
        "robot.planar_arm = { mass_kg = [2, 1], length_m = [1, 1], damping = 0, friction.dry = { coulomb = 0 } }",
    );
    assert!(bare.kind.is::<PlanarArm>() && drives(&bare) == Drives::default());
    assert!(plain("robot.point_mass = { dimension = 2, mass_kg = 1 }").kind.is::<PointMass>());
    for (robot, said) in [
        ("planar_arm = { mass_kg = [2, 1], length_m = [1, 1], armature = [0.1] }", "`armature` has 1 entry"),
        ("planar_arm = { mass_kg = [2, 1], length_m = [1, 1], friction.dry = {} }", "coulomb"),
        ("planar_arm = { mass_kg = [2, 1], length_m = [1, 1], friction = \"ignore\" }", "unknown"),
        ("point_mass = { dimension = 2, mass_kg = 1, armature = 0.1 }", "unknown key `armature`"),
        ("point_mass = { dimension = 2, mass_kg = 1, damping = -1 }", "is -1, but must not be negative"),
        (
            "ship = { inertia = { surge_kg = 1, sway_kg = 1, yaw_kg_m2 = 1 }, friction.dry = { coulomb = 1 } }",
            "unknown key",
        ),
    ] {
        let error = read(&text(&format!("robot.{robot}"))).unwrap_err().to_string();
        assert!(error.contains(said), "{robot}: {error}");
    }
    // Where robots differ, what acts at their joints does not.
    for robot in [
        "planar_arm = { mass_kg = [2, 1], length_m = [1, 1], damping = 0.2, armature = 0.1, friction.dry = { coulomb = 0.5 } }",
        "point_mass = { dimension = 2, mass_kg = 1, damping = 0.2, friction.dry = { coulomb = 0.5 } }",
    ] {
        let same = plain(&format!("robot.{robot}"));
        let two = text(&format!("robot.{robot}\ncount = 2\nparameter_variation = {{ seed = 1, relative = 0.1 }}"));
        let two = two.replace("start.position = [0.5, 1.0]", "start.position = [[0.5, 1.0], [0.5, 1.0]]");
        let varied = read(&two).unwrap().setup.agents[0].robot.clone();
        let bodies = same.theta.len() - drives(&same).count();
        assert!(same.theta[..bodies].iter().zip(&varied.theta).all(|(one, other)| one != other), "{:?}", varied.theta);
        assert_eq!((&same.theta[bodies..], drives(&same)), (&varied.theta[bodies..], drives(&varied)));
    }
    // Without a velocity nothing can be said against friction.
    let blind = text("robot.point_mass = { dimension = 2, mass_kg = 1, damping = 0.1 }")
        .replace("[law.adaptive]\nbounds.within = 0.3", "[law.position_only]");
    let error = read(&blind).unwrap_err().to_string();
    assert!(error.contains("point masses without damping and friction"), "{error}");
}

/// Dummy links, of which exports have many.
#[test]
fn a_link_without_mass_moves_where_its_joint_has_an_armature() {
    use forwardstep_check::{Answer, Id, check};
    use forwardstep_io::scenario::open_scenario;
    let folder = tempfile::tempdir().unwrap();
    let body = "<inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let joint = |k: usize| {
        let held = if k == 0 { "base".into() } else { format!("l{}", k - 1) };
        format!(
            "<joint name='j{k}' type='revolute'><parent link='{held}'/><child link='l{k}'/><axis xyz='0 1 0'/>\
             <origin xyz='0.3 0 0'/><limit lower='-1' upper='1' effort='9' velocity='9'/></joint>"
        )
    };
    let urdf = format!(
        "<robot name='r'><link name='base'/><link name='l0'>{body}</link><link name='l1'/>{}{}</robot>",
        joint(0),
        joint(1)
    );
    std::fs::write(folder.path().join("dummy.urdf"), urdf).unwrap();
    let path = folder.path().join("own.toml");
    let opened = |armature: &str| {
        let robot = format!("robot.urdf = {{ file = \"dummy.urdf\"{armature} }}");
        let text = ONE.replace(ONE.lines().find(|line| line.starts_with("robot.urdf")).unwrap(), &robot);
        std::fs::write(&path, text.replace("LAW", "")).unwrap();
        open_scenario(path.to_str().unwrap()).map_err(|error| error.to_string())
    };
    for armature in [", armature = 0.05", ", armature = [0, 0.05]"] {
        let report = check(&opened(armature).unwrap().setup);
        let inertia = report.hypotheses.iter().find(|found| found.id == Id::UniformInertia).unwrap();
        assert_eq!(inertia.answer(), Answer::Holds, "{armature}");
    }
    for armature in ["", ", armature = [0.05, 0]", ", armature = 0", ", armature = [0.05]", ", armature = -1"] {
        let error = opened(armature).unwrap_err();
        let counted = armature.ends_with("[0.05]");
        let said = if counted { "`armature` has 1 entry" } else { "joint `j1` feels the inertia 0 kg m² of `l1`" };
        assert!(error.contains(said), "{armature}: {error}");
    }
}
