//! Formulas in t as they are written, such as `"0.2 + 0.1*sin(2*pi*t/3)"` → [`Formula`].
//!
//! A parser by precedence: a value, then operators for as long as they bind more tightly than the one before. It writes
//! operands before operators, which is the order in which a [`Formula`] has its steps.
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

use forwardstep_core::expression::Expression;
use forwardstep_sim::formula::{Formula, FormulaError, FormulaStep, MOST_STEPS, expression};
use thiserror::Error;

use super::at::At;
use super::de::quoted;
use super::fault::{Fault, LARGEST};
pub use super::formula_problem::FormulaProblem;
use super::formula_problem::{A_VALUE, A_VALUE_OF_VARIABLES, AN_OPERATOR, CHOICES, FUNCTIONS, JUMPS, NAMES};
use super::value_problem::ValueProblem;

/// Parentheses, signs and powers within each other.
const MOST_NESTED: usize = 64;

/// What is wrong with a formula, and which bytes of it are.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{problem}")]
pub struct FormulaFault {
    /// What is wrong.
    pub problem: FormulaProblem,
    /// The bytes of the formula that it is about.
    pub at: Range<usize>,
}

/// Reads a formula.
///
/// # Errors
/// The first mistake and its place. Any text gives a result; none panics.
pub fn parse_formula(text: &str) -> Result<Formula, FormulaFault> {
    let steps = parse(text, None)?;
    Formula::new(steps).map_err(|error| whole(text, error))
}

/// Reads a formula in variables with these names, which must not hold t.
///
/// # Errors
/// The first mistake and its place. Any text gives a result; none panics.
pub fn parse_expression(text: &str, names: &[String]) -> Result<Expression, FormulaFault> {
    let steps = parse(text, Some(names))?;
    expression(&steps).map_err(|error| whole(text, error))
}

/// The steps of a text. Names stand for variables, or there is t alone.
fn parse(text: &str, names: Option<&[String]>) -> Result<Vec<FormulaStep>, FormulaFault> {
    let mut parser = Parser { text, names, next: 0, steps: Vec::new(), depth: 0 };
    if parser.peek().is_none() {
        return Err(FormulaFault { problem: FormulaProblem::Empty, at: 0..text.len() });
    }
    parser.expression(0)?;
    if parser.peek().is_some() {
        return Err(parser.unexpected(AN_OPERATOR));
    }
    Ok(parser.steps)
}

/// What is wrong with a formula as a whole.
fn whole(text: &str, error: FormulaError) -> FormulaFault {
    let problem = match error {
        FormulaError::TooLong { .. } => FormulaProblem::TooLong,
        _ => FormulaProblem::TooDeep,
    };
    FormulaFault { problem, at: 0..text.len() }
}

/// Reads a formula of a scenario or a table; a mistake is placed within its text.
pub(super) fn formula(text: &At<String>) -> Result<Formula, Fault> {
    parse_formula(&text.value).map_err(|fault| placed(text, fault))
}

/// Reads a formula in variables; a mistake is placed within its text.
pub(super) fn formula_in(text: &At<String>, names: &[String]) -> Result<Expression, Fault> {
    parse_expression(&text.value, names).map_err(|fault| placed(text, fault))
}

/// The place of a mistake in the file.
fn placed(text: &At<String>, FormulaFault { problem, at }: FormulaFault) -> Fault {
    // Quotation marks stand around the text; where it is written with escapes its bytes are not those of the file.
    let marks = text.span.len().checked_sub(text.value.len());
    let place = match marks {
        Some(marks @ (0 | 2 | 6)) => {
            let start = text.span.start + marks / 2;
            start + at.start..start + at.end
        }
        _ => text.span.clone(),
    };
    Fault::new(ValueProblem::Formula(problem)).at(&place)
}

struct Parser<'a> {
    text: &'a str,
    /// Names of variables, where there is no t.
    names: Option<&'a [String]>,
    /// The byte to go on from.
    next: usize,
    steps: Vec<FormulaStep>,
    depth: usize,
}

/// How tightly operators bind: to the left, and to the right.
fn binding(operator: char) -> Option<(u8, u8, FormulaStep)> {
    Some(match operator {
        '+' => (1, 2, FormulaStep::Add),
        '-' => (1, 2, FormulaStep::Subtract),
        '*' => (3, 4, FormulaStep::Multiply),
        '/' => (3, 4, FormulaStep::Divide),
        // To the right first: 2^3^2 is 2^9. The exponent replaces this step's number.
        '^' => (8, 7, FormulaStep::Power(1.0)),
        _ => return None,
    })
}

/// A sign binds more tightly than a product and less than a power: −t² is −(t²).
const SIGN: u8 = 5;

impl Parser<'_> {
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
            let step = if operator == '^' { self.exponent(operand, at + 1)? } else { step };
            self.push(step)?;
        }
        self.depth -= 1;
        Ok(())
    }

    /// Takes the steps from `first` on, which were written after byte `from`, back as a constant exponent.
    fn exponent(&mut self, first: usize, from: usize) -> Result<FormulaStep, FormulaFault> {
        let at = from + (self.text[from..].len() - self.text[from..].trim_start().len())..self.next;
        let varies = self.steps[first..].iter().find_map(|step| match step {
            FormulaStep::Time => Some("t"),
            FormulaStep::Variable(k) => self.names.and_then(|names| names.get(*k)).map(String::as_str),
            _ => None,
        });
        if let Some(of) = varies {
            return Err(self.fault(FormulaProblem::VaryingExponent { of: of.to_owned() }, at));
        }
        let exponent = Formula::new(self.steps.split_off(first)).map(|formula| formula.eval(0.0));
        match exponent {
            Ok(exponent) if exponent.abs() <= LARGEST => Ok(FormulaStep::Power(exponent)),
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
                self.push(FormulaStep::Negate)
            }
            Some('+') => {
                self.next += 1;
                self.expression(SIGN)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(at),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(at),
            _ => Err(self.unexpected(self.a_value())),
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
        match written.parse::<f64>() {
            Ok(value) if value <= LARGEST => self.push(FormulaStep::Number(value)),
            Ok(_) => Err(self.fault(FormulaProblem::NumberTooLarge { found: written.into() }, at..self.next)),
            Err(_) => {
                let problem = FormulaProblem::Expected { found: quoted(written), expected: self.a_value() };
                Err(self.fault(problem, at..self.next))
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
        let find = |list: &[(&'static str, FormulaStep)]| list.iter().copied().find(|(known, _)| *known == name);
        if JUMPS.contains(&name) {
            return Err(self.fault(FormulaProblem::Jumps { name: name.into() }, place));
        }
        let variable = self.names.and_then(|names| names.iter().position(|known| known == name));
        let constant = find(&NAMES).filter(|(_, step)| self.names.is_none() || *step != FormulaStep::Time);
        if let Some(step) = variable.map(FormulaStep::Variable).or(constant.map(|(_, step)| step)) {
            return if called { Err(self.unexpected(AN_OPERATOR)) } else { self.push(step) };
        }
        let one = find(&FUNCTIONS);
        let Some((name, step)) = one.or_else(|| find(&CHOICES)) else {
            let name = name.to_owned();
            let problem = match self.names {
                _ if called => FormulaProblem::UnknownFunction { name },
                None => FormulaProblem::UnknownName { name },
                Some(names) => FormulaProblem::UnknownVariable { name, names: names.to_vec() },
            };
            return Err(self.fault(problem, place));
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
                    self.push(step)?;
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

    /// What a value may be.
    fn a_value(&self) -> &'static str {
        if self.names.is_some() { A_VALUE_OF_VARIABLES } else { A_VALUE }
    }

    fn push(&mut self, step: FormulaStep) -> Result<(), FormulaFault> {
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use forwardstep_core::expression::Binary::Multiply;
    use forwardstep_core::expression::Step;

    use super::*;
    use std::f64::consts::E;

    fn value(text: &str, t: f64) -> f64 {
        parse_formula(text).unwrap_or_else(|error| panic!("{text}: {error}")).eval(t)
    }

    #[test]
    fn operators_bind_as_on_paper() {
        for (text, wanted) in [
            ("1 + 2*3", 7.0),
            ("(1 + 2)*3", 9.0),
            ("10 - 4 - 3", 3.0),
            ("24/4/2", 3.0),
            ("-t^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("-2*-t", 4.0),
            ("+t - -t", 4.0),
            ("4^0.5", 2.0),
            ("t^(1+1)", 4.0),
            ("1.5e1 + .5 + 2.", 17.5),
            ("2e0*e", 2.0 * E),
            ("min(3, t, 7) + max(1, 0)", 3.0),
            ("sqrt(abs(-9))", 3.0),
            ("  exp ( 0 )  ", 1.0),
            ("cos(2*pi*t)", 1.0),
        ] {
            assert_eq!(value(text, 2.0), wanted, "{text}");
        }
    }

    #[test]
    fn mistakes_have_their_place() {
        let cases = [
            ("", 0..0, "the formula is empty"),
            ("  ", 0..2, "the formula is empty"),
            ("1 +", 3..3, "found its end in a formula where a number, `t`, a function or a parenthesis should stand"),
            ("2t", 1..2, "found \"t\" in a formula where an operator (+ - * / ^) or the end should stand"),
            ("2 (t)", 2..3, "found \"(\" in a formula where an operator (+ - * / ^) or the end should stand"),
            ("pi(t)", 2..3, "found \"(\" in a formula where an operator (+ - * / ^) or the end should stand"),
            ("(1 + t", 0..1, "this parenthesis is not closed"),
            ("sin(t", 3..4, "this parenthesis is not closed"),
            (
                "(1, t)",
                2..3,
                "found \",\" in a formula where an operator (+ - * / ^) or a closing parenthesis should stand",
            ),
            ("1)", 1..2, "found \")\" in a formula where an operator (+ - * / ^) or the end should stand"),
            ("sn(t)", 0..2, "there is no function `sn`"),
            ("2*time", 2..6, "there is no `time` in a formula"),
            ("sin", 0..3, "the function `sin` has no argument"),
            ("sin()", 0..5, "`sin` takes one argument, but has 0"),
            ("1 + sin(t, 2)", 4..13, "`sin` takes one argument, but has 2"),
            ("max(t)", 0..6, "`max` takes two arguments or more, but has 1"),
            ("min()", 0..5, "`min` takes two arguments or more, but has 0"),
            ("floor(t)", 0..5, "`floor` jumps, but formulas are continuous"),
            ("t < 3", 2..3, "`<` jumps, but formulas are continuous"),
            ("t**2", 1..3, "found \"**\" in a formula where one operator should stand"),
            ("2^ t", 3..4, "the exponent changes with t"),
            ("2^(1/0)", 2..7, "the exponent has no finite value"),
            ("1e31*t", 0..4, "1e31 is too large a number"),
            (".", 0..1, "found \".\" in a formula where a number, `t`, a function or a parenthesis should stand"),
            ("1 + é", 4..6, "there is no `é` in a formula"),
        ];
        for (text, at, message) in cases {
            let fault = parse_formula(text).unwrap_err();
            assert_eq!((fault.at, fault.problem.to_string().as_str()), (at, message), "{text}");
        }
    }

    #[test]
    fn formulas_in_variables_know_their_names_only() {
        let names = ["x".to_owned(), "dx".to_owned()];
        let steps = |text: &str| parse_expression(text, &names).unwrap().steps().to_vec();
        assert_eq!(steps("x^2*dx"), [Step::Variable(0), Step::Power(2.0), Step::Variable(1), Step::Binary(Multiply)]);
        let fault = |text: &str| parse_expression(text, &names).unwrap_err();
        assert_eq!(fault("x + t").at, 4..5);
        assert_eq!(fault("x + t").problem.to_string(), "there is no `t` in this formula");
        assert!(fault("x + d2x").problem.help().unwrap().starts_with("did you mean `dx`?"));
        assert_eq!(fault("2^x").problem, FormulaProblem::VaryingExponent { of: "x".into() });
        let message = "found its end in a formula where a number, a variable, a function or a parenthesis should stand";
        assert_eq!(fault("x +").problem.to_string(), message);
    }

    #[test]
    fn helps_say_what_to_write() {
        let help = |text: &str| parse_formula(text).unwrap_err().problem.help().unwrap_or_default();
        assert!(help("sine(t)").starts_with("did you mean `sin`? the functions are"), "{}", help("sine(t)"));
        assert!(help("2*T").starts_with("did you mean `t`?"), "{}", help("2*T"));
        assert_eq!(help("2t"), "products are written with a star: `2*pi`, `3*(pi + 1)`");
        assert_eq!(help("t**2"), "powers are written `2^3`");
        assert!(help("sign(t)").contains("delay.piecewise_constant"));
    }

    #[test]
    fn no_nesting_is_too_much_for_the_stack() {
        for text in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000), "sin(".repeat(100_000)] {
            assert_eq!(parse_formula(&text).unwrap_err().problem, FormulaProblem::TooDeep);
        }
        let long = format!("1{}", " + t".repeat(100_000));
        assert_eq!(parse_formula(&long).unwrap_err().problem, FormulaProblem::TooLong);
        // Numbers that wait: each parenthesis leaves one behind.
        let waiting = format!("{}1{}", "1 + (".repeat(40), ")".repeat(40));
        assert_eq!(parse_formula(&waiting).unwrap_err().problem, FormulaProblem::TooDeep);
    }

    proptest! {
        #[test]
        fn prop_any_text_gives_a_formula_or_a_place(
            pieces in prop::collection::vec(
                prop::sample::select(vec![
                    "1", ".5", "e", "E", "1e", "+", "-", "*", "/", "^", "(", ")", ",", " ", "t", "pi", "sin", "max(", "é",
                    "<", "\u{3000}", "1e999", "_",
                ]),
                0..30,
            ),
        ) {
            let text = pieces.concat();
            match parse_formula(&text) {
                Ok(formula) => { let _ = formula.eval(1.0); }
                Err(fault) => prop_assert!(text.get(fault.at.clone()).is_some(), "{:?} {:?}", text, fault),
            }
        }
    }
}
