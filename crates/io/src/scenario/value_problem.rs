//! What is wrong with a single value, wherever it stands.

use forwardstep_core::GainError;
use forwardstep_sim::quantity::QuantityError;
use thiserror::Error;

use super::formula_problem::FormulaProblem;
use super::refusal::advice_on_quantity;
use super::scope::{is_one, nearest_here};
use crate::wording::{are, choose, count, entry_count, is_slip, nearest, number};

/// Why a value has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ValueProblem {
    /// The text is not TOML.
    #[error("not valid TOML: {message}")]
    Unreadable {
        /// What the TOML parser says.
        message: String,
    },
    /// A value of another kind was expected.
    #[error("found {found} where {expected} should stand")]
    WrongType {
        /// What was found.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A value stands where it has to be said first which of several kinds it is.
    #[error("found {found} where a choice of {} should stand", allowed.join(", "))]
    NotAChoice {
        /// What was found.
        found: String,
        /// The kinds.
        allowed: Vec<&'static str>,
    },
    /// A list of fixed length has another.
    #[error("found a list of {found} where {need} are needed")]
    ListLength {
        /// Entries that were found.
        found: usize,
        /// Entries that are needed.
        need: usize,
    },
    /// A text that is too long, or holds more than letters.
    #[error("the text {found} does not fit into a line")]
    Text {
        /// How it begins.
        found: String,
        /// How many bytes it may have.
        most: usize,
    },
    /// A formula that is too long, or holds what no formula does.
    #[error("the formula {found} cannot be read")]
    FormulaText {
        /// How it begins.
        found: String,
        /// How many bytes it may have.
        most: usize,
    },
    /// A key that means nothing here.
    #[error("unknown key `{key}`")]
    UnknownKey {
        /// The key.
        key: String,
        /// The keys that mean something.
        allowed: Vec<&'static str>,
    },
    /// A key that must be there is not.
    #[error("the key `{key}` is missing")]
    MissingKey {
        /// The key.
        key: &'static str,
    },
    /// A choice that does not exist.
    #[error("unknown choice `{found}`")]
    UnknownChoice {
        /// What was written.
        found: String,
        /// What can be chosen.
        allowed: Vec<&'static str>,
    },
    /// Nothing was chosen.
    #[error("nothing is chosen here")]
    NoChoice {
        /// What can be chosen.
        allowed: Vec<&'static str>,
    },
    /// Two things were chosen where one is needed.
    #[error("both `{first}` and `{second}` are given, but only one can be")]
    TwoChoices {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// A choice was made without what belongs to it.
    #[error("`{choice}` needs a value")]
    ChoiceNeedsValue {
        /// The choice.
        choice: String,
    },
    /// A value was given to a choice that has none.
    #[error("`{choice}` takes no value")]
    ChoiceTakesNoValue {
        /// The choice.
        choice: String,
    },
    /// A number that is infinite, or none.
    #[error("{found} is not a finite number")]
    NotFinite {
        /// What was written.
        found: String,
    },
    /// A number so large that it cannot be computed with.
    #[error("{found} is too large a number")]
    NumberTooLarge {
        /// What was written.
        found: String,
    },
    /// A number of more digits than are computed with.
    #[error("{found} has more digits than are computed with")]
    TooManyDigits {
        /// What was written.
        found: String,
        /// What would be computed with.
        kept: String,
    },
    /// A number out of its range.
    #[error(transparent)]
    Quantity(QuantityError),
    /// Lowest and highest value in the wrong order.
    #[error("`{key}` is [{}, {}], but the first must not exceed the second", number(*.low), number(*.high))]
    Interval {
        /// The key.
        key: &'static str,
        /// The first.
        low: f64,
        /// The second.
        high: f64,
    },
    /// Lowest and highest value that are one, or in the wrong order.
    #[error("`{key}` is [{}, {}], but the first must be less than the second", number(*.low), number(*.high))]
    Range {
        /// The key.
        key: &'static str,
        /// The first.
        low: f64,
        /// The second.
        high: f64,
    },
    /// A list that needs an entry has none.
    #[error("`{key}` is empty")]
    Empty {
        /// The key.
        key: &'static str,
    },
    /// A text that is no formula in t.
    #[error(transparent)]
    Formula(FormulaProblem),
    /// A vector of the wrong length.
    #[error("`{key}` has {}, but `{agent}` needs {need}", entry_count(*.found))]
    VectorLength {
        /// The key.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        need: usize,
        /// By whom.
        agent: String,
    },
    /// One list per agent, but not as many as agents.
    #[error("`{key}` has {}, but there {}", count(*found, "list"), are(*agents, "agent"))]
    ListPerAgent {
        /// The key.
        key: &'static str,
        /// How many lists there are.
        found: usize,
        /// How many agents there are.
        agents: usize,
    },
    /// Numbers and lists side by side.
    #[error("`{key}` mixes numbers and lists")]
    MixedList {
        /// The key.
        key: &'static str,
    },
    /// One quantity under two keys.
    #[error("both `{first}` and `{second}` are given, but they say the same")]
    SameQuantity {
        /// One key.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// More states than there are numbers for.
    #[error("`{key}` has {}, but the states of an agent are numbered from 1 to {most}", entry_count(*.found))]
    Order {
        /// The key.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many are accepted.
        most: usize,
    },
    /// A gain that cannot be used.
    #[error("`{key}` of `{agent}`: {error}")]
    Gain {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
        /// What is wrong with it.
        error: GainError,
    },
    /// A matrix whose rows have different lengths.
    #[error("`{key}` has {rows} rows, but row {row} has {}", entry_count(*.entries))]
    NotSquare {
        /// The key.
        key: &'static str,
        /// The number of rows.
        rows: usize,
        /// The row that differs, from one.
        row: usize,
        /// How many entries it has.
        entries: usize,
    },
}

impl ValueProblem {
    pub(super) fn help(&self) -> Option<String> {
        let text = match self {
            ValueProblem::UnknownKey { key, allowed } => within_scope(key, "allowed here:", allowed),
            ValueProblem::UnknownChoice { found, allowed } => within_scope(found, "choose one of", allowed),
            ValueProblem::NoChoice { allowed } => choose("", "choose one of", allowed),
            ValueProblem::NumberTooLarge { .. } => "numbers may be up to 1e30 in size, whole numbers up to 9e18".into(),
            ValueProblem::TooManyDigits { kept, .. } => format!("write {kept}, so that what is checked is what runs"),
            ValueProblem::Text { most, .. } => {
                format!("names, choices and titles are one line of at most {most} bytes without control characters")
            }
            ValueProblem::FormulaText { most, .. } => {
                format!("a formula has at most {most} bytes, over as many lines as it needs, and no control characters")
            }
            ValueProblem::WrongType { found, expected } if found == "a table" && expected == "a list" => {
                "a list of tables has its name in double brackets, such as [[agents]]".into()
            }
            ValueProblem::WrongType { found, expected } => return as_number(found, expected),
            ValueProblem::NotAChoice { found, allowed } => return of_choice(found, allowed),
            ValueProblem::MissingKey { key } => return missing(key).map(str::to_owned),
            ValueProblem::Unreadable { message } if is_too_deep(message) => {
                "no value of a scenario is a list of lists of lists of lists, or a table nested so deeply".into()
            }
            ValueProblem::ChoiceNeedsValue { choice } => format!("write it with its value: {{ {choice} = … }}"),
            ValueProblem::ChoiceTakesNoValue { choice } => format!("write it as a text: \"{choice}\""),
            ValueProblem::Formula(problem) => return problem.help(),
            ValueProblem::Quantity(error) => return advice_on_quantity(error),
            _ => return None,
        };
        Some(text)
    }
}

/// How a number is written that stands in quotes, or has a point where it is a count.
fn as_number(found: &str, expected: &str) -> Option<String> {
    let bare = found.trim_matches('"');
    let value = bare.parse::<f64>().ok().filter(|value| value.is_finite())?;
    match expected {
        "a whole number" => (value.fract() == 0.0).then(|| format!("write {value}")),
        _ if expected.starts_with("a number") => (bare != found).then(|| format!("write {bare}, without quotes")),
        _ => None,
    }
}

/// How a value is written that needs a word for what it is.
fn of_choice(found: &str, allowed: &[&str]) -> Option<String> {
    /// What stands under these is a number.
    const OF_NUMBERS: [&str; 4] = ["gain", "constant_s", "saturated", "stops_n"];
    let usual = OF_NUMBERS.into_iter().find(|usual| found.parse::<f64>().is_ok() && allowed.contains(usual));
    let (first, value) = usual.map(|usual| (usual, found)).or(allowed.first().map(|first| (*first, "…")))?;
    Some(format!("say which it is, behind the key and a dot, such as `.{first} = {value}`"))
}

/// Whether the parser gave up on brackets within brackets.
pub(super) fn is_too_deep(message: &str) -> bool {
    message.contains("recurs")
}

/// What to write where a key is missing that every scenario has.
fn missing(key: &str) -> Option<&'static str> {
    Some(match key {
        "format" => {
            "write `format = 2` in the first line; `forwardstep new my-scenario.toml` writes a whole scenario to start from"
        }
        "title" => "say in a line what the scenario shows: `title = \"Two arms agree\"`",
        "time" => "say how long to simulate: `time = { end_s = 10 }`",
        "end_s" => "say how long to simulate, in s: `end_s = 10`",
        "agents" => "every robot, or number of robots that are alike, is an entry `[[agents]]`",
        "network" => "say who hears whom: `[network]` with `edges.ring = {}`, for instance",
        "reference" => {
            "say what the robots are to do: `[reference.consensus]` to agree, `[reference.leader]` to follow a leader, `[reference.tracking]` targets"
        }
        _ => return None,
    })
}

/// What there is instead of a word; of what is not modelled that it is not, unless it is a slip.
fn within_scope(word: &str, kind: &str, allowed: &[&'static str]) -> String {
    // A word that is a wish as it stands is nearer to that than to a key that resembles it.
    let candidates = || allowed.iter().copied();
    let slips = if is_one(word) { is_slip(word, candidates()) } else { nearest(word, candidates()).is_some() };
    match nearest_here(word).filter(|_| !slips) {
        Some(beyond) => format!("{beyond}; {}", choose("", kind, allowed)),
        None => choose(word, kind, allowed),
    }
}
