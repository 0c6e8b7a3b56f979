//! Reading URDF files: what is refused, what is noted, and what comes out.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod drives;
mod hostile;
mod notices;
mod pinocchio;
mod poses;
mod refusals;
mod robots;

use forwardstep_io::{Problem, SourceText, UrdfOptions, UrdfRobot, read_urdf};

const BASE: &str = r#"<link name="base"/>"#;
const ARM: &str = r#"<link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/><inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>"#;
const LIMIT: &str = r#"<limit lower="-1" upper="1" velocity="2" effort="3"/>"#;

/// A robot whose elements stand on lines 2, 3, ….
fn robot(lines: &[&str]) -> String {
    format!("<robot name=\"r\">\n{}\n</robot>\n", lines.join("\n"))
}

/// A joint of `kind` from `base` to `arm`.
fn joint(kind: &str, inside: &str) -> String {
    format!(r#"<joint name="turn" type="{kind}"><parent link="base"/><child link="arm"/>{inside}</joint>"#)
}

/// `<inertial>` with this centre of mass and these moments about it.
fn inertial(com: &str, mass: f64, [xx, yy, zz]: [f64; 3]) -> String {
    format!(
        r#"<inertial><origin xyz="{com}"/><mass value="{mass}"/><inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/></inertial>"#
    )
}

fn read(text: &str) -> Result<UrdfRobot, String> {
    read_with(text, &UrdfOptions::default())
}

/// The robot, or the error and its help as the user sees them.
fn read_with(text: &str, options: &UrdfOptions) -> Result<UrdfRobot, String> {
    crate::seeds::keep("urdf", text);
    read_urdf(&SourceText::new("r.urdf", text), options).map_err(|error| match error.problem.help() {
        Some(help) => format!("{error}\n  help: {help}"),
        None => error.to_string(),
    })
}

fn locked(joints: &[(&str, f64)]) -> UrdfOptions {
    UrdfOptions {
        locked: joints.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        ..UrdfOptions::default()
    }
}

fn notices(robot: &UrdfRobot) -> Vec<String> {
    robot.notices.iter().map(ToString::to_string).collect()
}
