//! Where a quantity of a setup stands, and the checks of ranges, each of which stands here once.
//!
//! ```
//! use forwardstep_sim::quantity::{Path, positive};
//!
//! let error = positive("solver.method.fixed", "step_s", -1.0).unwrap_err();
//! assert_eq!(error.to_string(), "`step_s` is -1, but must be positive");
//! assert_eq!(error.path.to_string(), "solver.method.fixed.step_s");
//! assert_eq!(Path::from("agents").index(3).key("law").to_string(), "agents[3].law");
//! ```

use std::fmt;

use forwardstep_core::signal::superscript;
use thiserror::Error;

/// Numbers beyond this are refused, so that no product of a few of them overflows.
pub const LARGEST: f64 = 1e30;
/// Positive numbers below this are refused, so that no product of a few of them vanishes.
pub const SMALLEST: f64 = 1e-30;
/// Switches, jumps or samples until the end of a run that are accepted; each ends a step.
pub const MOST_EVENTS: f64 = 1e7;

/// A step on the way to a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Segment {
    /// The key of a table.
    Key(&'static str),
    /// The place in a list, from zero.
    Index(usize),
}

/// Where something stands, from the whole setup inwards, by the keys of scenario files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Path {
    segments: Vec<Segment>,
    name: &'static str,
}

impl From<&'static str> for Path {
    fn from(keys: &'static str) -> Self {
        Path::default().key(keys)
    }
}

impl Path {
    /// What stands there under a key; under several, with dots between them, one inside the other.
    pub fn key(mut self, keys: &'static str) -> Self {
        if !keys.is_empty() {
            self.segments.extend(keys.split('.').map(Segment::Key));
            self.name = keys;
        }
        self
    }

    /// An entry of the list that stands there, from zero.
    pub fn index(mut self, index: usize) -> Self {
        self.segments.push(Segment::Index(index));
        self
    }

    /// From the whole setup inwards.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The keys that were added last, by which messages call the quantity.
    pub fn name(&self) -> &'static str {
        self.name
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, segment) in self.segments.iter().enumerate() {
            match segment {
                Segment::Key(key) => write!(f, "{}{key}", if k > 0 { "." } else { "" })?,
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// What a quantity must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Requirement {
    /// Positive.
    Positive,
    /// Zero or more.
    NotNegative,
    /// From `low` to `high`.
    Within {
        /// The smallest that is allowed.
        low: f64,
        /// The largest that is allowed.
        high: f64,
    },
    /// Not less than another.
    AtLeast {
        /// The other.
        key: &'static str,
        /// Its value.
        bound: f64,
    },
    /// Not more than another.
    AtMost {
        /// The other.
        key: &'static str,
        /// Its value.
        bound: f64,
    },
    /// More than another.
    MoreThan {
        /// The other.
        key: &'static str,
        /// Its value.
        bound: f64,
    },
    /// A list with an entry; the value is how many it has.
    Filled,
    /// A list with as many entries as another; the value is how many it has.
    AsMany {
        /// The other.
        key: &'static str,
        /// How many it has.
        need: usize,
    },
    /// A formula in t that meets this at all times of a run. The value is the first that was seen not to, if any was.
    Throughout {
        /// What it must be.
        must: Sign,
        /// What it could be shown to lie between.
        within: [f64; 2],
        /// When the value was seen, s.
        seen_s: Option<f64>,
        /// The end of the run, s.
        until_s: f64,
    },
    /// What these words say, `must be two`.
    Such(&'static str),
    /// So large, or so small, that a run has only so many of these.
    Few {
        /// What they are.
        what: &'static str,
        /// How many there are.
        count: f64,
        /// How many are accepted.
        most: f64,
    },
}

/// What the sign of a formula must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Positive.
    Positive,
    /// Zero or more.
    NotNegative,
}

impl Sign {
    /// Whether `value` is finite and has it.
    pub fn is_of(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Sign::Positive => value > 0.0,
                Sign::NotNegative => value >= 0.0,
            }
    }
}

impl fmt::Display for Sign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Sign::Positive => "must be positive",
            Sign::NotNegative => "must not be negative",
        })
    }
}

/// A quantity out of its range.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct QuantityError {
    /// Where it stands.
    pub path: Path,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub requirement: Requirement,
}

impl QuantityError {
    /// The same about what stands under `at`.
    pub fn under(mut self, at: impl Into<Path>) -> Self {
        let mut segments = at.into().segments;
        segments.append(&mut self.path.segments);
        self.path.segments = segments;
        self
    }
}

impl fmt::Display for QuantityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, value) = (Name(self.path.name()), number(self.value));
        let is = format!("{name} is {value}, but");
        match self.requirement {
            Requirement::Positive => write!(f, "{is} {}", Sign::Positive),
            Requirement::NotNegative => write!(f, "{is} {}", Sign::NotNegative),
            Requirement::Within { low, high } => write!(f, "{is} must be from {} to {}", number(low), number(high)),
            Requirement::AtLeast { key, bound } => {
                write!(f, "{is} must not be less than {}, which is {}", Name(key), number(bound))
            }
            Requirement::AtMost { key, bound } => {
                write!(f, "{is} must not exceed {}, which is {}", Name(key), number(bound))
            }
            Requirement::MoreThan { key, bound } => {
                write!(f, "{is} must exceed {}, which is {}", Name(key), number(bound))
            }
            Requirement::Such(words) => write!(f, "{is} {words}"),
            Requirement::Filled => write!(f, "{name} is empty"),
            Requirement::AsMany { key, need } => {
                write!(f, "{name} has {}, but {} has {}", entries(self.value as usize), Name(key), entries(need))
            }
            Requirement::Throughout { must, within, seen_s, until_s } => {
                let [value, low, high] = [self.value, within[0], within[1]].map(rounded).map(number);
                match seen_s.map(rounded).map(number) {
                    Some(t) if self.value == 0.0 => write!(f, "{name} is 0, or rounds to it, at t = {t} s, but {must}"),
                    Some(t) if self.value.is_finite() => write!(f, "{name} is {value} at t = {t} s, but {must}"),
                    Some(t) => write!(f, "{name} has no finite value at t = {t} s"),
                    None => write!(
                        f,
                        "{name} {must}, but could only be shown to lie between {low} and {high} until the end of the \
                         run at {} s",
                        number(until_s)
                    ),
                }
            }
            Requirement::Few { what, count, most } => {
                // Two digits must not say that it is not too many.
                let about = about(count).typed();
                let [word, count] = match about.value > most {
                    true => ["about", &about.to_string()],
                    false => ["more than", &number(most).to_string()],
                };
                let most = number(most);
                write!(f, "{word} {count} {what} until the end of the run, but at most {most} are accepted")
            }
        }
    }
}

/// A key as messages write it. What is counted has words for a name, and no key.
pub(crate) struct Name(pub(crate) &'static str);

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.contains(' ') { f.write_str(self.0) } else { write!(f, "`{}`", self.0) }
    }
}

/// "1 entry", "2 entries".
pub fn entries(count: usize) -> String {
    if count == 1 { "1 entry".into() } else { format!("{count} entries") }
}

/// A computed number without the noise of its last digits.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A number as a person would type it: plain, or as `1e-9` when it is very large or small.
pub fn number(value: f64) -> Number {
    Number { value, is_typed: true }
}

/// A number to two digits, enough to judge by, as it is read: plain, or as `1 × 10⁻⁹` when it is very large or small.
pub fn about(value: f64) -> Number {
    Number { value: format!("{value:.1e}").parse().unwrap_or(value), is_typed: false }
}

/// `2.5e-4` as it is read, `2.5 × 10⁻⁴`; what has no power of ten stays as it is.
pub fn with_power(number: &str) -> String {
    match number.split_once('e') {
        Some((digits, power)) => format!("{digits} × 10{}", superscript(power)),
        None => number.to_owned(),
    }
}

/// See [`number`] and [`about`].
#[derive(Clone, Copy, Debug)]
pub struct Number {
    value: f64,
    is_typed: bool,
}

impl Number {
    /// As a person would type it.
    #[must_use]
    pub fn typed(self) -> Self {
        Number { is_typed: true, ..self }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Number { value, is_typed } = *self;
        let size = value.abs();
        match size == 0.0 || (1e-4..1e7).contains(&size) || !size.is_finite() {
            true => write!(f, "{value}"),
            false if is_typed => write!(f, "{value:e}"),
            false => f.write_str(&with_power(&format!("{value:e}"))),
        }
    }
}

fn check(
    meets: bool,
    within: impl Into<Path>,
    key: &'static str,
    value: f64,
    requirement: Requirement,
) -> Result<(), QuantityError> {
    if meets { Ok(()) } else { Err(QuantityError { path: within.into().key(key), value, requirement }) }
}

/// Checks that `key` at `at` is positive, and of a size that products bear.
///
/// # Errors
/// [`QuantityError`] if it is not.
pub fn positive(at: impl Into<Path>, key: &'static str, value: f64) -> Result<(), QuantityError> {
    let at = at.into();
    check(value > 0.0, at.clone(), key, value, Requirement::Positive)?;
    within(at, key, value, SMALLEST, LARGEST)
}

/// Checks that `key` at `at` is zero or more, and of a size that products bear.
///
/// # Errors
/// [`QuantityError`] if it is not.
pub fn not_negative(at: impl Into<Path>, key: &'static str, value: f64) -> Result<(), QuantityError> {
    let at = at.into();
    check(value >= 0.0, at.clone(), key, value, Requirement::NotNegative)?;
    within(at, key, value, 0.0, LARGEST)
}

/// Checks that `key` at `at` is a finite number.
///
/// # Errors
/// [`QuantityError`] if it is not.
pub fn finite(at: impl Into<Path>, key: &'static str, value: f64) -> Result<(), QuantityError> {
    such(value.is_finite(), at, key, value, "must be a finite number")
}

/// Checks that `key` at `at` is from `low` to `high`.
///
/// # Errors
/// [`QuantityError`] if it is not.
pub fn within(at: impl Into<Path>, key: &'static str, value: f64, low: f64, high: f64) -> Result<(), QuantityError> {
    check((low..=high).contains(&value), at, key, value, Requirement::Within { low, high })
}

/// Checks that `key` at `at` is not less than `bound`, which is what `other` is.
///
/// # Errors
/// [`QuantityError`] if it is.
pub fn at_least(
    at: impl Into<Path>,
    key: &'static str,
    value: f64,
    (other, bound): (&'static str, f64),
) -> Result<(), QuantityError> {
    check(value >= bound, at, key, value, Requirement::AtLeast { key: other, bound })
}

/// Checks that `key` at `at` does not exceed `bound`, which is what `other` is.
///
/// # Errors
/// [`QuantityError`] if it does.
pub fn at_most(
    at: impl Into<Path>,
    key: &'static str,
    value: f64,
    (other, bound): (&'static str, f64),
) -> Result<(), QuantityError> {
    check(value <= bound, at, key, value, Requirement::AtMost { key: other, bound })
}

/// Checks that `key` at `at` exceeds `bound`, which is what `other` is.
///
/// # Errors
/// [`QuantityError`] if it does not.
pub fn more_than(
    at: impl Into<Path>,
    key: &'static str,
    value: f64,
    (other, bound): (&'static str, f64),
) -> Result<(), QuantityError> {
    check(value > bound, at, key, value, Requirement::MoreThan { key: other, bound })
}

/// Checks that the list `key` at `at` has an entry.
///
/// # Errors
/// [`QuantityError`] if it has none.
pub fn filled(at: impl Into<Path>, key: &'static str, list: &[f64]) -> Result<(), QuantityError> {
    check(!list.is_empty(), at, key, 0.0, Requirement::Filled)
}

/// Checks that the list `key` at `at` has as many entries as `other` has.
///
/// # Errors
/// [`QuantityError`] if it has not.
pub fn as_many(
    at: impl Into<Path>,
    key: &'static str,
    list: &[f64],
    (other, need): (&'static str, usize),
) -> Result<(), QuantityError> {
    check(list.len() == need, at, key, list.len() as f64, Requirement::AsMany { key: other, need })
}

/// Checks that every entry of the list `key` at `at` meets `check`.
///
/// # Errors
/// [`QuantityError`] for the first that does not.
pub fn each(
    at: impl Into<Path>,
    key: &'static str,
    list: &[f64],
    check: impl Fn(Path, &'static str, f64) -> Result<(), QuantityError>,
) -> Result<(), QuantityError> {
    let list_at = at.into().key(key);
    list.iter().enumerate().try_for_each(|(k, value)| check(list_at.clone().index(k), "", *value))
}

/// Checks that `key` at `at` is such as `words` say, which `meets` tells.
///
/// # Errors
/// [`QuantityError`] if it is not.
pub fn such(
    meets: bool,
    at: impl Into<Path>,
    key: &'static str,
    value: f64,
    words: &'static str,
) -> Result<(), QuantityError> {
    check(meets, at, key, value, Requirement::Such(words))
}

/// Checks that a run has at most `most` of `what`, because `key` at `at` is `value`; it has `count`.
///
/// # Errors
/// [`QuantityError`] if there are more.
pub fn few(
    at: impl Into<Path>,
    key: &'static str,
    value: f64,
    (what, count, most): (&'static str, f64, f64),
) -> Result<(), QuantityError> {
    check(count <= most, at, key, value, Requirement::Few { what, count: count.round(), most })
}
