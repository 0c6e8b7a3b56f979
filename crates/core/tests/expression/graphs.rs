//! Graphs in several variables, and the tapes made of them.

use super::*;

/// x y² + sin(x y)/(2 + cos x) + tanh(y) e^(−x) + √(1 + x²) + arctan y + log(5 + x y²).
fn example() -> Expression {
    let (x, y) = (Expression::variable(0), Expression::variable(1));
    let first = x.clone() * y.clone().power(2.0);
    let second = (x.clone() * y.clone()).sin_of() / (x.clone().cos_of() + 2.0);
    let third = y.clone().tanh_of() * (-x.clone()).exp_of();
    let fourth = (x.clone().power(2.0) + 1.0).sqrt_of() + y.clone().atan_of();
    let fifth = (x * y.power(2.0) + 5.0).log_of();
    first + second + third + fourth + fifth
}

#[test]
fn prop_derivatives_are_those_of_differences() {
    let mut graph = Graph::new(2);
    let f = graph.import(&example()).unwrap();
    let (fx, fy) = (graph.derivative(f, 0).unwrap(), graph.derivative(f, 1).unwrap());
    let fxy = graph.derivative(fx, 1).unwrap();
    let fyx = graph.derivative(fy, 0).unwrap();
    let tape = Tape::new(&graph, &[f, fx, fy, fxy, fyx]).unwrap();
    let mut workspace = tape.workspace();
    let mut at = |x: f64, y: f64| {
        let mut out = [0.0; 5];
        tape.evaluate(&[x, y], &mut workspace, &mut out).unwrap();
        out
    };
    let h = 1e-5;
    for (x, y) in [(0.3, -1.2), (1.7, 0.4), (-0.9, 2.0)] {
        let here = at(x, y);
        let slope = |up: f64, down: f64| (up - down) / (2.0 * h);
        let (right, left, up, down) = (at(x + h, y), at(x - h, y), at(x, y + h), at(x, y - h));
        assert!((here[1] - slope(right[0], left[0])).abs() < 1e-8);
        assert!((here[2] - slope(up[0], down[0])).abs() < 1e-8);
        assert!((here[3] - slope(up[1], down[1])).abs() < 1e-8);
        assert!((here[3] - here[4]).abs() < 1e-12);
    }
}

#[test]
fn what_has_no_derivative_is_an_error_where_it_varies() {
    let mut graph = Graph::new(2);
    let f = graph.import(&Expression::variable(0).abs_of()).unwrap();
    assert_eq!(graph.derivative(f, 1), Ok(graph.zero()));
    assert_eq!(graph.derivative(f, 0), Err(ExpressionError::NotSmooth { function: "abs" }));
    assert_eq!(graph.derivative(f, 2), Err(ExpressionError::Variable { variable: 2, count: 2 }));
}

#[test]
fn repeated_terms_are_computed_once() {
    let (x, y) = (Expression::variable(0), Expression::variable(1));
    let twice = (x.clone() * y.clone()) + (y * x);
    let mut graph = Graph::new(2);
    let f = graph.import(&twice).unwrap();
    // x, y, their product, and the sum.
    assert_eq!(Tape::new(&graph, &[f]).unwrap().workspace().len(), 4);
}
