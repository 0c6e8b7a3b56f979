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
fn regress_what_has_no_value_has_no_derivatives() {
    for nowhere in [(-x()).log_of(), (-x()).sqrt_of() * 2.0, (-x()).power(0.5) + 1.0] {
        assert!(nowhere.jet(1.5).iter().chain(&long(&nowhere, 12, 1.5)).all(|value| value.is_nan()), "{nowhere:?}");
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
                let room = |size: f64| 1e-7 * (1.0 + size.abs()) + 1e3 * width;
                if graph[k].is_nan() {
                    // Infinity times zero on the way, as of the root of what is zero for ever: the enclosure knows better.
                    let near = room(jet[k]);
                    prop_assert!(bounds[k].low - near <= jet[k] && jet[k] <= bounds[k].high + near, "{} {:?}", k, jet);
                } else {
                    prop_assert!((jet[k] - graph[k]).abs() <= room(graph[k]), "{} {:?} {:?}", k, jet, graph);
                }
            }
        }
    }
}

/// The value and `count` − 1 derivatives.
fn long(expression: &Expression, count: usize, at: f64) -> Vec<f64> {
    let mut jet = vec![0.0; count];
    expression.derivatives(at, &mut jet);
    jet
}

#[test]
fn derivatives_of_any_order_are_those_of_the_closed_forms() {
    let alternating = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let factorial = |k: usize| (1..=k).map(|j| j as f64).product::<f64>();
    for count in [6, 9, 10, 17, 18, 33, 34, 65, 66, 120] {
        let at = 0.7_f64;
        let (waves, rises) = (long(&(x() * 2.0).sin_of(), count, at), long(&(x() * -0.5).exp_of(), count, at));
        let (parts, logs) = (long(&(Expression::number(1.0) / x()), count, at), long(&x().log_of(), count, at));
        let roots = long(&x().sqrt_of(), count, at);
        let mut root = at.sqrt();
        for k in 0..count {
            let wave = 2.0_f64.powi(k as i32) * (1.4 + k as f64 * std::f64::consts::FRAC_PI_2).sin();
            assert!((waves[k] - wave).abs() < 1e-12 * 2.0_f64.powi(k as i32), "{k}: {} {wave}", waves[k]);
            assert!(close(rises[k], (-0.5_f64).powi(k as i32) * (-0.35_f64).exp(), 1e-12), "{k}");
            let part = alternating(k) * factorial(k) / at.powi(k as i32 + 1);
            assert!(close(parts[k] / part, 1.0, 1e-11), "{k}: {} {part}", parts[k]);
            if k > 0 {
                let log = alternating(k - 1) * factorial(k - 1) / at.powi(k as i32);
                assert!(close(logs[k] / log, 1.0, 1e-11), "{k}: {} {log}", logs[k]);
            }
            assert!(close(roots[k] / root, 1.0, 1e-11), "{k}: {} {root}", roots[k]);
            root *= (0.5 - k as f64) / at;
        }
    }
}

#[test]
fn derivatives_of_any_order_of_tangents_at_zero_are_known_integers() {
    let tangents = [0.0, 1.0, 0.0, -2.0, 0.0, 16.0, 0.0, -272.0, 0.0, 7936.0, 0.0, -353_792.0, 0.0, 22_368_256.0];
    let found = long(&x().tanh_of(), tangents.len(), 0.0);
    found.iter().zip(tangents).for_each(|(found, known)| assert!(close(*found, known, 1e-12), "{found} {known}"));
    // (2k)! (−1)ᵏ of every odd one.
    let found = long(&x().atan_of(), 20, 0.0);
    for (k, found) in found.iter().enumerate() {
        let sign = if k % 4 == 1 { 1.0 } else { -1.0 };
        let known = if k.is_multiple_of(2) { 0.0 } else { sign * (1..k).map(|j| j as f64).product::<f64>() };
        assert!((found - known).abs() <= 1e-9 * known.abs().max(1.0), "{k}: {found} {known}");
    }
}

#[test]
fn no_derivative_is_given_where_there_are_none_and_a_kink_has_only_the_first() {
    assert!(long(&x(), 140, 1.0)[129..].iter().all(|value| value.is_nan()));
    let mut within = [Interval::point(0.0); 8];
    x().abs_of().enclose_derivatives(Interval { low: -1.0, high: 1.0 }, &mut within);
    assert_eq!((within[1], within[5]), (Interval { low: -1.0, high: 1.0 }, Interval::WHOLE));
}

proptest! {
    #[test]
    fn prop_more_derivatives_leave_the_first_five_as_they_are(expression in any_expression(), at in -3.0..3.0_f64) {
        let five = expression.jet(at);
        for count in [9, 17, 33] {
            let more = long(&expression, count, at);
            // As numbers: of what cancels exactly up to the fourth derivative, and not beyond, zeros differ in their sign.
            let same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
            prop_assert!(more.iter().zip(&five).all(same), "{:?}", expression);
        }
    }

    #[test]
    fn prop_derivatives_up_to_the_ninth_are_those_of_the_graph_and_enclosed(expression in any_smooth(), at in 0.2..2.0_f64) {
        let mut graph = Graph::new(1);
        let mut nodes = vec![graph.import(&expression).unwrap()];
        for k in 0..9 {
            match graph.derivative(nodes[k], 0) {
                Ok(node) => nodes.push(node),
                Err(_) => return Ok(()),
            }
        }
        let Ok(tape) = Tape::new(&graph, &nodes) else { return Ok(()) };
        let mut out = vec![0.0; 10];
        tape.evaluate(&[at], &mut tape.workspace(), &mut out).unwrap();
        let found = long(&expression, 10, at);
        let mut within = [Interval::WHOLE; 10];
        expression.enclose_derivatives(Interval::point(at), &mut within);
        for k in 0..10 {
            let size = out[..=k].iter().fold(1.0_f64, |size, value| size.max(value.abs()));
            // The graph drops what is multiplied by zero, even where that has no value. What cancels on the way shows in the width of
            // what encloses it.
            if out[k].is_finite() && within[k].is_finite() && found[..2].iter().all(|value| value.is_finite()) {
                let room = 1e3 * (within[k].high - within[k].low) + 1e-9 * size;
                prop_assert!((found[k] - out[k]).abs() < room, "{:?} {}: {} {}", expression, k, found[k], out[k]);
            }
            if found[k].is_finite() && within[k].is_finite() {
                let room = 1e-9 * found[..=k].iter().fold(1.0_f64, |size, value| size.max(value.abs()));
                prop_assert!(within[k].low - room <= found[k] && found[k] <= within[k].high + room, "{:?} {}", expression, k);
            }
        }
    }
}
