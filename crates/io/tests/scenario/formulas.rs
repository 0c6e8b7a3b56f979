//! Formulas as they are written: what they mean, and where their mistakes are.

use std::f64::consts::E;

use forwardstep_core::expression::{Binary, Step};
use forwardstep_io::scenario::formula::{FormulaProblem, parse_expression, parse_formula};
use forwardstep_sim::formula::BoundedFormula;
use proptest::prelude::*;

use super::{changed, read};

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
fn decimals_are_the_numbers_that_are_written() {
    // No f64 is 3/10, and yet this touches zero.
    let swing = parse_formula("0.3 + 0.2*sin(t) + 0.1*sin(t)").unwrap();
    assert_eq!(BoundedFormula::new(swing, 20.0).within().low, 0.0);
    let root = parse_formula("t^(0.1 + 0.2)").unwrap();
    assert_eq!(root, parse_formula("t^0.3").unwrap());
    assert_ne!(root.steps(), [Step::Variable(0), Step::Power(0.3.into())]);
    assert_eq!(value("8^(1/3)", 0.0), 2.0);
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
        ("1e-301*t", 0..6, "1e-301 has too many digits or too small an exponent"),
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
    assert_eq!(
        steps("x^2*dx"),
        [Step::Variable(0), Step::Power(2.0.into()), Step::Variable(1), Step::Binary(Binary::Multiply)]
    );
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
    let waiting = |depth: usize| parse_formula(&format!("{}1{}", "1 + (".repeat(depth), ")".repeat(depth)));
    assert_eq!(waiting(60).unwrap().value(&[0.0]), 61.0);
    let deep = waiting(200).unwrap_err().problem;
    assert_eq!(deep, FormulaProblem::TooDeep);
    assert!(deep.to_string().contains("more than 128") && deep.help().unwrap().contains("calls itself"), "{deep}");
    let terms = |count: usize| parse_formula(&format!("1{}", " + t".repeat(count)));
    assert_eq!(terms(255).unwrap().value(&[2.0]), 511.0);
    let long = terms(256).unwrap_err().problem;
    assert!(long.to_string().contains("more than 512 numbers") && long.help().unwrap().contains("points"), "{long}");
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

#[test]
fn regress_formulas_are_longer_than_names_and_go_over_lines() {
    let terms = " + 0.001*sin(t)".repeat(50);
    let over_lines = terms.replace(" + ", "\n\t+ ");
    for weight in
        [format!("\"1{terms}\""), format!("\"\"\"1{over_lines}\"\"\""), format!("\"\"\"\n1{over_lines}\n\"\"\"")]
    {
        read(&changed("weight = 1.0", &format!("weight = {weight}"))).unwrap_or_else(|error| panic!("{error}"));
    }
    let spaces = format!("weight = \"1{}\"", " ".repeat(10_000));
    let error = read(&changed("weight = 1.0", &spaces)).unwrap_err().to_string();
    assert!(error.starts_with("test.toml:28:10: the formula \"1 ") && error.ends_with("cannot be read"), "{error}");
}

/// What a check knows exactly a run computes so: 0.1 + 0.2 − 0.3 is zero, whatever it is multiplied by.
#[test]
fn regress_numbers_that_cancel_do_so_in_a_run_as_well() {
    let value = |text: &str| parse_formula(text).unwrap().eval(2.0);
    for (text, wanted) in [
        ("(0.1 + 0.2 - 0.3)*1e17*t", 0.0),
        ("1e17*(0.1 + 0.2 - 0.3)", 0.0),
        ("t - (0.3 - 0.1*3)*1e18", 2.0),
        ("-(0.1 + 0.2)*t + 0.6", 0.0),
        ("0.3 - 0.1*3 + 0.5*t", 1.0),
        ("max(0.1 + 0.2, 0.3*t - 0.3)", 0.3),
        ("t^(0.1 + 0.2 - 0.3)", 1.0),
        ("(1/3)*t", 2.0 / 3.0),
        ("sin(0.1 + 0.2 - 0.3 + t)", 2.0_f64.sin()),
        ("2*pi*t", 4.0 * std::f64::consts::PI),
        // What is not rational as a whole has parts that are.
        ("exp((0.1 + 0.2 - 0.3)*1e17)*t", 2.0),
        ("sqrt(2 + (0.1 + 0.2 - 0.3)*1e18)", std::f64::consts::SQRT_2),
        ("0.1^2*100*t", 2.0),
    ] {
        assert_eq!(value(text), wanted, "{text}");
    }
}
