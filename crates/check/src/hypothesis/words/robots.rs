//! Robots before they run.

use super::names;
use super::numbers::{Shown, above, as_it_is, bound_below, rounded, rounded_down, rounded_up};
use crate::hypothesis::{InertiaUnit, MotionExtent, Named, ReachSide, RobotEvidence};
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
            "at q = {} the joints of {} move at the rates {} without positive kinetic energy: a link lacks mass or inertia, or has a negative one",
            list(q),
            agent.name,
            list(direction)
        ),
        RobotEvidence::UnknownInertia { agents, q, least } => format!(
            "links of {} lack positive mass or inertia of their own, and no bound was found by cutting the joints' full turns; M was seen \
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
        RobotEvidence::WithinReach { target, reach, exact } => {
            let from = if *exact { "the shoulder" } else { "the first joint" };
            let target = format!(
                "it keeps {} from {from}",
                between(rounded_down(target.least.max(0.0)), rounded_up(target.most))
            );
            if *exact {
                format!(
                    "{target}; the end-effector can be {}",
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
            let at = format!("at t = {} s", as_it_is(*t_s));
            match side {
                ReachSide::Beyond => format!(
                    "{at} it is {} m away, and the end-effector cannot be farther than {} m",
                    above(*distance_m, *limit_m),
                    limit(*limit_m)
                ),
                ReachSide::Inside if *limit_m <= 0.0 => {
                    format!("{at} it is where the arm folds up entirely, and its Jacobian is singular")
                }
                ReachSide::Inside => format!(
                    "{at} it is {} m away, and the end-effector cannot be closer than {} m without a singular Jacobian",
                    bound_below(*distance_m, *limit_m),
                    limit(*limit_m)
                ),
            }
        }
        RobotEvidence::ReachNotShown { seen, reach } => {
            if let Some(edge) = edge(seen, reach) {
                return format!(
                    "it comes to {} m, up to rounding the edge of what the end-effector can reach, where its Jacobian is singular",
                    limit(edge)
                );
            }
            format!(
                "it was seen {} away, but neither is that shown to be so for all time, nor was it found to leave what the end-effector can \
                 reach, {}",
                between(above(seen.least, reach.least), bound_below(seen.most, reach.most)),
                between(rounded(reach.least.max(0.0)), rounded(reach.most))
            )
        }
    }
}

/// The edge of what can be reached that a target comes to, but for rounding.
pub(super) fn edge(seen: &MotionExtent, reach: &MotionExtent) -> Option<f64> {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * reach.most;
    near(seen.most, reach.most).then_some(reach.most).or_else(|| {
        // Of a tree no inner edge may be known.
        (reach.least > 0.0 && near(seen.least, reach.least)).then_some(reach.least)
    })
}

/// Lengths add up to decimals that binary numbers miss.
fn limit(value: f64) -> Shown {
    as_it_is((value * 1e6).round() / 1e6)
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
