//! Why a text is no formula, and the words of formulas, which the advice names.

use forwardstep_core::expression::{Binary, MOST_DIGITS, MOST_STEPS, Number, Unary};
use thiserror::Error;

use super::formula::MOST_NESTED;
use crate::wording::{choose, nearest};

/// Functions of one argument.
pub(super) const FUNCTIONS: [(&str, Unary); 8] = [
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("exp", Unary::Exp),
    ("log", Unary::Log),
    ("sqrt", Unary::Sqrt),
    ("abs", Unary::Abs),
    ("tanh", Unary::Tanh),
    ("atan", Unary::Atan),
];
/// Functions of two arguments or more.
pub(super) const CHOICES: [(&str, Binary); 2] = [("min", Binary::Min), ("max", Binary::Max)];
/// Names that stand for numbers.
pub(super) const CONSTANTS: [(&str, Number); 2] = [("pi", Number::PI), ("e", Number::E)];
/// What would make a formula jump.
pub(super) const JUMPS: [&str; 17] = [
    "floor",
    "ceil",
    "round",
    "trunc",
    "frac",
    "fract",
    "mod",
    "sign",
    "sgn",
    "signum",
    "step",
    "heaviside",
    "if",
    "where",
    "square",
    "sawtooth",
    "tan",
];

pub(super) const A_VALUE: &str = "a number, `t`, a function or a parenthesis";
pub(super) const A_VALUE_OF_VARIABLES: &str = "a number, a variable, a function or a parenthesis";
pub(super) const AN_OPERATOR: &str = "an operator (+ - * / ^) or the end";

/// Why a text is no formula.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FormulaProblem {
    /// Nothing at all.
    #[error("the formula is empty")]
    Empty,
    /// Something else should stand here.
    #[error("found {found} in a formula where {expected} should stand")]
    Expected {
        /// What was found.
        found: String,
        /// What should be there.
        expected: &'static str,
    },
    /// A name that is none of a number.
    #[error("there is no `{name}` in a formula")]
    UnknownName {
        /// The name.
        name: String,
    },
    /// A name that is none of a variable.
    #[error("there is no `{name}` in this formula")]
    UnknownVariable {
        /// The name.
        name: String,
        /// The variables.
        names: Vec<String>,
    },
    /// A name that is none of a function.
    #[error("there is no function `{name}`")]
    UnknownFunction {
        /// The name.
        name: String,
    },
    /// A function or a comparison with a jump.
    #[error("`{name}` jumps, but formulas are continuous")]
    Jumps {
        /// The name.
        name: String,
    },
    /// A function without its argument.
    #[error("the function `{name}` has no argument")]
    NoArgument {
        /// The name.
        name: &'static str,
    },
    /// A function with more or fewer arguments than it takes.
    #[error("`{name}` takes {takes}, but has {found}")]
    Arguments {
        /// The name.
        name: &'static str,
        /// How many it takes, in words.
        takes: &'static str,
        /// How many there are.
        found: usize,
    },
    /// A number that cannot be computed with.
    #[error("{found} is too large a number")]
    NumberTooLarge {
        /// What was written.
        found: String,
    },
    /// A number that is not kept as it is written.
    #[error("{found} has too many digits or too small an exponent")]
    NumberTooLong {
        /// What was written.
        found: String,
    },
    /// An exponent in which a variable appears.
    #[error("the exponent changes with {of}")]
    VaryingExponent {
        /// The variable.
        of: String,
    },
    /// An exponent that is no number.
    #[error("the exponent has no finite value")]
    ExponentValue,
    /// A parenthesis without its partner.
    #[error("this parenthesis is not closed")]
    OpenParenthesis,
    /// Parentheses, signs or powers too deep within each other.
    #[error(
        "the formula is nested too deeply: more than {MOST_NESTED} parentheses, signs, powers and operators stand within each other"
    )]
    TooDeep,
    /// More steps than are accepted.
    #[error(
        "the formula is too long: it has more than {MOST_STEPS} numbers and operations, and a value of it would take more than 2 μs at every stage of every step"
    )]
    TooLong,
}

impl FormulaProblem {
    /// What to do about it.
    pub fn help(&self) -> Option<String> {
        let functions: Vec<&str> =
            FUNCTIONS.iter().map(|entry| entry.0).chain(CHOICES.iter().map(|entry| entry.0)).collect();
        let text = match self {
            FormulaProblem::Empty => "a formula in t is for example \"0.2 + 0.1*sin(2*pi*t/3)\", one of a chain \"-x^3 + sin(x)\"".into(),
            FormulaProblem::Expected { found, .. } if found == "\"**\"" => "powers are written `2^3`".into(),
            FormulaProblem::Expected { expected: AN_OPERATOR, .. } => {
                "products are written with a star: `2*pi`, `3*(pi + 1)`".into()
            }
            FormulaProblem::UnknownName { name } => {
                if nearest(name, functions.clone()).as_deref() == Some(name.as_str()) {
                    return Some(format!("a function has its argument in parentheses: `{name}(t)`"));
                }
                choose(name, "there are", &[vec!["t", "pi", "e"], functions].concat())
            }
            FormulaProblem::UnknownVariable { name, names } => {
                let names: Vec<&str> = names.iter().map(String::as_str).chain(["pi", "e"]).collect();
                choose(name, "there are", &[names, functions].concat())
            }
            FormulaProblem::UnknownFunction { name } => choose(name, "the functions are", &functions),
            FormulaProblem::Jumps { .. } => {
                "what jumps has keys of its own: `delay.piecewise_constant`, `delay.saw_tooth`, or phases of a network; \
                 elsewhere `tanh` of something large comes close"
                    .into()
            }
            FormulaProblem::NoArgument { name } => format!("write `{name}(…)`"),
            FormulaProblem::VaryingExponent { of } => {
                format!("exponents are constant; write `exp({of}*log(2))` for 2 to the {of}")
            },
            FormulaProblem::NumberTooLong { .. } => {
                format!("numbers may have {MOST_DIGITS} digits and be as small as 1e-300; they are kept exactly as they are written")
            }
            FormulaProblem::TooLong => {
                "long functions of time may be given by points instead".into()
            }
            FormulaProblem::TooDeep => "the reader calls itself for every level; sums and products need no parentheses of their own".into(),
            FormulaProblem::NumberTooLarge { .. } => "numbers may be up to 1e30 in size".into(),
            _ => return None,
        };
        Some(text)
    }
}
