//! A robot from a URDF, as a library: its dynamics at one state, and two of them that agree over a delay. Run it with
//! `cargo run --example urdf`, or with the path of a file of your own behind `--`.

use std::error::Error;

use forwardstep::core::Gain;
use forwardstep::core::robot::tree::Tree;
use forwardstep::core::robot::{Lagrangian, TwoVelocity};
use forwardstep::io::urdf::shipped_robot;
use forwardstep::io::{SourceText, UrdfOptions, read_urdf};
use forwardstep::sim::delay::Delay;
use forwardstep::sim::{Adaptive, AgentSetup, Network, RobotSetup, Setup, Signal, run};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    // From memory, wherever the text comes from.
    let text = match std::env::args().nth(1) {
        Some(path) => std::fs::read_to_string(path)?,
        None => shipped_robot("ur5e").ok_or("a shipped robot")?.to_owned(),
    };
    let robot = read_urdf(&SourceText::new("robot.urdf", text), &UrdfOptions::default())?.robot;
    dynamics(&robot)?;

    let axes = robot.axes.len();
    let law = Adaptive {
        damping: Gain::Bandwidth(20.0),
        adaptation: Gain::Bandwidth(5.0),
        estimate_start: vec![0.0; robot.theta.len()],
        bounds: None,
    };
    let arm =
        |name: &str, q: f64| AgentSetup::new(name, robot.clone(), law.clone()).roots([1.0, 2.0]).at(&vec![q; axes]);
    let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::constant(0.3));
    let recording = run(&Setup::consensus([arm("left", -0.4), arm("right", 0.4)], network, 40.0))?.recording;
    for axis in 0..axes {
        let [left, right] = [0, 1].map(|agent| recording.last(agent, Signal::Position, axis));
        println!("{:<20} {left:8.4}  {right:8.4}", robot.axes[axis].name);
        assert!((left - right).abs() < 1e-2, "they agree");
    }
    Ok(())
}

/// M, C, g and the regressor Y of two velocities, and that Y ϑ = M ż + C z + g + D z.
fn dynamics(robot: &RobotSetup) -> Result<(), Box<dyn Error>> {
    let tree: &Tree = robot.kind.downcast::<Arc<Tree>>().ok_or("a URDF is a tree of links")?;
    let (n, theta) = (tree.joint_count(), &robot.theta[..]);
    let vector = |first: f64| (0..n).map(|k| first + 0.1 * k as f64).collect::<Vec<_>>();
    let (q, dq, z, dz) = (vector(0.3), vector(-0.2), vector(0.5), vector(0.1));
    let mut scratch = tree.scratch::<f64>();
    let (mut mass, mut coriolis, mut gravity) = (vec![0.0; n * n], vec![0.0; n * n], vec![0.0; n]);
    tree.mass_matrix(&mut scratch, &q, theta, &mut mass)?;
    tree.coriolis_matrix(&mut scratch, &q, &dq, theta, &mut coriolis)?;
    tree.gravity(&mut scratch, &q, theta, &mut gravity)?;
    let mut y = vec![0.0; n * theta.len()];
    tree.regressor(&mut scratch, TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz }, &mut y)?;
    let (mut damping, still) = (vec![0.0; n], vec![0.0; n]);
    tree.add_damping(&mut scratch, TwoVelocity { q: &q, dq: &z, z: &still, dz: &still }, theta, &mut damping)?;

    let dot = |row: &[f64], x: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
    for k in 0..n {
        let row = k * n..(k + 1) * n;
        let torque = dot(&mass[row.clone()], &dz) + dot(&coriolis[row], &z) + gravity[k] + damping[k];
        let by_regressor = dot(&y[k * theta.len()..(k + 1) * theta.len()], theta);
        println!(
            "{:<20} M {:8.4}  g {:8.3}  Y theta {by_regressor:8.3}",
            robot.axes[k].name,
            mass[k * n + k],
            gravity[k]
        );
        assert!((torque - by_regressor).abs() < 1e-9 * (1.0 + torque.abs()), "they are the same torque");
    }
    Ok(())
}
