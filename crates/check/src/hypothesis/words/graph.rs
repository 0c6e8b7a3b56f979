//! Graphs and their schedule.

use forwardstep_sim::leader::FollowingDesign;

use super::names;
use super::numbers::{as_it_is, seconds};
use crate::hypothesis::{GraphEvidence, Named};

/// Closed groups that are named.
const GROUPS: usize = 3;

pub(super) fn words(evidence: &GraphEvidence) -> String {
    match evidence {
        GraphEvidence::Window { length_s, roots, .. } if *length_s == 0.0 => {
            format!("one graph stays for ever and has a tree rooted at {}", names(roots))
        }
        GraphEvidence::Window { length_s, worst_start_s, roots, for_all_time, drawn } => {
            let window = format!(
                "the smallest uniform window lasts {} s (needed from t = {} s, rooted at {})",
                seconds(*length_s),
                seconds(*worst_start_s),
                names(roots)
            );
            match (for_all_time, drawn) {
                (true, _) => window,
                (false, true) => format!(
                    "up to the end of the run {window}; later draws bring a tree again and again, but almost surely no window \
                     is long enough for ever, since a graph without a tree can be drawn any number of times in a row"
                ),
                (false, false) => format!("up to the end of the run {window}"),
            }
        }
        GraphEvidence::Once { wait_s, start_s, end_s } => format!(
            "from t = {} s on no agent reaches all others for {} s, half of the run or more, which ends at {} s: nothing is seen to come back",
            seconds(*start_s),
            seconds(*wait_s),
            seconds(*end_s)
        ),
        GraphEvidence::EveryGraph { graphs } => {
            format!(
                "each of the {graphs} graphs that can be drawn has a tree by itself, whatever is drawn for how long"
            )
        }
        GraphEvidence::Cut { start_s, until_s, closed_groups } => cut(*start_s, *until_s, closed_groups),
        GraphEvidence::Reached { length_s, .. } if *length_s == 0.0 => "along the edges of the graph".into(),
        GraphEvidence::Reached { length_s, .. } => {
            format!("within every {} s along the edges of the graphs in force", seconds(*length_s))
        }
        GraphEvidence::Unreached { start_s, until_s, closed_group } => {
            let until =
                until_s.map_or("on".to_owned(), |until_s| format!("to the end of the run at {} s", seconds(until_s)));
            format!("from t = {} s {until} nothing of the leader reaches [{}]", seconds(*start_s), names(closed_group))
        }
        GraphEvidence::InEveryGraph { graphs, for_all_time } => {
            let until = if *for_all_time { "" } else { ", up to the end of the run" };
            match graphs {
                1 => format!("along the edges of the graph that stays{until}"),
                _ => format!(
                    "along the edges of each of the {graphs} graphs by itself, in whatever order they come{until}"
                ),
            }
        }
        GraphEvidence::Unheard { phase, closed_group, .. } => format!(
            "in phase {phase} nothing of the leader reaches [{}], who hear no agent outside themselves: the leader moves away from \
             them meanwhile, and with the sign they draw others with them, so that an error stays",
            names(closed_group)
        ),
        GraphEvidence::NeverSwitches => "the graph never switches".into(),
        GraphEvidence::ShortestPhase { dwell_s } => format!("the shortest phase lasts {} s", as_it_is(*dwell_s)),
        GraphEvidence::LoggedPhases { dwell_s: Some(dwell_s) } => {
            format!("the shortest phase of the table lasts {} s", as_it_is(*dwell_s))
        }
        GraphEvidence::LoggedPhases { dwell_s: None } => "the table has one phase".into(),
        GraphEvidence::DrawnPhases { least_s } => format!("no phase is shorter than {} s", as_it_is(*least_s)),
        GraphEvidence::DeclaredPhases { least_s } => {
            format!("no phase is shorter than {} s (declared, not shown)", as_it_is(*least_s))
        }
        GraphEvidence::RefutedSwitching { words, fault } => {
            format!("{words} is not what its author declares: {fault}")
        }
        GraphEvidence::Stays => "one graph stays for ever".into(),
        GraphEvidence::VaryingWeight => {
            "a weight changes with time: the torque that follows from it is not the one proved".into()
        }
        GraphEvidence::Switches { graphs, exchange } => {
            let instead = match exchange.has_velocities() {
                true => "(a1), which is `reference.consensus` of order two",
                false => "(24), which is `reference.consensus`",
            };
            format!(
                "{graphs} graphs take turns: the reference acceleration, and the torque with it, jumps at every switch; \
                 {instead}, is made for that"
            )
        }
        GraphEvidence::SwitchesUnderLeader { design } => switches_under_leader(*design).into(),
        GraphEvidence::Mutual => "every edge among them leads both ways".into(),
        GraphEvidence::OneWay { edges } => {
            let first = edges.first().map_or(String::new(), |[from, to]| format!("{} hears {}", to.name, from.name));
            let more = match edges.len().saturating_sub(1) {
                0 => String::new(),
                1 => ", and so for one more edge".into(),
                more => format!(", and so for {more} more edges"),
            };
            format!("{first}, but not the other way round with the same weight{more}")
        }
    }
}

/// Why a fixed graph is asked for: see the head of `reference/following.rs` in the core.
fn switches_under_leader(design: FollowingDesign) -> &'static str {
    match design {
        FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. } => {
            "the graph switches, and messages are late: what an agent said before a switch may come back to it after the next, \
             so that an error can go round for ever"
        }
        FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. } => {
            "the graph switches: the integral that the design is realised by keeps what former neighbours left in it, and the \
             error can grow"
        }
    }
}

/// What random switching has not shown by the end of the run it may show later.
fn cut(start_s: f64, until_s: Option<f64>, closed_groups: &[Vec<Named>]) -> String {
    let groups: Vec<String> = closed_groups.iter().take(GROUPS).map(|group| format!("[{}]", names(group))).collect();
    let more = match closed_groups.len().saturating_sub(GROUPS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let span = match until_s {
        Some(until_s) => format!("from t = {} s to the end of the run at {} s", seconds(start_s), seconds(until_s)),
        None => format!("from t = {} s on, whatever the window", seconds(start_s)),
    };
    let groups = groups.join(" and ");
    let later = until_s.map_or("", |_| "; what comes later is not known, and may bring the edges that are missing");
    format!("{span}, no agent reaches all others: {groups}{more} hear no agent outside themselves{later}")
}
