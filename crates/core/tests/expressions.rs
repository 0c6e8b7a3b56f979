//! Derivatives of expressions, function by function, against closed forms.

use forwardstep_core::expression::{Binary, Expression, ExpressionError, Graph, Step, Tape, Unary};

fn unary(function: Unary, of: &[Step]) -> Expression {
    Expression::new([of, &[Step::Unary(function)]].concat()).unwrap()
}

/// The value of an expression in x and y with its first and second derivative by `by`.
fn derivatives(expression: &Expression, by: usize, at: [f64; 2]) -> [f64; 3] {
    let mut graph = Graph::new(2);
    let value = graph.import(expression).unwrap();
    let first = graph.derivative(value, by).unwrap();
    let second = graph.derivative(first, by).unwrap();
    let tape = Tape::new(&graph, &[value, first, second]).unwrap();
    let mut out = [0.0; 3];
    tape.evaluate(&at, &mut tape.workspace(), &mut out).unwrap();
    out
}

fn close(got: [f64; 3], want: [f64; 3], what: &str) {
    for (got, want) in got.iter().zip(want) {
        assert!((got - want).abs() < 1e-12 * (1.0 + want.abs()), "{what}: {got} is not {want}");
    }
}

/// f, f′ and f″ of every function of one number.
fn closed_form(function: Unary, a: f64) -> [f64; 3] {
    match function {
        Unary::Negate => [-a, -1.0, 0.0],
        Unary::Sin => [a.sin(), a.cos(), -a.sin()],
        Unary::Cos => [a.cos(), -a.sin(), -a.cos()],
        Unary::Exp => [a.exp(); 3],
        Unary::Log => [a.ln(), 1.0 / a, -1.0 / (a * a)],
        Unary::Sqrt => [a.sqrt(), 0.5 / a.sqrt(), -0.25 / (a * a.sqrt())],
        Unary::Tanh => {
            let u = a.tanh();
            [u, 1.0 - u * u, -2.0 * u * (1.0 - u * u)]
        }
        Unary::Atan => [a.atan(), 1.0 / (1.0 + a * a), -2.0 * a / (1.0 + a * a).powi(2)],
        Unary::Abs => [a.abs(), a.signum(), 0.0],
    }
}

const SMOOTH: [Unary; 8] =
    [Unary::Negate, Unary::Sin, Unary::Cos, Unary::Exp, Unary::Log, Unary::Sqrt, Unary::Tanh, Unary::Atan];

#[test]
fn derivatives_of_every_function_are_their_closed_forms() {
    for function in SMOOTH {
        for x in [0.3, 0.9, 2.7] {
            let own = derivatives(&unary(function, &[Step::Variable(0)]), 0, [x, 5.0]);
            close(own, closed_form(function, x), &format!("{function:?} at {x}"));
            // Nothing of it by another variable.
            close(derivatives(&unary(function, &[Step::Variable(0)]), 1, [x, 5.0]), [own[0], 0.0, 0.0], "by y");
            // f(3 x + y): by the chain rule 3 f′ and 9 f″.
            let inner =
                [Step::Number(3.0.into()), Step::Variable(0), Step::Binary(Binary::Multiply), Step::Variable(1)];
            let inner = [&inner[..], &[Step::Binary(Binary::Add)]].concat();
            let [f, d, dd] = closed_form(function, 3.0 * x + 0.4);
            close(derivatives(&unary(function, &inner), 0, [x, 0.4]), [f, 3.0 * d, 9.0 * dd], &format!("{function:?}"));
        }
    }
}

#[test]
fn derivatives_of_powers_and_of_two_numbers_are_their_closed_forms() {
    let (x, y) = (1.7_f64, -0.6_f64);
    for c in [2.0, 3.0, -1.0, -2.5, 0.5, 1.7] {
        let want = [x.powf(c), c * x.powf(c - 1.0), c * (c - 1.0) * x.powf(c - 2.0)];
        close(derivatives(&Expression::variable(0).power(c), 0, [x, y]), want, &format!("x^{c}"));
    }
    let [a, b] = [Expression::variable(0).power(2.0), Expression::variable(0) * Expression::variable(1)];
    // a = x², b = x y.
    let all = [
        (a.clone() + b.clone(), [x * x + x * y, 2.0 * x + y, 2.0], [x * x + x * y, x, 0.0]),
        (a.clone() - b.clone(), [x * x - x * y, 2.0 * x - y, 2.0], [x * x - x * y, -x, 0.0]),
        (a.clone() * b.clone(), [x.powi(3) * y, 3.0 * x * x * y, 6.0 * x * y], [x.powi(3) * y, x.powi(3), 0.0]),
        (a.clone() / b.clone(), [x / y, 1.0 / y, 0.0], [x / y, -x / (y * y), 2.0 * x / y.powi(3)]),
        (b / a, [y / x, -y / (x * x), 2.0 * y / x.powi(3)], [y / x, 1.0 / x, 0.0]),
    ];
    for (expression, by_x, by_y) in all {
        close(derivatives(&expression, 0, [x, y]), by_x, "by x");
        close(derivatives(&expression, 1, [x, y]), by_y, "by y");
    }
}

#[test]
fn functions_with_a_kink_have_a_derivative_only_where_nothing_varies() {
    let kinked = |steps: &[Step]| {
        let mut graph = Graph::new(2);
        let value = graph.import(&Expression::new(steps.to_vec()).unwrap()).unwrap();
        [0, 1].map(|by| graph.derivative(value, by).err())
    };
    let x = Step::Variable(0);
    let not = |function| [Some(ExpressionError::NotSmooth { function }), None];
    assert_eq!(kinked(&[x.clone(), Step::Unary(Unary::Abs)]), not("abs"));
    assert_eq!(kinked(&[x.clone(), Step::Number(1.0.into()), Step::Binary(Binary::Min)]), not("min"));
    assert_eq!(kinked(&[Step::Number(1.0.into()), x.clone(), Step::Binary(Binary::Max)]), not("max"));
}
