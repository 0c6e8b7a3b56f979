//! Robots before they run.

use super::names;
use super::numbers::{Shown, rounded, rounded_down, rounded_up};
use crate::hypothesis::{InertiaUnit, Named, ReachSide, RobotEvidence};
use crate::practical::FastestDamping;

/// Joint positions that are written out.
const MOST_JOINTS: usize = 12;

pub(super) fn words(evidence: &RobotEvidence) -> String {
    match evidence {
        RobotEvidence::UniformInertia { least, unit, agent, agents, damping } => {
            let whose = match agents {
                1 => agent.name.clone(),
                agents => format!("{}, the smallest of {agents}", agent.name),
            };
            let fast = damping.as_ref().map_or_else(String::new, |(agent, found)| fastest(agent, found));
            let least = rounded_down(*least);
            match unit {
                InertiaUnit::Turning => {
                    format!("no eigenvalue of M(q) is below {least} kg m² at any q ({whose}){fast}")
                }
                InertiaUnit::Sliding => format!("no eigenvalue of M(q) is below {least} kg at any q ({whose}){fast}"),
                InertiaUnit::Mixed => format!(
                    "no eigenvalue of M(q), in kg and kg m² with metres and radians counted alike, is below {least} at any q \
                     ({whose}){fast}"
                ),
            }
        }
        RobotEvidence::SingularInertia { agent, q, direction } => format!(
            "at q = {} the joints of {} move at the rates {} without kinetic energy: a link lacks mass or inertia",
            list(q),
            agent.name,
            list(direction)
        ),
        RobotEvidence::UnknownInertia { agents, q, least } => format!(
            "links of {} lack mass or inertia of their own, and no bound was found by cutting the joints' full turns; M was seen \
             closest to singular at q = {}, where its smallest eigenvalue is about {}",
            names(agents),
            list(q),
            rounded(*least)
        ),
        RobotEvidence::BoundedDynamics { sliding: false } => {
            "q enters them by sines and cosines of angles at most".into()
        }
        RobotEvidence::BoundedDynamics { sliding: true } => {
            "prismatic joints are parallel to the revolute joints that carry them, so that no extension changes a lever"
                .into()
        }
        RobotEvidence::Swung { agents, joint, limits } => swung(agents, joint, *limits),
        RobotEvidence::WithinReach { target, reach, exact, for_ever } => {
            let until = if *for_ever { "" } else { " until the end of the run" };
            let from = if *exact { "the shoulder" } else { "the first joint" };
            let target = format!(
                "it keeps {} from {from}{until}",
                between(rounded_down(target.least.max(0.0)), rounded_up(target.most))
            );
            if *exact {
                format!(
                    "{target}; the tip can be {}",
                    between(rounded_up(reach.least.max(0.0)), rounded_down(reach.most))
                )
            } else {
                let folded = match reach.least > 0.0 {
                    true => format!(", and comes no nearer than {} m", rounded_up(reach.least)),
                    false => String::new(),
                };
                format!(
                    "{target}, and the arm is {} m long when stretched{folded}; whether it can be turned there is not asked",
                    rounded(reach.most)
                )
            }
        }
        RobotEvidence::OutOfReach { side, t_s, distance_m, limit_m } => {
            let (distance, limit) = (rounded(*distance_m), rounded(*limit_m));
            let can = match side {
                ReachSide::Beyond => format!("and the tip cannot be farther than {limit} m"),
                ReachSide::Inside => format!("and the tip cannot be closer than {limit} m without a singular Jacobian"),
            };
            format!("at t = {} s it is {distance} m away, {can}", rounded(*t_s))
        }
        RobotEvidence::ReachNotShown { seen, reach } => format!(
            "it was seen {} away, but what it does between two looks is not bounded well enough; the tip can be {}",
            between(rounded(seen.least.max(0.0)), rounded(seen.most)),
            between(rounded(reach.least.max(0.0)), rounded(reach.most))
        ),
    }
}

fn between(least: Shown, most: Shown) -> String {
    format!("{least} m to {most} m")
}

fn fastest(agent: &Named, found: &FastestDamping) -> String {
    let start = rounded(found.at_start_per_s);
    let anywhere = match found.anywhere_per_s {
        Some(anywhere) => format!("no faster than at {} per second at any q", rounded_up(anywhere)),
        None => "with no bound for all q".into(),
    };
    format!("; K makes s decay at up to {start} per second at the start ({}), {anywhere}", agent.name)
}

fn swung(agents: &[Named], joint: &str, limits: Option<[f64; 2]>) -> String {
    let which = format!("a revolute joint swings `{joint}` ({}), whose extension is a lever", names(agents));
    match limits {
        Some([low, high]) => format!("{which}; a run ends where it leaves {low} m to {high} m"),
        None => format!(
            "{which}; as long as that stays bounded they are, but no theorem says so: its limits are not enforced"
        ),
    }
}

fn list(values: &[f64]) -> String {
    let numbers: Vec<String> = values.iter().take(MOST_JOINTS).map(|value| rounded(*value).to_string()).collect();
    let more = if values.len() > MOST_JOINTS { ", …" } else { "" };
    format!("({}{more})", numbers.join(", "))
}
