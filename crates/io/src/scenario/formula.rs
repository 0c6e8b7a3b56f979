//! Formulas as they are written, such as `"0.2 + 0.1*sin(2*pi*t/3)"` → [`Expression`].
//!
//! A parser by precedence: a value, then operators for as long as they bind more tightly than the one before. It writes
//! operands before operators, which is the order in which an [`Expression`] has its steps.
//!
//! ```
//! use forwardstep_io::scenario::formula::parse_formula;
//!
//! let formula = parse_formula("1 + 0.5*sin(t)")?;
//! assert_eq!(formula.eval(0.0), 1.0);
//! let error = parse_formula("1 + 0.5*sine(t)").unwrap_err();
//! assert_eq!(error.problem.to_string(), "there is no function `sine`");
//! assert_eq!(error.at, 8..12);
//! # Ok::<(), forwardstep_io::scenario::formula::FormulaFault>(())
//! ```

use std::ops::Range;

use forwardstep_core::expression::{Binary, Expression, MOST_STEPS, Number, Step, Unary};
use forwardstep_sim::quantity::LARGEST;
use thiserror::Error;

use super::at::At;
use super::de::quoted;
use super::fault::Fault;
pub use super::formula_problem::FormulaProblem;
use super::formula_problem::{A_VALUE, A_VALUE_OF_VARIABLES, AN_OPERATOR, CHOICES, CONSTANTS, FUNCTIONS, JUMPS};
use super::formula_text::FormulaText;
use super::value_problem::ValueProblem;

/// Parentheses, signs, powers and operators within each other: the reader calls itself for each.
pub(super) const MOST_NESTED: usize = 128;

/// What is wrong with a formula, and which bytes of it are.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{problem}")]
pub struct FormulaFault {
    /// What is wrong.
    pub problem: FormulaProblem,
    /// The bytes of the formula that it is about.
    pub at: Range<usize>,
}

/// Reads a formula in t, which is its variable 0.
///
/// # Errors
/// The first mistake and its place. Any text gives a result; none panics.
pub fn parse_formula(text: &str) -> Result<Expression, FormulaFault> {
    Parser::new(text, &["t".to_owned()], A_VALUE).whole()
}

/// Reads a formula in variables with these names, which must not hold t.
///
/// # Errors
/// The first mistake and its place. Any text gives a result; none panics.
pub fn parse_expression(text: &str, names: &[String]) -> Result<Expression, FormulaFault> {
    Parser::new(text, names, A_VALUE_OF_VARIABLES).whole()
}

/// Reads a formula of a scenario or a table; a mistake is placed within its text.
pub(super) fn formula(text: &At<FormulaText>) -> Result<Expression, Fault> {
    parse_formula(text.value.as_ref()).map_err(|fault| placed(text, fault))
}

/// Reads a formula in variables; a mistake is placed within its text.
pub(super) fn formula_in(text: &At<FormulaText>, names: &[String]) -> Result<Expression, Fault> {
    parse_expression(text.value.as_ref(), names).map_err(|fault| placed(text, fault))
}

/// The place of a mistake in the file.
fn placed(text: &At<FormulaText>, FormulaFault { problem, at }: FormulaFault) -> Fault {
    // Quotation marks stand around the text; where it is written with escapes its bytes are not those of the file.
    let marks = text.span.len().checked_sub(text.value.as_ref().len());
    let place = match marks {
        Some(marks @ (0 | 2 | 6)) => {
            let start = text.span.start + marks / 2;
            start + at.start..start + at.end
        }
        // Behind three of them the text may begin on the next line.
        Some(7) if text.value.as_ref().contains('\n') => {
            let start = text.span.start + 4;
            start + at.start..start + at.end
        }
        _ => text.span.clone(),
    };
    Fault::new(ValueProblem::Formula(problem)).at(&place)
}

struct Parser<'a> {
    text: &'a str,
    /// Names of variables.
    names: &'a [String],
    /// What a value may be.
    a_value: &'static str,
    /// The byte to go on from.
    next: usize,
    steps: Vec<Step>,
    depth: usize,
}

/// How tightly operators bind: to the left, and to the right. There is no step for a power, whose exponent belongs to it.
fn binding(operator: char) -> Option<(u8, u8, Option<Binary>)> {
    Some(match operator {
        '+' => (1, 2, Some(Binary::Add)),
        '-' => (1, 2, Some(Binary::Subtract)),
        '*' => (3, 4, Some(Binary::Multiply)),
        '/' => (3, 4, Some(Binary::Divide)),
        // To the right first: 2^3^2 is 2^9.
        '^' => (8, 7, None),
        _ => return None,
    })
}

/// A sign binds more tightly than a product and less than a power: −t² is −(t²).
const SIGN: u8 = 5;

impl<'a> Parser<'a> {
    fn new(text: &'a str, names: &'a [String], a_value: &'static str) -> Self {
        Parser { text, names, a_value, next: 0, steps: Vec::new(), depth: 0 }
    }

    /// The whole text.
    fn whole(mut self) -> Result<Expression, FormulaFault> {
        if self.peek().is_none() {
            return Err(self.fault(FormulaProblem::Empty, 0..self.text.len()));
        }
        self.expression(0)?;
        if self.peek().is_some() {
            return Err(self.unexpected(AN_OPERATOR));
        }
        // Its length was counted, and every operator has its operands.
        match Expression::new(self.steps) {
            Ok(formula) => Ok(formula.with_exact_constants()),
            Err(_) => Err(FormulaFault { problem: FormulaProblem::TooLong, at: 0..self.text.len() }),
        }
    }

    /// The next character that is no blank.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.next..];
        let trimmed = rest.trim_start();
        self.next += rest.len() - trimmed.len();
        trimmed.chars().next()
    }

    /// Everything that binds at least as tightly as `least`.
    fn expression(&mut self, least: u8) -> Result<(), FormulaFault> {
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(self.fault(FormulaProblem::TooDeep, self.next..self.text.len()));
        }
        self.value()?;
        while let Some(operator) = self.peek() {
            let Some((left, right, step)) = binding(operator) else { break };
            if left < least {
                break;
            }
            let at = self.next;
            self.next += operator.len_utf8();
            if self.text[at..].starts_with("**") {
                let problem = FormulaProblem::Expected { found: "\"**\"".into(), expected: "one operator" };
                return Err(self.fault(problem, at..at + 2));
            }
            let operand = self.steps.len();
            self.expression(right)?;
            let step = match step {
                Some(function) => Step::Binary(function),
                None => self.exponent(operand, at + 1)?,
            };
            self.push(step)?;
        }
        self.depth -= 1;
        Ok(())
    }

    /// Takes the steps from `first` on, which were written after byte `from`, back as a constant exponent.
    fn exponent(&mut self, first: usize, from: usize) -> Result<Step, FormulaFault> {
        let at = from + (self.text[from..].len() - self.text[from..].trim_start().len())..self.next;
        let steps = self.steps.split_off(first);
        let variable =
            steps.iter().find_map(|step| if let Step::Variable(k) = step { self.names.get(*k) } else { None });
        if let Some(of) = variable {
            return Err(self.fault(FormulaProblem::VaryingExponent { of: of.clone() }, at));
        }
        match Expression::new(steps).ok().and_then(|exponent| exponent.constant()) {
            Some(exponent) if exponent.value().abs() <= LARGEST => Ok(Step::Power(exponent)),
            _ => Err(self.fault(FormulaProblem::ExponentValue, at)),
        }
    }

    /// A number, a name, a function, a sign before any of them, or parentheses.
    fn value(&mut self) -> Result<(), FormulaFault> {
        let first = self.peek();
        let at = self.next;
        match first {
            Some('(') => {
                self.next += 1;
                self.expression(0)?;
                self.close(at)
            }
            Some('-') => {
                self.next += 1;
                self.expression(SIGN)?;
                self.push(Step::Unary(Unary::Negate))
            }
            Some('+') => {
                self.next += 1;
                self.expression(SIGN)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(at),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(at),
            _ => Err(self.unexpected(self.a_value)),
        }
    }

    fn close(&mut self, opened: usize) -> Result<(), FormulaFault> {
        match self.peek() {
            Some(')') => {
                self.next += 1;
                Ok(())
            }
            None => Err(self.fault(FormulaProblem::OpenParenthesis, opened..opened + 1)),
            Some(_) => Err(self.unexpected("an operator (+ - * / ^) or a closing parenthesis")),
        }
    }

    fn number(&mut self, at: usize) -> Result<(), FormulaFault> {
        let rest = &self.text.as_bytes()[at..];
        let digits = |from: usize| rest[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let mut length = digits(0);
        if rest.get(length) == Some(&b'.') {
            length += 1 + digits(length + 1);
        }
        // An exponent belongs to the number only when digits follow: 2e is 2 and then e, which is a mistake of its own.
        if matches!(rest.get(length), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(rest.get(length + 1), Some(b'+' | b'-')));
            let more = if length + 1 + sign <= rest.len() { digits(length + 1 + sign) } else { 0 };
            if more > 0 {
                length += 1 + sign + more;
            }
        }
        let written = &self.text[at..at + length];
        self.next = at + length;
        let place = at..self.next;
        match (written.parse::<f64>(), Number::decimal(written)) {
            (Ok(value), _) if value > LARGEST => {
                Err(self.fault(FormulaProblem::NumberTooLarge { found: written.into() }, place))
            }
            (Ok(_), Some(number)) => self.push(Step::Number(number)),
            (Ok(_), None) => Err(self.fault(FormulaProblem::NumberTooLong { found: written.into() }, place)),
            (Err(_), _) => {
                let problem = FormulaProblem::Expected { found: quoted(written), expected: self.a_value };
                Err(self.fault(problem, place))
            }
        }
    }

    fn name(&mut self, at: usize) -> Result<(), FormulaFault> {
        let rest = &self.text[at..];
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let name = &rest[..length];
        let place = at..at + length;
        self.next = place.end;
        let called = self.peek() == Some('(');
        if JUMPS.contains(&name) {
            return Err(self.fault(FormulaProblem::Jumps { name: name.into() }, place));
        }
        let variable = self.names.iter().position(|known| known == name).map(Step::Variable);
        let constant = CONSTANTS.into_iter().find(|(known, _)| *known == name).map(|(_, number)| Step::Number(number));
        if let Some(step) = variable.or(constant) {
            return if called { Err(self.unexpected(AN_OPERATOR)) } else { self.push(step) };
        }
        let one = FUNCTIONS.into_iter().find(|(known, _)| *known == name);
        let choice = CHOICES.into_iter().find(|(known, _)| *known == name);
        let (name, step) = match (one, choice) {
            (Some((name, function)), _) => (name, Step::Unary(function)),
            (None, Some((name, function))) => (name, Step::Binary(function)),
            (None, None) => {
                let name = name.to_owned();
                let problem = match self.names {
                    _ if called => FormulaProblem::UnknownFunction { name },
                    [t] if t == "t" => FormulaProblem::UnknownName { name },
                    names => FormulaProblem::UnknownVariable { name, names: names.to_vec() },
                };
                return Err(self.fault(problem, place));
            }
        };
        if !called {
            return Err(self.fault(FormulaProblem::NoArgument { name }, place));
        }
        let opened = self.next;
        self.next += 1;
        let mut found = 0;
        if self.peek() != Some(')') {
            loop {
                self.expression(0)?;
                found += 1;
                if found > 1 && one.is_none() {
                    self.push(step.clone())?;
                }
                if self.peek() != Some(',') {
                    break;
                }
                self.next += 1;
            }
        }
        self.close(opened)?;
        let takes = if one.is_some() { "one argument" } else { "two arguments or more" };
        if one.is_some() != (found == 1) || found == 0 {
            return Err(self.fault(FormulaProblem::Arguments { name, takes, found }, place.start..self.next));
        }
        if one.is_some() { self.push(step) } else { Ok(()) }
    }

    fn push(&mut self, step: Step) -> Result<(), FormulaFault> {
        if self.steps.len() >= MOST_STEPS {
            return Err(self.fault(FormulaProblem::TooLong, 0..self.text.len()));
        }
        self.steps.push(step);
        Ok(())
    }

    /// What stands next should not.
    fn unexpected(&mut self, expected: &'static str) -> FormulaFault {
        let Some(c) = self.peek() else {
            let problem = FormulaProblem::Expected { found: "its end".into(), expected };
            return self.fault(problem, self.next..self.next);
        };
        let place = self.next..self.next + c.len_utf8();
        let problem = match c {
            '<' | '>' | '=' | '?' | '!' | '%' | '&' | '|' => FormulaProblem::Jumps { name: c.into() },
            c => FormulaProblem::Expected { found: quoted(c.encode_utf8(&mut [0; 4])), expected },
        };
        self.fault(problem, place)
    }

    fn fault(&self, problem: FormulaProblem, at: Range<usize>) -> FormulaFault {
        FormulaFault { problem, at }
    }
}
