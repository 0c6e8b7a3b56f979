//! A commented scenario to start from.

use std::fmt::Write;

use forwardstep_sim::Exchange;

/// What a scenario to start from should hold. Every combination is a valid scenario, as long as the robot file is there and the
/// law of the robot knows the reference.
///
/// ```
/// use forwardstep_io::SourceText;
/// use forwardstep_io::scenario::kinds::Kinds;
/// use forwardstep_io::scenario::{Template, read_scenario};
///
/// let arm = Kinds::shipped().template("planar_arm").ok_or("no such robot")?;
/// let text = Template { agents: 3, ..Template::new(arm) }.text();
/// let scenario = read_scenario("mine", &SourceText::new("mine.toml", text), None)?;
/// assert_eq!(scenario.setup.agents.len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// What the scenario shows, in one line.
    pub title: String,
    /// How many agents there are, at least two.
    pub agents: u32,
    /// The robot of each.
    pub robot: RobotTemplate,
    /// The order of the reference dynamics, at least one.
    pub order: u32,
    /// What agents tell each other.
    pub exchange: Exchange,
    /// Who hears whom.
    pub graph: TemplateGraph,
    /// How late.
    pub delay: TemplateDelay,
}

/// What a scenario to start from says of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotTemplate {
    /// What its agents are called.
    pub name: &'static str,
    /// The line that says it: `robot.key = { … }`.
    pub line: String,
    /// The comment beside it.
    pub says: &'static str,
    /// The lines of its law, with comments.
    pub law: String,
    /// The keys that give it dry friction, if it can have some.
    pub dry_friction: Option<&'static str>,
}

impl RobotTemplate {
    /// The lines of the adaptive law with these lines for K and Γ.
    pub fn adaptive(damping: &str, gain: &str) -> String {
        let damping = commented(damping, "K of torque = -K s + Y theta_hat");
        let gain = commented(gain, "how fast estimates change");
        let start = nothing_known();
        format!(
            "# How the robot is made to follow; with [law.known] and damping alone its parameters are known.\n\
             [law.adaptive]\n{damping}{gain}{start}"
        )
    }

    /// A robot from a URDF beside the scenario, or a shipped one; whether it has Coulomb friction, which is then left out.
    pub fn urdf(file: &str, has_friction: bool) -> Self {
        let friction = if has_friction { ", friction = \"ignore\"" } else { "" };
        RobotTemplate {
            name: "arm",
            line: format!("robot.urdf = {{ file = {}{friction} }}", quoted(file)),
            says: "beside this file, or shipped: ur5e.urdf, panda.urdf",
            law: RobotTemplate::adaptive("damping.bandwidth_per_s = 20", "adaptation_gain = { bandwidth_per_s = 5 }"),
            dry_friction: Some(if has_friction { "friction.dry = {}" } else { "friction.dry = { coulomb = 0.5 }" }),
        }
    }

    /// The same robot with dry friction, as its file states it or 0.5 N m, and estimates kept near what is known, without which they drift;
    /// `None` for one that has no joints to rub.
    pub fn rubbing(mut self) -> Option<Self> {
        let friction = self.dry_friction?;
        let line = self.line.strip_suffix(" }")?;
        let line = line.strip_suffix(", friction = \"ignore\"").unwrap_or(line);
        self.line = format!("{line}, {friction} }}");
        let known = commented("estimate_start = { scaled = 0.8 }", "of what is true");
        let bounds = commented("bounds.within = 0.3", "estimates stay within 30 %, a friction within 0 and 2 F");
        self.law = self.law.replace(&nothing_known(), &(known + &bounds));
        Some(self)
    }
}

/// The graphs of a [`Template`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateGraph {
    /// One way round.
    Ring,
    /// Both ways between neighbours in a row.
    Path,
    /// Everybody hears everybody.
    Complete,
}

/// The delays of a [`Template`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplateDelay {
    /// Always the same.
    Constant,
    /// Growing, then dropping.
    SawTooth,
    /// None.
    None,
}

impl Template {
    /// Four agents with this robot, and what is usual beside it.
    pub fn new(robot: RobotTemplate) -> Self {
        Template {
            title: "A scenario to start from".into(),
            agents: 4,
            robot,
            order: 2,
            exchange: Exchange::PositionVelocity,
            graph: TemplateGraph::Ring,
            delay: TemplateDelay::Constant,
        }
    }

    /// The text of the scenario.
    pub fn text(&self) -> String {
        let mut text = String::from(HEAD);
        let parts = [
            self.title_and_time(),
            self.agents(),
            self.reference(),
            self.robot.law.clone(),
            self.network(),
            GOAL.to_owned(),
        ];
        for part in parts {
            text.push('\n');
            text.push_str(&part);
        }
        text
    }

    fn title_and_time(&self) -> String {
        let title = quoted(&self.title);
        let end = commented("end_s = 60", "how long to simulate, in s");
        let every = commented("record_every_s = 0.05", "rows of the tables are this far apart");
        format!("format = 2\ntitle = {title}\n\n[time]\n{end}{every}")
    }

    fn agents(&self) -> String {
        let (RobotTemplate { name, line, says, .. }, count) = (&self.robot, self.agents);
        let count = commented(&format!("count = {count}"), &format!("{name}-1 … {name}-{count}"));
        let robot = commented(line, says);
        format!(
            "# Robots of one kind; write [[agents]] again for others, which need as many axes.\n\
             [[agents]]\nname = \"{name}\"\n{count}{robot}\
             # The same seed gives the same start, always; in rad or m.\n\
             start.position = {{ random = {{ seed = 1, within = [-1.0, 1.0] }} }}\n"
        )
    }

    fn reference(&self) -> String {
        let roots: Vec<String> = (1..=self.order).map(|root| format!("{root}.0")).collect();
        let roots = commented(&format!("roots_per_s = [{}]", roots.join(", ")), "as many as the order, all positive");
        let exchange = match self.exchange {
            Exchange::PositionVelocity => commented("exchange = \"position_velocity\"", "or \"position\""),
            Exchange::Position => commented("exchange = \"position\"", "or \"position_velocity\""),
        };
        format!(
            "# Where each agent wants to go: a reference velocity of its own, driven by what it hears.\n\
             [reference.consensus]\n{roots}{exchange}"
        )
    }

    fn network(&self) -> String {
        let weight = commented("weight = 1.0", "of every edge that has none of its own");
        let delay = match self.delay {
            TemplateDelay::Constant => commented("delay.constant_s = 0.2", "what is heard is this old, in s"),
            TemplateDelay::SawTooth => {
                let line = "delay.saw_tooth = { min_s = 0.05, max_s = 0.4, period_s = 0.6 }";
                format!("# What is heard grows older until the next message arrives.\n{line}\n")
            }
            TemplateDelay::None => commented("# delay.constant_s = 0.2", "messages arrive at once"),
        };
        let mut edges = commented("edges = [", "[who is heard, who hears]");
        for (from, to) in self.edges() {
            let name = self.robot.name;
            // Writing to a string does not fail.
            let _ = writeln!(edges, "    [\"{name}-{from}\", \"{name}-{to}\"],");
        }
        format!(
            "# Who hears whom, and how late; [[network.phases]] in place of edges make it switch.\n[network]\n{weight}{delay}{edges}]\n"
        )
    }

    /// Pairs of who is heard and who hears, counted from one.
    fn edges(&self) -> Vec<(u32, u32)> {
        let all = 1..=self.agents;
        match self.graph {
            TemplateGraph::Ring => all.map(|k| (k, k % self.agents + 1)).filter(|(from, to)| from != to).collect(),
            TemplateGraph::Path => (1..self.agents).flat_map(|k| [(k, k + 1), (k + 1, k)]).collect(),
            TemplateGraph::Complete => {
                let hears = |to| (1..=self.agents).map(move |from| (from, to)).filter(|(from, to)| from != to);
                all.flat_map(hears).collect()
            }
        }
    }
}

const HEAD: &str = "\
# A scenario to start from. With its path in place of FILE,
#
#     forwardstep check FILE      says what is promised
#     forwardstep run FILE        simulates it
#     forwardstep schema          prints all that may stand here, for editors
";

const GOAL: &str = "\
# What you expect; missing it makes the exit status 1.
# [goal]
# disagreement_below = 1e-3                         # max |q_i - q_j| over all axes at the end
";

/// How the estimate starts, as long as nothing says otherwise.
fn nothing_known() -> String {
    commented("estimate_start = \"zero\"", "nothing is known; or \"true\", { scaled = 0.5 }")
}

/// A line with its comment in the column that the shipped scenarios use.
fn commented(line: &str, comment: &str) -> String {
    format!("{line:51} # {comment}\n")
}

/// A text as TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
