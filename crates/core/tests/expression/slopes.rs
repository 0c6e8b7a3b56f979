//! Derivatives: jets, graphs, differences and closed forms.

use super::*;

/// Value and derivatives by the rules of the graph.
fn by_graph(expression: &Expression, at: f64) -> Vec<f64> {
    let mut graph = Graph::new(1);
    let mut nodes = vec![graph.import(expression).unwrap()];
    for k in 0..4 {
        nodes.push(graph.derivative(nodes[k], 0).unwrap());
    }
    let tape = Tape::new(&graph, &nodes).unwrap();
    let mut out = vec![0.0; 5];
    tape.evaluate(&[at], &mut tape.workspace(), &mut out).unwrap();
    out
}

/// Central differences of each derivative give the next.
fn agrees_with_differences(expression: &Expression, at: f64) {
    let h = 1e-5;
    let (before, here, after) = (expression.jet(at - h), expression.jet(at), expression.jet(at + h));
    for k in 0..4 {
        let slope = (after[k] - before[k]) / (2.0 * h);
        assert!(close(here[k + 1], slope, 1e-6), "{expression:?} at {at}, {}: {} {slope}", k + 1, here[k + 1]);
    }
}

#[test]
fn derivatives_are_those_of_the_closed_forms() {
    for t in [0.3_f64, 1.7, 4.0] {
        let (s, c) = t.sin_cos();
        let e = (-t).exp();
        let h = t.tanh();
        let d = 1.0 - h * h;
        let a = 1.0 + t * t;
        let root = |power: f64| t.powf(power);
        let cases = [
            (x().sin_of(), [s, c, -s, -c, s]),
            (x().cos_of(), [c, -s, -c, s, c]),
            ((-x()).exp_of(), [e, -e, e, -e, e]),
            (x().power(3.0), [t.powi(3), 3.0 * t * t, 6.0 * t, 6.0, 0.0]),
            (x().log_of(), [t.ln(), 1.0 / t, -t.powi(-2), 2.0 * t.powi(-3), -6.0 * t.powi(-4)]),
            (x().sqrt_of(), [t.sqrt(), 0.5 * root(-0.5), -0.25 * root(-1.5), 0.375 * root(-2.5), -0.9375 * root(-3.5)]),
            (x().power(1.5), [root(1.5), 1.5 * root(0.5), 0.75 * root(-0.5), -0.375 * root(-1.5), 0.5625 * root(-2.5)]),
            (
                Expression::number(1.0) / x(),
                [1.0 / t, -t.powi(-2), 2.0 * t.powi(-3), -6.0 * t.powi(-4), 24.0 * t.powi(-5)],
            ),
            (x().tanh_of(), [h, d, -2.0 * h * d, d * (6.0 * h * h - 2.0), h * d * (16.0 - 24.0 * h * h)]),
            (
                x().atan_of(),
                [
                    t.atan(),
                    1.0 / a,
                    -2.0 * t / (a * a),
                    (6.0 * t * t - 2.0) / (a * a * a),
                    24.0 * t * (1.0 - t * t) / (a * a * a * a),
                ],
            ),
            (x().sin_of() * (-x()).exp_of(), [s * e, (c - s) * e, -2.0 * c * e, 2.0 * (s + c) * e, -4.0 * s * e]),
        ];
        for (expression, want) in cases {
            for got in [expression.jet(t).to_vec(), by_graph(&expression, t)] {
                assert!(got.iter().zip(want).all(|(g, w)| close(*g, w, 1e-12)), "{expression:?} {got:?} {want:?}");
            }
        }
    }
}

#[test]
fn derivatives_of_every_function_agree_with_differences() {
    let inner = || (x() * 0.7).sin_of() + 2.5;
    for step in [smooth(), vec![Step::Unary(Abs)], powers(&[0.0, 1.0, -2.0])].concat() {
        for t in [0.4, 2.0, 5.5] {
            agrees_with_differences(&then(inner(), step.clone()), t);
        }
    }
    for function in [Add, Subtract, Multiply, Divide, Min, Max] {
        agrees_with_differences(&both(inner(), x().cos_of(), function), 1.3);
        agrees_with_differences(&both(x().cos_of(), inner(), function), 1.3);
    }
}

#[test]
fn a_derivative_that_does_not_exist_leaves_those_below_it_alone() {
    // t^3.5 has three derivatives at zero.
    let f = Expression::variable(0).power(3.5) * 2.0;
    let jet = f.jet(0.0);
    assert!(jet[..4].iter().all(|c| *c == 0.0) && !jet[4].is_finite(), "{jet:?}");
    for k in 0..5 {
        let weights: [f64; 5] = std::array::from_fn(|order| f64::from(u8::from(order == k)));
        assert_eq!(f.bounds_of_derivatives(&weights, 0.0, 2.0).is_finite(), k < 4, "{k}");
    }
}

#[test]
fn a_constant_stays_one_where_a_function_has_no_slope() {
    assert_eq!(Expression::number(0.0).sqrt_of().jet(1.0), [0.0; 5]);
    assert_eq!(Expression::number(0.0).sqrt_of().enclose_jet(Interval::point(1.0)), [Interval::point(0.0); 5]);
}

#[test]
fn where_branches_change_a_slope_is_enclosed_and_nothing_more() {
    let corner = (x() - 1.0).abs_of();
    let around = corner.enclose_jet(Interval { low: 0.5, high: 2.0 });
    assert_eq!(around[..2], [Interval { low: 0.0, high: 1.0 }, Interval { low: -1.0, high: 1.0 }]);
    assert_eq!(around[2..], [Interval::WHOLE; 3]);
    assert_eq!(corner.enclose_jet(Interval { low: 0.5, high: 0.9 })[1], Interval::point(-1.0));
    // The corner itself belongs to neither side: cutting there shows nothing.
    assert_eq!(corner.enclose_jet(Interval { low: 0.5, high: 1.0 })[1], Interval { low: -1.0, high: 1.0 });
    assert!(!corner.bounds_of_derivatives(&[0.0, 0.0, 1.0, 0.0, 0.0], 0.0, 2.0).is_finite());
    let lower = x().smaller(1.0);
    assert_eq!(lower.enclose_jet(Interval { low: 0.0, high: 0.9 })[1], Interval::point(1.0));
    assert_eq!(lower.enclose_jet(Interval { low: 1.1, high: 2.0 })[1], Interval::point(0.0));
    assert_eq!(lower.enclose_jet(Interval { low: 0.0, high: 2.0 })[1], Interval { low: 0.0, high: 1.0 });
}

proptest! {
    #[test]
    fn prop_jets_and_graphs_have_the_same_derivatives(expression in any_smooth(), at in 0.0..5.0_f64) {
        let (jet, graph) = (expression.jet(at), by_graph(&expression, at));
        let bounds = expression.enclose_jet(Interval::point(at));
        for k in 0..5 {
            // How much cancels in the formula is what its enclosure shows.
            let width = bounds[k].high - bounds[k].low;
            if width.is_finite() && bounds.iter().all(|c| c.size() < 1e6) {
                let room = 1e-7 * (1.0 + graph[k].abs()) + 1e3 * width;
                prop_assert!((jet[k] - graph[k]).abs() <= room, "{} {:?} {:?}", k, jet, graph);
            }
        }
    }
}
