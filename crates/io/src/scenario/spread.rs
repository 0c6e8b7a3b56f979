//! `spread` of a population → agents whose robots differ.

use std::sync::Arc;

use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{PlanarLinks, PlanarTip};
use forwardstep_sim::{RobotSetup, SpacecraftModel};

use super::fault::{Fault, between, fault, seed};
use super::file::{AgentFile, PlanarArmFile, RobotFile};
use super::problem::ScenarioProblem;
use super::random::{Stream, draws};
use super::robots::{planar_links, planar_robot};

/// The largest spread: nothing may weigh next to nothing.
const MOST_RELATIVE: f64 = 0.9;
/// Positions at which the mass matrix of a tree is looked at.
const SAMPLES: usize = 16;

/// The robot of the agent `index` of a population whose file says `read`.
pub(super) fn spread(entry: &AgentFile, read: &RobotSetup, index: usize, agent: &str) -> Result<RobotSetup, Fault> {
    let Some(place) = &entry.spread else { return Ok(read.clone()) };
    let factors = |length| factors(entry, index, length);
    let unsound = || fault(place, ScenarioProblem::SpreadMassMatrix { agent: agent.to_owned() });
    match &entry.robot.value {
        RobotFile::PlanarArm(file) => planar_robot(&spread_links(file, &factors(4)?)?).map_err(|_| unsound()),
        RobotFile::Chain(_) | RobotFile::StrictFeedback(_) | RobotFile::PureFeedback(_) => {
            let mut robot = read.clone();
            let length = robot.theta.len();
            robot.theta.iter_mut().zip(factors(length)?).for_each(|(theta, factor)| *theta *= factor);
            Ok(robot)
        }
        RobotFile::PointMass(_) | RobotFile::Vehicle(_) | RobotFile::Rotorcraft(_) => {
            let mut robot = read.clone();
            robot.theta.iter_mut().zip(factors(1)?).for_each(|(mass, factor)| *mass *= factor);
            Ok(robot)
        }
        RobotFile::Spacecraft(_) => {
            let mut robot = read.clone();
            let [factor] = factors(1)?[..] else { return Ok(robot) };
            if let Some(SpacecraftModel { inertia_kg_m2, wheels }) = read.kind.downcast() {
                let inertia_kg_m2 = inertia_kg_m2.map(|row| row.map(|entry| factor * entry));
                robot.kind = Arc::new(SpacecraftModel { inertia_kg_m2, wheels: wheels.clone() });
            }
            Ok(robot)
        }
        RobotFile::Urdf(_) => {
            let mut robot = read.clone();
            let Some(tree) = read.kind.downcast::<Arc<Tree>>() else { return Ok(robot) };
            // Ten parameters per body come first; they scale together, and dampings stay.
            let bodies = robot.theta.chunks_exact_mut(10).zip(factors(read.axes.len())?);
            bodies.for_each(|(body, factor)| body.iter_mut().for_each(|entry| *entry *= factor));
            let range: Vec<[f64; 2]> = read
                .axes
                .iter()
                .map(|axis| axis.position_limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]))
                .collect();
            tree.check_mass_matrix(&robot.theta, &range, SAMPLES).map_err(|_| unsound())?;
            Ok(robot)
        }
    }
}

/// The factors of the agent `index` of a population; ones without a spread.
fn factors(entry: &AgentFile, index: usize, length: usize) -> Result<Vec<f64>, Fault> {
    let Some(place) = &entry.spread else { return Ok(vec![1.0; length]) };
    if entry.count.is_none() {
        return Err(fault(place, ScenarioProblem::SpreadOfOne));
    }
    let relative = between("relative", &place.value.relative, 0.0, MOST_RELATIVE)?;
    let seed = seed(&place.value.seed)?;
    let units = draws(seed, Stream::Spread, index, length);
    Ok(units.map(|unit| 1.0 + relative * (2.0 * unit - 1.0)).collect())
}

fn spread_links(file: &PlanarArmFile, factors: &[f64]) -> Result<PlanarLinks, Fault> {
    let mut links = planar_links(file)?;
    for (k, (mass, length)) in factors[..2].iter().zip(&factors[2..]).enumerate() {
        links.mass_kg[k] *= mass;
        links.length_m[k] *= length;
        links.com_m[k] *= length;
        links.inertia_kg_m2[k] *= mass * length * length;
    }
    Ok(links)
}

/// The tip of the agent `index` of a population, if its robot is a planar arm.
pub(super) fn tip(entry: &AgentFile, index: usize) -> Result<Option<PlanarTip>, Fault> {
    let RobotFile::PlanarArm(file) = &entry.robot.value else { return Ok(None) };
    let links = spread_links(file, &factors(entry, index, 4)?)?;
    Ok(Some(PlanarTip { length_m: links.length_m }))
}
