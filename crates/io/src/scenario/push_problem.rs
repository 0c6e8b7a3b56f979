//! Why a push is refused.

use thiserror::Error;

use crate::wording::{about, choose, entry_count, number};

/// Why a push has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PushProblem {
    /// An agent that is pushed twice by one push.
    #[error("`{name}` is named twice in `on`")]
    OnTwice {
        /// The agent.
        name: String,
    },
    /// A key whose unit is not that of the robot's axes.
    #[error("`{key}` does not fit `{agent}`, whose axis `{axis}` is measured in {unit}")]
    Unit {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
        /// An axis with another unit.
        axis: String,
        /// Its unit.
        unit: &'static str,
        /// The key that fits any axis, and the units it takes.
        any: &'static str,
        /// The units it takes.
        takes: &'static str,
    },
    /// What does not act on such a robot.
    #[error("`{key}` does not act on `{agent}`")]
    DoesNotAct {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
        /// What does.
        does: &'static str,
    },
    /// A push on a robot that has nothing to be held by.
    #[error("`{agent}` has no links")]
    NoLinks {
        /// The agent.
        agent: String,
        /// What to use instead.
        instead: &'static str,
    },
    /// A URDF that is pushed nowhere.
    #[error("`{agent}` has {links} links, but the push does not say on which it acts")]
    WhichLink {
        /// The agent.
        agent: String,
        /// How many links it has.
        links: usize,
    },
    /// A link where there is none.
    #[error("`{agent}` is a planar arm, which is pushed at its end-effector")]
    TipOnly {
        /// The agent.
        agent: String,
        /// The key that does not belong there.
        key: &'static str,
    },
    /// A link that the robot has not.
    #[error("`{agent}` has no link `{link}`")]
    NoSuchLink {
        /// The link.
        link: String,
        /// The agent.
        agent: String,
        /// Its links.
        links: Vec<String>,
    },
    /// A link that nothing can move.
    #[error("the link `{link}` of `{agent}` is fixed to the base, so that pushing it does nothing")]
    FixedLink {
        /// The link.
        link: String,
        /// The agent.
        agent: String,
    },
    /// A wrench of nothing.
    #[error("the wrench has neither `force_n` nor `torque_n_m`")]
    NoWrench,
    /// An axis that the robot has not.
    #[error("`{agent}` has no axis `{axis}`")]
    NoSuchAxis {
        /// The axis.
        axis: String,
        /// The agent.
        agent: String,
        /// Its axes.
        axes: Vec<String>,
    },
    /// An axis that is held twice.
    #[error("the axis `{axis}` is named twice")]
    AxisTwice {
        /// The axis.
        axis: String,
    },
    /// Numbers that are not as many as the axes that are held.
    #[error("`{key}` has {}, but the virtual spring holds {need} of the axes of `{agent}`", entry_count(*.found))]
    Held {
        /// The key.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        need: usize,
        /// The agent.
        agent: String,
    },
    /// A hand that leads nowhere.
    #[error("the virtual spring has no target")]
    NoTarget,
    /// A formula that may be undefined.
    #[error(
        "this formula cannot be shown to have a value at all times from {} s to {} s",
        number(*.from_s), number(*.until_s)
    )]
    FormulaValue {
        /// When the push begins.
        from_s: f64,
        /// When it or the run ends.
        until_s: f64,
    },
    /// A table with nothing between its rows.
    #[error("a table over time needs at least 2 rows, but this one has {found}")]
    FewRows {
        /// How many there are.
        found: usize,
    },
    /// Times that do not rise.
    #[error("`{key}` goes from {} to {}, but must rise", number(*.before_s), number(*.after_s))]
    TimesRise {
        /// The key or column.
        key: &'static str,
        /// A time.
        before_s: f64,
        /// The next.
        after_s: f64,
    },
    /// Times and rows that do not match.
    #[error("`values` has {}, but `times_s` has {}", entry_count(*.rows), entry_count(*.times))]
    TimesAndRows {
        /// How many times.
        times: usize,
        /// How many rows.
        rows: usize,
    },
    /// Tables that do not fit into memory.
    #[error("the tables of all pushes hold about {} numbers, but at most {} are accepted", about(*.numbers).typed(), number(*.most))]
    TooLarge {
        /// How many numbers.
        numbers: f64,
        /// How many are accepted.
        most: f64,
    },
}

impl PushProblem {
    pub(super) fn help(&self) -> Option<String> {
        let text = match self {
            PushProblem::OnTwice { .. } => "the name of a counted population stands for all of it".into(),
            PushProblem::Unit { any, takes, .. } => format!("`{any}` takes {takes} as each axis has it"),
            PushProblem::DoesNotAct { does, .. } => format!("what acts on it is {does}"),
            PushProblem::NoLinks { instead, .. } => format!("use `by.{instead}`"),
            PushProblem::WhichLink { .. } => "name one, such as `link = \"tool0\"`; fixed links count, too".into(),
            PushProblem::TipOnly { key, .. } => format!("delete `{key}`"),
            PushProblem::NoSuchLink { link, links, .. } => choose(link, "its links are", links),
            PushProblem::NoSuchAxis { axis, axes, .. } => choose(axis, "its axes are", axes),
            PushProblem::NoWrench => "for example `force_n = [0, 0, 10]`".into(),
            PushProblem::NoTarget => {
                "say where it leads the axes: `target_rad`, `target_m`, or `target` for any axes".into()
            }
            PushProblem::FormulaValue { .. } => {
                "let the push begin later or end sooner, or keep roots, logarithms and quotients where they have a value"
                    .into()
            }
            _ => return None,
        };
        Some(text)
    }
}
