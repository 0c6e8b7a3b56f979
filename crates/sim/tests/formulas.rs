//! Derivatives of formulas in t, function by function.

use forwardstep_core::expression::Binary::{Add, Divide, Multiply};
use forwardstep_core::expression::Step::{Binary, Number, Power, Unary as Of, Variable};
use forwardstep_core::expression::Unary::{Abs, Atan, Cos, Exp, Log, Negate, Sin, Sqrt, Tanh};
use forwardstep_core::expression::{Expression, Interval, Step};

const T: Step = Variable(0);

fn formula(steps: &[Step]) -> Expression {
    Expression::new(steps.to_vec()).unwrap()
}

/// f and its first four derivatives.
fn closed_form(step: &Step, a: f64) -> [f64; 5] {
    let power = |c: f64| {
        let mut factor = 1.0;
        core::array::from_fn(|k| {
            let value = factor * a.powf(c - k as f64);
            factor *= c - k as f64;
            value
        })
    };
    match step {
        Of(Sin) => [a.sin(), a.cos(), -a.sin(), -a.cos(), a.sin()],
        Of(Cos) => [a.cos(), -a.sin(), -a.cos(), a.sin(), a.cos()],
        Of(Exp) => [a.exp(); 5],
        Of(Log) => [a.ln(), 1.0 / a, -1.0 / a.powi(2), 2.0 / a.powi(3), -6.0 / a.powi(4)],
        Of(Sqrt) => power(0.5),
        Power(c) => power(c.value()),
        Of(Tanh) => {
            let u = a.tanh();
            let d = 1.0 - u * u;
            [u, d, -2.0 * u * d, d * (6.0 * u * u - 2.0), d * (16.0 * u - 24.0 * u.powi(3))]
        }
        Of(Atan) => {
            let r = 1.0 + a * a;
            let third = (6.0 * a * a - 2.0) / r.powi(3);
            [a.atan(), 1.0 / r, -2.0 * a / r.powi(2), third, 24.0 * a * (1.0 - a * a) / r.powi(4)]
        }
        Of(Abs) => [a.abs(), a.signum(), 0.0, 0.0, 0.0],
        Of(Negate) => [-a, -1.0, 0.0, 0.0, 0.0],
        _ => [f64::NAN; 5],
    }
}

fn functions() -> Vec<Step> {
    let named = [Sin, Cos, Exp, Log, Sqrt, Tanh, Atan, Abs, Negate].map(Of);
    let powers = [2.0, 3.0, -1.5, 1.7].map(|c| Power(c.into()));
    named.into_iter().chain(powers).collect()
}

fn close(got: f64, want: f64) -> bool {
    (got - want).abs() <= 1e-12 * (1.0 + want.abs())
}

#[test]
fn derivatives_of_every_function_are_their_closed_forms() {
    for step in functions() {
        for t in [0.2, 0.7, 1.9] {
            let own = formula(&[T, step.clone()]).jet(t);
            // f(3 t + 0.5): by the chain rule 3ᵏ f⁽ᵏ⁾.
            let stretched =
                formula(&[Number(3.0.into()), T, Binary(Multiply), Number(0.5.into()), Binary(Add), step.clone()])
                    .jet(t);
            let (plain, inner) = (closed_form(&step, t), closed_form(&step, 3.0 * t + 0.5));
            for k in 0..5 {
                assert!(close(own[k], plain[k]), "{step:?}, derivative {k} at {t}: {} is not {}", own[k], plain[k]);
                let want = 3.0_f64.powi(k as i32) * inner[k];
                assert!(close(stretched[k], want), "{step:?}, derivative {k}: {} is not {want}", stretched[k]);
            }
        }
    }
}

#[test]
fn prop_every_derivative_is_the_difference_of_the_one_before() {
    // A curved argument, so that all coefficients of the composition take part.
    let inner =
        [T, Power(2.0.into()), Number(0.4.into()), Binary(Multiply), T, Binary(Add), Number(0.7.into()), Binary(Add)];
    let h = 1e-4;
    for step in functions() {
        let composed = formula(&[&inner[..], std::slice::from_ref(&step)].concat());
        let product = formula(&[&inner[..], std::slice::from_ref(&step), &inner[..], &[Binary(Multiply)]].concat());
        let quotient = formula(&[&inner[..], std::slice::from_ref(&step), &inner[..], &[Binary(Divide)]].concat());
        for f in [composed, product, quotient] {
            for t in [0.1, 0.6, 1.2] {
                let (here, near, far) = (f.jet(t), f.jet(t + h), f.jet(t - h));
                for k in 1..5 {
                    let slope = (near[k - 1] - far[k - 1]) / (2.0 * h);
                    let size = 1.0 + here.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
                    assert!((here[k] - slope).abs() < 1e-5 * size, "{step:?} {k} at {t}: {} and {slope}", here[k]);
                }
            }
        }
    }
}

#[test]
fn bounds_of_derivatives_are_reached_where_t_appears_once() {
    for function in [Log, Sqrt] {
        let f = formula(&[T, Number(1.0.into()), Binary(Add), Of(function)]);
        let bounds = f.enclose_jet(Interval { low: 0.0, high: 2.0 });
        for k in 0..5 {
            // All of them are monotone.
            let [a, b] = [0.0, 2.0].map(|t| f.jet(t)[k]);
            assert!(
                close(bounds[k].low, a.min(b)) && close(bounds[k].high, a.max(b)),
                "{function:?} {k}: {:?}",
                bounds[k]
            );
        }
    }
}
