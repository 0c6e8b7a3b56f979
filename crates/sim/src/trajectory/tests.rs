use proptest::prelude::*;

use super::*;

fn t() -> Expression {
    Expression::variable(0)
}

fn formula(formula: Expression) -> Trajectory {
    Trajectory::new(vec![Path::Formula(formula)]).unwrap()
}

fn close(got: f64, want: f64, tolerance: f64) -> bool {
    got == want || (got - want).abs() <= tolerance * (1.0 + want.abs())
}

/// Central differences of each derivative give the next.
fn agrees_with_differences(path: &Path, t_s: f64) {
    let h = 1e-5;
    let (before, at, after) = (path.jet(t_s - h), path.jet(t_s), path.jet(t_s + h));
    for k in 0..4 {
        let slope = (after[k] - before[k]) / (2.0 * h);
        assert!(close(at[k + 1], slope, 1e-6), "{path:?} at {t_s}, derivative {}: {} {slope}", k + 1, at[k + 1]);
    }
}

#[test]
fn sinusoids_are_bounded_exactly_for_ever() {
    let wave = |amplitude, rad_per_s, phase_rad| Sinusoid { amplitude, rad_per_s, phase_rad };
    let path = Path::Sinusoids { offset: 0.3, waves: vec![wave(0.5, 2.0, 0.4), wave(-0.2, 3.3, 1.0)] };
    [0.1, 1.9, 7.7].into_iter().for_each(|t| agrees_with_differences(&path, t));
    let trajectory = Trajectory::new(vec![path.clone()]).unwrap();
    for k in 0..5 {
        let size = 0.5 * 2.0_f64.powi(k) + 0.2 * 3.3_f64.powi(k);
        let middle = if k == 0 { 0.3 } else { 0.0 };
        let hull = trajectory.hull(0, k as usize, None);
        assert!(close(hull.high, middle + size, 1e-11) && close(hull.low, middle - size, 1e-11), "{k} {hull:?}");
        // Frequencies without a common measure come as close to it as one likes.
        let seen = trajectory.hull(0, k as usize, Some(200.0));
        assert!(seen.high <= hull.high && seen.high > middle + 0.99 * size, "{k} {seen:?}");
    }
    // α q̇ + q̈ of one wave: a ω √(α² + ω²).
    let one = Trajectory::new(vec![Path::Sinusoids { offset: 9.0, waves: vec![wave(0.5, 2.0, 0.4)] }]).unwrap();
    let size = one.bounds(0, &[0.0, 1.5, 1.0, 0.0, 0.0], None).size();
    assert!(close(size, 0.5 * 2.0 * 6.25_f64.sqrt(), 1e-11), "{size}");
    // Early on only a part of it is seen.
    let part = one.hull(0, 1, Some(0.1)).high;
    assert!(close(part, 0.4_f64.cos(), 1e-5), "{part}");
}

#[test]
fn formulas_are_bounded_where_the_intervals_tell() {
    let swing = formula((t() * 2.0).sin_of() * 0.5);
    for k in 0..5 {
        let hull = swing.hull(0, k, None);
        assert!(close(hull.size(), 0.5 * 2.0_f64.powi(k as i32), 1e-12), "{k} {hull:?}");
    }
    // A ramp is not bounded, its derivatives are.
    let ramp = formula(t() * 0.2 + t().tanh_of());
    assert!(!ramp.hull(0, 0, None).is_finite() && ramp.hull(0, 0, Some(10.0)).is_finite());
    assert!((1..5).all(|k| ramp.hull(0, k, None).is_finite()));
    // The corner of |t − 1| has a slope, but no acceleration.
    let corner = formula((t() - 1.0).abs_of());
    assert_eq!(corner.hull(0, 1, None), Interval { low: -1.0, high: 1.0 });
    assert!(!corner.hull(0, 2, Some(3.0)).is_finite());
    // √t has no slope at 0, whatever is done with it.
    let root = formula(t().sqrt_of().tanh_of());
    assert!(root.hull(0, 0, None).is_finite() && !root.hull(0, 1, Some(3.0)).is_finite());
}

#[test]
fn a_formula_has_the_derivatives_of_the_piece_in_force() {
    let bounce = Path::Formula((t() - 1.0).abs_of().smaller(t() * 0.5));
    let trajectory = Trajectory::new(vec![Path::Spline(bumpy()), bounce.clone(), bounce]).unwrap();
    let mut pieces = Pieces::new(trajectory, 3.0).unwrap();
    let slope = |pieces: &Pieces, t: f64| {
        let mut jets = JetsBuffer::new(3, 4);
        pieces.jets(t, &mut jets);
        assert_eq!(jets.jets().jet(1), jets.jets().jet(2));
        jets.jets().jet(1)[1]
    };
    // t/2 until 2/3, then 1 − t, t − 1 from 1, and t/2 from 2 on; the table begins at 0.5.
    assert_eq!((pieces.next_kink_s(0.0), pieces.next_jump_s(0.6)), (0.5, None));
    let kinks = [2.0 / 3.0, 1.0, 2.0];
    for (kink, slopes) in kinks.into_iter().zip([[0.5, -1.0], [-1.0, 1.0], [1.0, 0.5]]) {
        let at = pieces.next_kink_s(kink - 0.1);
        assert!(close(at, kink, 1e-15) && pieces.next_jump_s(at) == Some(at), "{at} {kink}");
        assert_eq!(slope(&pieces, at), slopes[0]);
        pieces.pass(at);
        assert_eq!((slope(&pieces, at), pieces.next_jump_s(at)), (slopes[1], None));
    }
    let rough = Trajectory::new(vec![Path::Spline(bumpy()), Path::Formula((t() * 1e5).sin_of().abs_of())]).unwrap();
    let error = Pieces::new(rough, 3.0).map(|_| ()).unwrap_err();
    assert_eq!(error, TrajectoryError::Kinks { axis: 1, error: KinkError::TooMany });
}

fn bumpy() -> Spline {
    Spline::new(vec![0.5, 1.0, 1.4, 2.5, 4.0, 4.2], vec![0.0, 1.0, 0.7, -0.4, 0.2, 0.5]).unwrap()
}

#[test]
fn splines_go_through_their_points_and_have_four_continuous_derivatives() {
    let spline = bumpy();
    for (t, value) in spline.times_s().iter().zip(spline.values()) {
        assert!(close(spline.jet(*t)[0], *value, 1e-12));
    }
    for knot in &spline.times_s()[1..5] {
        let (before, after) = (spline.jet(knot - 1e-9), spline.jet(knot + 1e-9));
        for k in 0..5 {
            // The fifth derivative jumps, but is bounded.
            assert!(
                (before[k] - after[k]).abs() < 1e-5 * (1.0 + after[k].abs()),
                "{k} at {knot}: {before:?} {after:?}"
            );
        }
    }
    // The third derivative jumps at the ends, where the fourth has no bound; where nothing moves it has.
    let unit = |k: usize| (0..=k).map(|j| f64::from(j == k)).collect::<Vec<_>>();
    let bounded = |spline: &Spline, k| Path::Spline(spline.clone()).is_bounded(&unit(k));
    assert!(spline.jet(0.5 + 1e-9)[3].abs() > 1.0 && (0..4).all(|k| bounded(&spline, k) == Some(true)));
    assert_eq!(bounded(&spline, 4), None);
    let still = Spline::new(vec![0.0, 1.0, 2.0], vec![3.0; 3]).unwrap();
    assert_eq!([3, 4].map(|k| bounded(&still, k)), [Some(true); 2]);
    // At rest at the ends, and beyond.
    for (inside, outside) in [(0.5 + 1e-9, 0.4), (4.2 - 1e-9, 9.0)] {
        assert!(spline.jet(inside)[1].abs() < 1e-4 && spline.jet(inside)[2].abs() < 1e-4);
        assert_eq!(spline.jet(outside)[1..], [0.0; 4]);
    }
    [0.7, 1.2, 2.0, 3.9].into_iter().for_each(|t| agrees_with_differences(&Path::Spline(spline.clone()), t));
    let trajectory = Trajectory::new(vec![Path::Spline(spline)]).unwrap();
    let pieces = Pieces::new(trajectory, 9.0).unwrap();
    assert_eq!([0.0, 0.5, 4.2].map(|t| pieces.next_kink_s(t)), [0.5, 4.2, f64::INFINITY]);
}

/// Two points from rest to rest: the well-known 10 σ³ − 15 σ⁴ + 6 σ⁵, whose speed is 15/8 of the mean at its middle.
#[test]
fn two_points_give_the_known_polynomial_and_its_exact_bounds() {
    let trajectory = Trajectory::new(vec![Path::Spline(Spline::new(vec![0.0, 2.0], vec![1.0, 4.0]).unwrap())]).unwrap();
    let mut jets = [[0.0; 5]];
    trajectory.jets(0.8, &mut jets);
    let x: f64 = 0.4;
    let want = 1.0 + 3.0 * (10.0 * x.powi(3) - 15.0 * x.powi(4) + 6.0 * x.powi(5));
    assert!(close(jets[0][0], want, 1e-14));
    let speed = trajectory.hull(0, 1, None);
    assert!(close(speed.high, 1.5 * 15.0 / 8.0, 1e-6) && speed.low.abs() < 1e-5, "{speed:?}");
    let jerk = trajectory.hull(0, 3, None);
    assert!(close(jerk.high, 60.0 * 3.0 / 8.0, 1e-6) && close(jerk.low, -30.0 * 3.0 / 8.0, 1e-6), "{jerk:?}");
    // Before its middle the speed rises.
    let half = trajectory.hull(0, 1, Some(0.5)).high;
    trajectory.jets(0.5, &mut jets);
    assert!(close(half, jets[0][1], 1e-5), "{half}");
}

/// Points of a polynomial of degree five that starts and ends at rest give back the polynomial.
#[test]
fn the_curve_through_points_of_a_quintic_is_the_quintic() {
    let q = |x: f64| 10.0 * x.powi(3) - 15.0 * x.powi(4) + 6.0 * x.powi(5);
    let t = vec![0.0, 0.1, 0.35, 0.5, 0.9, 1.0];
    let spline = Spline::new(t.clone(), t.iter().map(|t| q(*t)).collect()).unwrap();
    for k in 0..100 {
        let t = f64::from(k) / 100.0;
        assert!((spline.jet(t)[0] - q(t)).abs() < 1e-12, "{t}");
    }
}

#[test]
fn points_that_make_no_curve_are_refused() {
    assert_eq!(Spline::new(vec![], vec![]), Err(SplineError::Empty));
    assert_eq!(Spline::new(vec![0.0], vec![]), Err(SplineError::Lengths { times: 1, values: 0 }));
    assert_eq!(
        Spline::new(vec![0.0, 1.0, 1.0], vec![0.0; 3]),
        Err(SplineError::Order { row: 3, t_s: 1.0, before_s: 1.0 })
    );
    assert_eq!(
        Spline::new(vec![0.0, 1.0], vec![0.0, f64::INFINITY]),
        Err(SplineError::NotFinite { row: 2, value: f64::INFINITY })
    );
    assert!(matches!(Spline::new(vec![0.0, 1e-300], vec![0.0, 1.0]), Err(SplineError::TooSteep { row: 1 })));
    let twice = Spline::new(vec![0.0, 0.1, 0.2, 0.2 + 1e-10, 0.3], vec![0.0, 1.0, 2.0, 2.5, 3.0]);
    assert!(matches!(twice, Err(SplineError::TooSteep { row: 3 })), "{twice:?}");
    // One point is a constant.
    assert_eq!(Spline::new(vec![3.0], vec![0.7]).unwrap().jet(1.0), [0.7, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(Trajectory::new(vec![]), Err(TrajectoryError::Empty));
}

proptest! {
    #[test]
    fn prop_a_spline_keeps_within_its_bounds(
        steps in prop::collection::vec(0.05..2.0_f64, 1..8),
        values in prop::collection::vec(-2.0..2.0_f64, 9),
        weights in prop::array::uniform5(-1.0..1.0_f64),
        start in -3.0..3.0_f64,
        end in 0.1..12.0_f64,
    ) {
        let mut t = vec![start];
        steps.iter().for_each(|step| t.push(t[t.len() - 1] + step));
        let n = t.len();
        let spline = Spline::new(t, values[..n].to_vec()).unwrap();
        let (for_ever, part) = (spline.bounds(&weights, None), spline.bounds(&weights, Some(end)));
        prop_assert!(part.low >= for_ever.low - 1e-3 * for_ever.size() && part.high <= for_ever.high + 1e-3 * for_ever.size());
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let knots: Vec<f64> = spline.times_s().iter().copied().chain([0.0, end]).collect();
        let near = |t: &f64| [t - 1e-12 * (1.0 + t.abs()), *t, t + 1e-12];
        let all = (0..=2000).map(|k| end * f64::from(k) / 2000.0).chain(knots.iter().flat_map(near));
        for t in all.filter(|t| (0.0..=end).contains(t)) {
            let value = weighted(&weights, &spline.jet(t));
            prop_assert!(part.low <= value && value <= part.high, "{} {:?}", value, part);
            low = low.min(value);
            high = high.max(value);
        }
        prop_assert!(part.high - high <= 0.05 * (part.high - part.low) + 1e-9 + 0.05 * part.size(), "{:?} {} {}", part, low, high);
    }
}

/// cos t passes zero between looks, |cos t| + 0.01 does not reach it, and a wave that grows is nearest to zero at the start.
#[test]
fn a_norm_that_passes_zero_between_two_looks_vanishes() {
    let t = || Expression::variable(0);
    let of = |value: Expression| {
        let zero = || Path::Formula(Expression::number(0.0));
        Trajectory::new(vec![zero(), zero(), zero(), Path::Formula(value)]).unwrap()
    };
    for (rate, end_s) in [(1.0, 60.0), (7.3, 10.0), (0.03, 60.0)] {
        let crossing = of((t() * rate).cos_of()).least_norm(end_s);
        assert!(crossing.vanishes(), "{crossing:?}");
        let turns = crossing.t_s * rate / std::f64::consts::FRAC_PI_2;
        assert!((turns - 1.0).abs() < 1e-6, "the first crossing: {crossing:?}");
    }
    let above = of((t().cos_of() * t().cos_of() + 1e-4).sqrt_of()).least_norm(60.0);
    assert!(!above.vanishes() && (above.norm - 0.01).abs() < 1e-3, "{above:?}");
    // Close to zero, and small for long.
    let close = of((t().cos_of() * t().cos_of() + 1e-12).sqrt_of()).least_norm(60.0);
    assert!(!close.vanishes() && close.norm < 1e-5, "{close:?}");
    assert!(!of((-t()).exp_of()).least_norm(60.0).vanishes());
    let nothing = of(Expression::number(0.0)).least_norm(60.0);
    assert_eq!((nothing.t_s, nothing.vanishes()), (0.0, true));
    let growing = of(t() + 0.5).least_norm(60.0);
    assert_eq!((growing.t_s, growing.norm), (0.0, 0.5));
}

/// Frequencies without a common period, for which interval arithmetic adds the sizes of every term.
#[test]
fn regress_a_formula_of_sines_is_bounded_like_the_waves_that_it_is() {
    let two = || t().sin_of() + (t() * 2.0_f64.sqrt()).sin_of();
    let waves = [1.0, 2.0_f64.sqrt()].map(|rad_per_s| Sinusoid { amplitude: 1.0, rad_per_s, phase_rad: 0.0 });
    let weights = [0.0, 1.0, 1.0];
    let stated = Path::Sinusoids { offset: 0.0, waves: waves.to_vec() }.bounds(&weights, None);
    let size = 2.0_f64.sqrt() + 6.0_f64.sqrt();
    for formula in [two(), (two() * 2.0 - two()) / 1.0, two() + t().cos_of() * 0.5 - t().cos_of() * 0.5 + 7.0] {
        let found = Path::Formula(formula).bounds(&weights, None);
        assert!(close(found.high, size, 1e-9) && close(found.low, -size, 1e-9), "{found:?}");
        assert!(found.high >= size - 1e-12 && close(found.high, stated.high, 1e-9), "{found:?} {stated:?}");
    }
    // sin t + cos t is √2 sin(t + π/4), beside another frequency too.
    let joined = Path::Formula(t().sin_of() + t().cos_of() + (t() * 2.0_f64.sqrt()).sin_of());
    assert!(close(joined.bounds(&[1.0], None).high, 2.0_f64.sqrt() + 1.0, 1e-9));
    // What is no such sum is bounded as before.
    let other = Path::Formula(two() * two());
    assert!(other.bounds(&[1.0], None).high >= 3.9);
}

#[test]
fn a_distance_that_leaves_its_range_after_the_run_has_a_time_with_six_decimals() {
    let wave = Path::Formula((t() * 0.01).sin_of() * 0.9 + 1.0);
    let trajectory = Trajectory::new(vec![wave, Path::Formula(Expression::number(0.0))]).unwrap();
    let range = Interval { low: 0.04, high: 3.24 };
    let found = trajectory.leaves_later(&[0.0, 0.0], range, 20.0).unwrap();
    assert!(found.t_s > 109.4 && found.t_s < 112.0 && found.value > 3.24, "{found:?}");
    assert_eq!((found.t_s * 1e6).round() / 1e6, found.t_s);
    assert_eq!(trajectory.leaves_later(&[0.0, 0.0], Interval { low: 0.0, high: 3.62 }, 20.0), None);
}

/// Turning about an axis keeps the norm of a quaternion; of other ellipses the half of the shorter axis is left.
#[test]
fn own_the_norm_of_what_turns_is_known_for_ever() {
    let wave = |amplitude, phase_rad| Sinusoid { amplitude, rad_per_s: 0.7, phase_rad };
    let turning = |waves: &[[Sinusoid; 2]]| {
        let path = |waves: &[Sinusoid; 2]| Path::Sinusoids { offset: 0.0, waves: waves.to_vec() };
        Trajectory::new(waves.iter().map(path).collect()).unwrap()
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    // u = (0, 0.6, 0.8, 0) and v = (0.8, 0, 0, 0.6), which are orthogonal.
    let attitude =
        turning(&[[0.0, 0.8], [0.6, 0.0], [0.8, 0.0], [0.0, 0.6]].map(|[u, v]| [wave(u, 0.0), wave(v, quarter)]));
    assert!((attitude.least_turning_norm().unwrap() - 1.0).abs() < 1e-11);
    // Neither orthogonal nor alike: by its values over a period.
    let oblique = turning(&[[1.0, 0.7], [0.3, 1.1], [0.2, 0.0]].map(|[u, v]| [wave(u, 0.4), wave(v, 1.7)]));
    let period_s = std::f64::consts::TAU / 0.7;
    let norm = |t_s: f64| oblique.paths().iter().map(|path| path.jet(t_s)[0].powi(2)).sum::<f64>().sqrt();
    let seen = (0..100_000).map(|k| norm(period_s * f64::from(k) * 1e-5)).fold(f64::INFINITY, f64::min);
    let least = oblique.least_turning_norm().unwrap();
    assert!(least <= seen && seen - least < 1e-6, "{least} {seen}");
    // Through zero, with another rate, and beside a constant.
    assert_eq!(turning(&[[wave(1.0, 0.0), wave(0.5, 0.0)]]).least_turning_norm(), None);
    let other = Sinusoid { rad_per_s: 0.8, ..wave(1.0, quarter) };
    assert_eq!(turning(&[[wave(1.0, 0.0), other], [wave(1.0, quarter), wave(0.0, 0.0)]]).least_turning_norm(), None);
    let still = Path::Sinusoids { offset: 1.0, waves: vec![wave(0.5, 0.0)] };
    assert_eq!(Trajectory::new(vec![still]).unwrap().least_turning_norm(), None);
}
