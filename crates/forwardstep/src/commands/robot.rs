//! `forwardstep robot`

use std::path::Path;

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use forwardstep::io::robot::{Dynamics, JointDescription, RobotDescription, open_robot, open_state};
use forwardstep::io::urdf::FrictionPolicy;
use forwardstep::io::{UrdfOptions, UrdfRobot};
use forwardstep::sim::quantity;

use super::dynamics::dynamics;
use crate::arguments::RobotOptions;
use crate::console::{BOLD, Console, FAIR, Plain, complain};
use crate::status::Status;

/// Describes a robot, or computes its dynamics at a state.
pub(crate) fn robot(options: &RobotOptions, console: &mut Console) -> Status {
    let RobotOptions { robot, lock, ignore_friction, json, at } = options;
    let friction = match *ignore_friction || at.is_some() {
        true => FrictionPolicy::Ignore,
        false => FrictionPolicy::Read,
    };
    let options = UrdfOptions { locked: lock.clone(), friction, ..UrdfOptions::default() };
    let robot = match open_robot(robot, &options) {
        Ok(robot) => robot,
        Err(error) => return complain(&error),
    };
    match at {
        Some(path) => match dynamics_at(path, &robot) {
            Ok(dynamics) if *json => console.json(dynamics.to_json()),
            Ok(dynamics) => {
                show_dynamics(&dynamics, &robot, console);
                show_notices(&RobotDescription::new(&robot).notices, console);
            }
            Err(status) => return status,
        },
        None => {
            let description = RobotDescription::new(&robot);
            if *json { console.json(description.to_json()) } else { show(&description, console) }
        }
    }
    Status::Fine
}

fn dynamics_at(path: &Path, robot: &UrdfRobot) -> Result<Dynamics, Status> {
    let state = open_state(path, robot).map_err(|error| complain(&error))?;
    dynamics(robot, &state).map_err(|error| {
        let help = error.help();
        complain(&Plain::with_help(error, help))
    })
}

fn show(description: &RobotDescription, console: &mut Console) {
    let RobotDescription { name, base, joints, bodies, moving_mass_kg, held_mass_kg, notices } = description;
    console.line(format_args!("{BOLD}{name}{BOLD:#} on its base {base}"));
    console.line("");
    let mut rows = vec![["joint", "type", "position", "velocity", "effort", "damping", "friction"].map(String::from)];
    rows.extend(joints.iter().map(joint_row));
    console.text(table(&rows, 2));
    console.line("A URDF states no armature; `robot.urdf.armature` of a scenario does.");
    console.line("");
    let mut rows = vec![["body", "mass", "centre of mass in its frame"].map(String::from)];
    rows.extend(bodies.iter().map(|body| {
        let centre = body.centre_of_mass_m.map(|centre| centre.map(short).join(", "));
        let centre = centre.map_or_else(|| "none".to_owned(), |centre| format!("({centre}) m"));
        [body.name.clone(), format!("{} kg", short(body.mass_kg)), centre]
    }));
    console.text(table(&rows, 1));
    console.line("");
    console.line(format_args!(
        "moving mass {} kg, held by the base {} kg",
        short(*moving_mass_kg),
        short(*held_mass_kg)
    ));
    show_notices(notices, console);
}

/// Type, and every limit with its unit.
fn joint_row(joint: &JointDescription) -> [String; 7] {
    let JointDescription { name, kind, unit, effort_unit, position_limits, velocity_limit, effort_limit, .. } = joint;
    let limit = |limit: &Option<f64>, unit: &str| match limit {
        Some(limit) => format!("{} {unit}", short(*limit)),
        None => "unlimited".to_owned(),
    };
    let position = position_limits.map_or_else(
        || format!("unlimited, {unit}"),
        |[lower, upper]| format!("{} to {} {unit}", short(lower), short(upper)),
    );
    let damping = match (joint.damping, *unit) {
        (0.0, _) => "none".to_owned(),
        (damping, "rad") => format!("{} N m s/rad", short(damping)),
        (damping, _) => format!("{} N s/m", short(damping)),
    };
    let friction = match joint.friction {
        0.0 => "none".to_owned(),
        friction => format!("{} {effort_unit}", short(friction)),
    };
    let (velocity, effort) = (limit(velocity_limit, &format!("{unit}/s")), limit(effort_limit, effort_unit));
    [name.clone(), (*kind).to_owned(), position, velocity, effort, damping, friction]
}

fn show_dynamics(dynamics: &Dynamics, robot: &UrdfRobot, console: &mut Console) {
    let Dynamics { joints, mass_matrix, gravity, tau, ddq } = dynamics;
    console.line(format_args!("{BOLD}{}{BOLD:#} without friction and damping, in rad or m, kg and s", robot.name));
    console.line("");
    let mut rows = vec![["joints", "g", "tau", "ddq"].map(String::from)];
    for (((joint, g), tau), ddq) in joints.iter().zip(gravity).zip(tau).zip(ddq) {
        rows.push([joint.clone(), number(*g), number(*tau), number(*ddq)]);
    }
    console.text(table(&rows, 1));
    console.line("");
    let mut rows = vec![vec!["M".to_owned()]];
    rows[0].resize(joints.len() + 1, String::new());
    for (joint, row) in joints.iter().zip(mass_matrix) {
        rows.push(std::iter::once(joint.clone()).chain(row.iter().map(|entry| number(*entry))).collect());
    }
    console.text(table(&rows, 1));
}

fn show_notices(notices: &[String], console: &mut Console) {
    for notice in notices {
        console.line(format_args!("{FAIR}note{FAIR:#}: {notice}"));
    }
}

/// Rows under each other; the first `words` columns hold words, the others numbers.
fn table<R: AsRef<[String]>>(rows: &[R], words: usize) -> String {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    for row in rows {
        table.add_row(row.as_ref());
    }
    for column in table.column_iter_mut().skip(words) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// To six digits, which is more than any file knows of a mass.
fn short(value: f64) -> String {
    number(quantity::rounded(value))
}

/// All digits, with a power of ten when the number is very large or small.
fn number(value: f64) -> String {
    quantity::number(value).to_string()
}
