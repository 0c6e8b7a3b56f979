//! A commented scenario to start from.

mod network;
mod robot;

use forwardstep_sim::Exchange;

use crate::one_line;

pub use self::network::{TemplateDelay, TemplateGraph};
pub use self::robot::{LawTemplate, RobotTemplate, TaskTemplate, Tuning};

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
    /// How long it takes, s.
    pub end_s: f64,
    /// How many agents there are; at least two where they are to agree.
    pub agents: u32,
    /// The robot of each.
    pub robot: RobotTemplate,
    /// How fast their adaptive law is.
    pub tuning: Tuning,
    /// The order of the reference dynamics, at least one; not read where there is a leader, or a target for everybody.
    pub order: u32,
    /// What agents tell each other; not read where there is a leader.
    pub exchange: Exchange,
    /// Whether all follow a leader, whom the first hears; over a graph that switches the first and the last in turn.
    pub leader: bool,
    /// Who hears whom.
    pub graph: TemplateGraph,
    /// How late, and by which means.
    pub delay: TemplateDelay,
    /// What the goal asks for; `None` for a comment in its place.
    pub goal: Option<f64>,
    /// What its reader should know first, in comments at its head.
    pub remarks: Vec<String>,
}

impl Template {
    /// Four agents with this robot, or one that has a target of its own, and defaults beside it.
    pub fn new(robot: RobotTemplate) -> Self {
        let (order, exchange, agents) = match robot.task {
            TaskTemplate::Agree { orders: [lowest, _], exchange, .. } => (lowest.max(2), exchange, 4),
            TaskTemplate::Track { .. } => (2, None, 1),
        };
        Template {
            title: "A scenario to start from".into(),
            end_s: 60.0,
            agents,
            robot,
            tuning: Tuning::USUAL,
            order,
            exchange: exchange.unwrap_or(Exchange::PositionVelocity),
            leader: false,
            graph: TemplateGraph::Ring,
            delay: TemplateDelay::Constant,
            goal: None,
            remarks: Vec::new(),
        }
    }

    /// The text of the scenario.
    pub fn text(&self) -> String {
        let mut parts = vec![self.head(), self.title_and_time()];
        let law = self.robot.law(self.tuning);
        match self.robot.task {
            TaskTemplate::Track { agent, reference } => {
                parts.extend([self.agents() + agent, reference.to_owned(), law]);
            }
            TaskTemplate::Agree { .. } if self.leader => {
                let [leader, reference] = self.robot.leader(self.graph == TemplateGraph::Switching);
                parts.extend([leader, self.agents(), reference, law, self.network()]);
            }
            TaskTemplate::Agree { .. } => parts.extend([self.agents(), self.reference(), law, self.network()]),
        }
        parts.push(self.goal());
        parts.join("\n")
    }

    fn head(&self) -> String {
        let mut head = HEAD.to_owned();
        for remark in &self.remarks {
            head += "#\n";
            // What is repeated of a robot must not end the comment.
            let remark = one_line(remark);
            let mut line = "#".to_owned();
            for word in remark.split(' ') {
                if line.len() + word.len() > WIDEST_REMARK && line.len() > 1 {
                    head += &(line + "\n");
                    line = "#".to_owned();
                }
                line = line + " " + word;
            }
            head += &(line + "\n");
        }
        head
    }

    fn title_and_time(&self) -> String {
        let title = quoted(&self.title);
        let end = commented(&format!("end_s = {}", self.end_s), "how long to simulate, in s");
        // About a thousand rows.
        let apart_s = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0].into_iter().find(|apart_s| self.end_s / apart_s <= 1500.0);
        let rows = format!("record_every_s = {}", apart_s.unwrap_or(5.0));
        let every = commented(&rows, "rows of the tables are this far apart");
        format!("format = 2\ntitle = {title}\n\n[time]\n{end}{every}")
    }

    fn agents(&self) -> String {
        let (RobotTemplate { name, line, says, .. }, count) = (&self.robot, self.agents);
        let count = commented(
            &format!("count = {count}"),
            &if count == 1 { format!("{name}-1") } else { format!("{name}-1 … {name}-{count}") },
        );
        let (robot, start) = (commented(line, says), self.robot.start());
        format!(
            "# Robots of one kind; write [[agents]] again for others, which need as many axes.\n\
             [[agents]]\nname = \"{name}\"\n{count}{robot}{start}"
        )
    }

    fn reference(&self) -> String {
        let roots: Vec<String> = (1..=self.order).map(|root| format!("{root}.0")).collect();
        let roots = commented(&format!("roots_per_s = [{}]", roots.join(", ")), "as many as the order, all positive");
        let has_choice = matches!(self.robot.task, TaskTemplate::Agree { exchange: None, .. });
        let (word, other) = match self.exchange.has_velocities() {
            true => ("position_velocity", "or \"position\""),
            false if has_choice => ("position", "or \"position_velocity\""),
            false => ("position", "all that this law needs of others"),
        };
        let exchange = commented(&format!("exchange = \"{word}\""), other);
        format!(
            "# Where each agent wants to go: a reference velocity of its own, driven by what it hears.\n\
             [reference.consensus]\n{roots}{exchange}"
        )
    }

    fn network(&self) -> String {
        network::text(self.robot.name, self.agents, self.graph, self.delay, self.leader)
    }

    fn goal(&self) -> String {
        let agrees = matches!(self.robot.task, TaskTemplate::Agree { .. }) && !self.leader;
        let (key, says) = match agrees {
            true => ("disagreement_below", "max |q_i - q_j| over all axes at the end"),
            false => ("error_below", "max |error| over all axes at the end"),
        };
        let head = "# What you expect; missing it makes the exit status 1.\n";
        match self.goal {
            Some(bound) => format!("{head}[goal]\n{}", commented(&format!("{key} = {bound:e}"), says)),
            None => format!("{head}# [goal]\n{}", commented(&format!("# {key} = 1e-3"), says)),
        }
    }
}

/// Lines of remarks are about as long, in bytes.
const WIDEST_REMARK: usize = 100;

const HEAD: &str = "\
# A scenario to start from. With its path in place of FILE,
#
#     forwardstep check FILE      says what is promised
#     forwardstep run FILE        simulates it
#     forwardstep schema          prints all that may stand here, for editors
";

/// A line with its comment in the column that the shipped scenarios use.
fn commented(line: &str, comment: &str) -> String {
    let (line, below) =
        line.split_once('\n').map_or((line, String::new()), |(line, below)| (line, format!("{below}\n")));
    format!("{line:51} # {comment}\n{below}")
}

/// A text as TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
