//! What a scenario to start from says of a robot.

use std::fmt::Write;

use forwardstep_sim::{Exchange, RobotSetup};

use super::{commented, quoted};

/// An axis starts at most so far from the middle of its starts, rad or m.
const WIDEST_START: f64 = 1.0;
/// What starts keep of the range of an axis with limits.
const SHARE_OF_RANGE: f64 = 0.7;

/// What a scenario to start from says of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotTemplate {
    /// What its agents are called.
    pub name: &'static str,
    /// The line that says it, `robot.key = { … }`, or several.
    pub line: String,
    /// The comment beside it.
    pub says: &'static str,
    /// Where its axes start: the lowest and the highest position, axis by axis.
    pub starts: Vec<[f64; 2]>,
    /// Its law.
    pub law: LawTemplate,
    /// The keys that give it dry friction, if it can have some.
    pub dry_friction: Option<&'static str>,
    /// What it is made to do.
    pub task: TaskTemplate,
}

/// The law of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LawTemplate {
    /// (6) and (7), whose gains are bandwidths times what is natural for the robot.
    Adaptive,
    /// Another, by its lines.
    Lines(&'static str),
}

/// What a robot is made to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskTemplate {
    /// To agree with others.
    Agree {
        /// The lowest and the highest order of reference dynamics that its law accepts.
        orders: [u32; 2],
        /// What its law lets agents tell each other; `None` where they may choose.
        exchange: Option<Exchange>,
        /// Whether its law follows the references of leaders.
        follows: bool,
    },
    /// To follow a target by itself, as these lines of the agent and of the reference say.
    Track {
        /// Lines of `[[agents]]`.
        agent: &'static str,
        /// Lines of the reference.
        reference: &'static str,
    },
}

/// How fast an adaptive law is, and what it knows at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// The bandwidth of K, 1/s.
    pub damping_per_s: f64,
    /// The bandwidth of Γ, 1/s.
    pub adaptation_per_s: f64,
    /// The first estimate as a multiple of what is true; nothing is known at 0.
    pub known: f64,
}

impl Tuning {
    /// What suits most robots.
    pub const USUAL: Tuning = Tuning { damping_per_s: 20.0, adaptation_per_s: 5.0, known: 0.0 };
}

impl TaskTemplate {
    /// Of robots under (6) and (7): every order and exchange, and leaders.
    pub const LAGRANGIAN: TaskTemplate = TaskTemplate::Agree { orders: [1, u32::MAX], exchange: None, follows: true };

    /// Of laws that need the positions of others and reference dynamics from one of these orders to the other.
    pub const fn of_orders(lowest: u32, highest: u32) -> Self {
        TaskTemplate::Agree { orders: [lowest, highest], exchange: Some(Exchange::Position), follows: false }
    }
}

/// What is known of a robot that rubs, where nothing would be.
const KNOWN_OF_RUBBING: f64 = 0.8;

/// What is below the file of a robot whose friction is left out.
const IGNORED: &str = "\nrobot.urdf.friction = \"ignore\"";

impl RobotTemplate {
    /// A robot from a URDF beside the scenario, or a shipped one; whether it has Coulomb friction, which is then left out.
    pub fn urdf(file: &str, has_friction: bool, robot: &RobotSetup) -> Self {
        let friction = if has_friction { IGNORED } else { "" };
        RobotTemplate {
            name: "arm",
            // A key of its own for each, so that another one can stand below.
            line: format!("robot.urdf.file = {}{friction}", quoted(file)),
            says: "beside this file, or shipped: ur5e.urdf, panda.urdf",
            starts: robot.axes.iter().map(|axis| start_within(axis.position_limits)).collect(),
            law: LawTemplate::Adaptive,
            dry_friction: Some(if has_friction { "friction.dry = {}" } else { "friction.dry = { coulomb = 0.5 }" }),
            task: TaskTemplate::LAGRANGIAN,
        }
    }

    /// Whether its file states friction, which is left out.
    pub fn leaves_friction_out(&self) -> bool {
        self.line.ends_with(IGNORED)
    }

    /// The same robot with dry friction, as its file states it or 0.5 N m; `None` for one that has no joints to rub.
    pub fn rubbing(mut self) -> Option<Self> {
        let friction = self.dry_friction?;
        self.line = match self.line.strip_suffix(" }") {
            Some(table) => format!("{table}, {friction} }}"),
            None => format!("{}\nrobot.urdf.{friction}", self.line.trim_end_matches(IGNORED)),
        };
        self.dry_friction = None;
        Some(self)
    }

    /// What is known of it at the start where `share` of everything should be: without bounds estimates drift where joints rub, and bounds
    /// are stated around what is known.
    pub fn known(&self, share: f64) -> f64 {
        if self.rubs() && share <= 0.0 { KNOWN_OF_RUBBING } else { share }
    }

    /// Whether it rubs.
    fn rubs(&self) -> bool {
        self.line.contains("friction.dry")
    }

    /// `start.position`, the same for all axes where that is so.
    pub(super) fn start(&self) -> String {
        let pair = |[low, high]: [f64; 2]| format!("[{low:?}, {high:?}]");
        let within = match self.starts.as_slice() {
            [] => return String::new(),
            [first, others @ ..] if others.iter().all(|other| other == first) => pair(*first),
            all => format!("[{}]", all.iter().map(|one| pair(*one)).collect::<Vec<_>>().join(", ")),
        };
        format!(
            "# The same seed gives the same start, always; in rad or m.\n\
             start.position = {{ random = {{ seed = 1, within = {within} }} }}\n"
        )
    }

    /// The lines of the law.
    pub(super) fn law(&self, tuning: Tuning) -> String {
        let Tuning { damping_per_s, adaptation_per_s, known } = tuning;
        if let LawTemplate::Lines(lines) = self.law {
            return lines.to_owned();
        }
        let mut text =
            "# How the robot is made to follow; with [law.known] and damping alone its parameters are known.\n\
                        [law.adaptive]\n"
                .to_owned();
        let damping = format!("damping.bandwidth_per_s = {damping_per_s}");
        let gain = format!("adaptation_gain = {{ bandwidth_per_s = {adaptation_per_s} }}");
        text += &commented(&damping, "K of torque = -K s + Y theta_hat");
        text += &commented(&gain, "how fast estimates change");
        let known = self.known(known);
        text += &match known {
            0.0 => commented("estimate_start = \"zero\"", "nothing is known; or \"true\", { scaled = 0.5 }"),
            1.0 => commented("estimate_start = \"true\"", "all is known; or \"zero\", { scaled = 0.5 }"),
            share => commented(&format!("estimate_start = {{ scaled = {share} }}"), "of what is true"),
        };
        if self.rubs() {
            text += &commented("bounds.within = 0.3", "estimates stay within 30 %, a friction within 0 and 2 F");
        }
        text
    }

    /// A leader whose motion stays where the axes start, with the dynamics that follow it, over graphs that take turns if `turns`.
    pub(super) fn leader(&self, turns: bool) -> [String; 2] {
        let course = |[low, high]: &[f64; 2]| {
            let (middle, swing) = (0.5 * (low + high), 0.25 * (high - low));
            quoted(&format!("{} + {}*sin(0.2*t)", short(middle), short(swing)))
        };
        let formulas: Vec<String> = self.starts.iter().map(course).collect();
        let leader = format!(
            "# Where all are to go, axis by axis: formulas in t, or motion.points with times_s and positions.\n\
             [leader]\nmotion.formulas = [{}]\n",
            formulas.join(", ")
        );
        let mut reference = "# Everybody follows the leader, whom some of them hear.\n[reference.leader]\n".to_owned();
        reference += &if turns {
            commented("design = \"composite\"", "not from the paper; or \"continuous\", which is (110)")
        } else {
            commented("design = \"without_acceleration\"", "(122); or \"continuous\", which is (110), or \"composite\"")
        };
        reference += &commented("roots_per_s = [1.0, 1.0]", "two, both positive");
        reference += &commented("gain = 2.0", "gamma, above what the leader asks for: see `check`");
        [leader, reference]
    }
}

/// Where an axis starts: within 1 rad or m of zero, and well within its limits.
fn start_within(limits: Option<[f64; 2]>) -> [f64; 2] {
    // One that is limited on one side starts near that.
    let near = |[low, high]: [f64; 2]| match [low.is_finite(), high.is_finite()] {
        [true, false] => [low, low + 4.0 * WIDEST_START],
        [false, true] => [high - 4.0 * WIDEST_START, high],
        _ => [low, high],
    };
    let Some([low, high]) = limits.map(near).filter(|[low, high]| (high - low).is_finite() && high > low) else {
        return [-WIDEST_START, WIDEST_START];
    };
    let range = high - low;
    let half = (0.5 * SHARE_OF_RANGE * range).min(WIDEST_START);
    let margin = 0.5 * (1.0 - SHARE_OF_RANGE) * range + half;
    let middle = 0.0_f64.clamp(low + margin, (high - margin).max(low + margin));
    [middle - half, middle + half].map(|value| short(value).parse().unwrap_or(value))
}

/// A number with few digits.
fn short(value: f64) -> String {
    let mut text = String::new();
    // Writing to a string does not fail; adding zero leaves no sign at a zero.
    let _ = write!(text, "{}", (value * 1e4).round() / 1e4 + 0.0);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_starts_well_within_its_limits_and_near_zero_where_it_can() {
        let is = |limits, expected: [f64; 2]| {
            let found = start_within(limits);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{limits:?}: {found:?}");
        };
        is(None, [-1.0, 1.0]);
        is(Some([f64::NEG_INFINITY, f64::INFINITY]), [-1.0, 1.0]);
        is(Some([f64::NEG_INFINITY, 1.0]), [-1.6, 0.4]);
        is(Some([0.5, f64::INFINITY]), [1.1, 3.1]);
        is(Some([2.0, 2.0]), [-1.0, 1.0]);
        is(Some([-6.2, 6.2]), [-1.0, 1.0]);
        // The fourth and the sixth joint of a Panda, and a finger.
        is(Some([-3.0718, -0.0698]), [-2.5201, -0.5201]);
        is(Some([-0.0175, 3.7525]), [0.548, 2.548]);
        is(Some([0.0, 0.04]), [0.006, 0.034]);
        is(Some([-0.2, 0.2]), [-0.14, 0.14]);
    }
}
