//! Expressions: the algebras against each other, and against numbers from elsewhere.

mod domains;
mod enclosures;
mod for_ever;
mod graphs;
mod kinks;
mod slopes;
mod values;

use forwardstep_core::expression::Binary::{Add, Divide, Max, Min, Multiply, Subtract};
use forwardstep_core::expression::Unary::{Abs, Atan, Cos, Exp, Log, Negate, Sin, Sqrt, Tanh};
use forwardstep_core::expression::*;
use proptest::prelude::*;

fn x() -> Expression {
    Expression::variable(0)
}

/// A constant as it would be read from a text.
fn written(text: &str) -> Expression {
    Expression::number(Number::decimal(text).unwrap())
}

/// The same with one more step.
fn then(inner: Expression, step: Step) -> Expression {
    Expression::new([inner.steps(), &[step]].concat()).unwrap()
}

fn both(a: Expression, b: Expression, function: Binary) -> Expression {
    Expression::new([a.steps(), b.steps(), &[Step::Binary(function)]].concat()).unwrap()
}

fn close(got: f64, want: f64, tolerance: f64) -> bool {
    got == want || got.is_nan() && want.is_nan() || (got - want).abs() <= tolerance * (1.0 + want.abs())
}

/// Decimals as they are written, most of which are no `f64`.
fn any_decimal() -> impl Strategy<Value = Number> {
    (0..3000_u32, 0..4_u32).prop_map(|(digits, places)| Number::decimal(&format!("{digits}e-{places}")).unwrap())
}

/// Any expression in x made of these functions.
fn any_of(unary: Vec<Step>, binary: Vec<Binary>) -> impl Strategy<Value = Expression> {
    let leaf = prop_oneof![
        Just(vec![Step::Variable(0)]),
        any_decimal().prop_map(|number| vec![Step::Number(number)]),
        (-3.0..3.0_f64).prop_map(|value| vec![Step::Number(value.into())]),
    ];
    let tree = leaf.prop_recursive(5, 40, 2, move |inner| {
        prop_oneof![
            (inner.clone(), prop::sample::select(unary.clone())).prop_map(|(mut a, f)| {
                a.push(f);
                a
            }),
            (inner.clone(), inner, prop::sample::select(binary.clone())).prop_map(|(mut a, b, f)| {
                a.extend(b);
                a.push(Step::Binary(f));
                a
            }),
        ]
    });
    tree.prop_map(|steps| Expression::new(steps).unwrap())
}

fn powers(exponents: &[f64]) -> Vec<Step> {
    exponents.iter().map(|exponent| Step::Power((*exponent).into())).collect()
}

/// Functions without a kink.
fn smooth() -> Vec<Step> {
    let third = Step::Power((written("1") / written("3")).constant().unwrap());
    let unary = [Negate, Sin, Cos, Exp, Log, Sqrt, Tanh, Atan].map(Step::Unary).to_vec();
    [unary, powers(&[2.0, 3.0, -1.0, -2.0, 0.5, 1.7]), vec![third]].concat()
}

fn any_smooth() -> impl Strategy<Value = Expression> {
    any_of(smooth(), vec![Add, Subtract, Multiply, Divide])
}

fn any_expression() -> impl Strategy<Value = Expression> {
    any_of([smooth(), vec![Step::Unary(Abs)]].concat(), vec![Add, Subtract, Multiply, Divide, Min, Max])
}
