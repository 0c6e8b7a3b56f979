//! An observer of the leader in the place of (110): its Lyapunov balance, its finite time, and what it does not hear.

use forwardstep_core::reference::{
    Choice, Derived, Following, Heard, Measured, Observer, Reference, ReferenceOut, Sliding, saturated,
};
use serde_json::Value;

const N: usize = 3;
const ALPHA: f64 = 1.2;
const GAMMA: f64 = 2.0;
const KAPPA: f64 = 1.5;
const WIDTH: f64 = 0.05;
const DAMPING: f64 = 3.0;
const ADAPTATION: f64 = 2.0;
const MASSES: [f64; N] = [0.8, 1.5, 2.3];
const STARTS: [f64; N] = [0.9, -0.7, 0.4];
const VELOCITIES: [f64; N] = [0.1, -0.3, 0.2];

/// w_ij of three agents, row by row, and w_i0 of the leader.
type Weights = ([[f64; N]; N], [f64; N]);

const DIRECTED: Weights = ([[0.0; N], [0.9, 0.0, 0.5], [0.0, 1.1, 0.0]], [1.4, 0.0, 0.0]);
const MUTUAL: Weights = ([[0.0, 0.9, 0.0], [0.9, 0.0, 0.7], [0.0, 0.7, 0.0]], [1.4, 0.0, 0.3]);

/// q_0, q̇_0, q̈_0.
fn leader(t: f64) -> [f64; 3] {
    let phase = 0.8 * t + 0.3;
    [0.6 * phase.sin(), 0.48 * phase.cos(), -0.384 * phase.sin()]
}

/// ξ̇_0.
fn drive(t: f64) -> f64 {
    let [_, dq, ddq] = leader(t);
    ddq + ALPHA * dq
}

fn sliding(choice: Choice) -> Sliding {
    Sliding { derived: Derived::Nothing, alpha: ALPHA, beta: 1.0, gamma: GAMMA, choice }
}

/// Σ_j w_ij, and the sums of the columns `x` and `v` with the leader's.
fn sums((own, from_leader): &Weights, t: f64, [x, v]: [&[f64]; 2]) -> ([f64; N], [f64; 2 * N]) {
    let [q_0, dq_0, _] = leader(t);
    let degree = core::array::from_fn(|i| own[i].iter().sum::<f64>() + from_leader[i]);
    let all = core::array::from_fn(|k| {
        let (i, column, of_leader) = if k < N { (k, x, q_0) } else { (k - N, v, dq_0) };
        own[i].iter().zip(column).map(|(w, value)| w * value).sum::<f64>() + from_leader[i] * of_leader
    });
    (degree, all)
}

/// e = L ξ̃ and ξ̃.
fn errors(weights: &Weights, t: f64, x: &[f64], v: &[f64]) -> ([f64; N], [f64; N]) {
    let [q_0, dq_0, _] = leader(t);
    let xi: [f64; N] = core::array::from_fn(|i| v[i] - dq_0 + ALPHA * (x[i] - q_0));
    let e =
        core::array::from_fn(|i| (0..N).map(|j| weights.0[i][j] * (xi[i] - xi[j])).sum::<f64>() + weights.1[i] * xi[i]);
    (e, xi)
}

/// z, ż and the rate of the observer's state where robots are at `q` and move at `dq`.
fn observer(
    weights: &Weights,
    t: f64,
    [q, dq]: [&[f64]; 2],
    [x, v]: [&[f64]; 2],
    selection: [f64; N],
) -> ([f64; N], [f64; N], [f64; 3 * N]) {
    let (degree, all) = sums(weights, t, [x, v]);
    let (mut z, mut dz, mut rate) = ([0.0; N], [0.0; N], [0.0; 3 * N]);
    let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
    let state = [x, v, &selection].concat();
    let heard = Heard::new(&degree, &all, N).unwrap();
    Observer::new(N, sliding(Choice::Layer { width: WIDTH }), KAPPA)
        .evaluate(1, Measured { q, dq }, &state, heard, out)
        .unwrap();
    (z, dz, rate)
}

/// Columns of the closed loop with point masses: q, q̇, x̂, v̂, m̂, and what their balances have lost: ∫ sᵀK s of each, and of the
/// observer.
const LEN: usize = 6 * N + 1;

fn rate(weights: &Weights, t: f64, y: &[f64; LEN]) -> [f64; LEN] {
    let (q, dq, x, v) = (&y[..N], &y[N..2 * N], &y[2 * N..3 * N], &y[3 * N..4 * N]);
    let (e, _) = errors(weights, t, x, v);
    let selection = e.map(|e| saturated(e, WIDTH));
    let (z, dz, d_state) = observer(weights, t, [q, dq], [x, v], selection);
    let mut out = [0.0; LEN];
    for i in 0..N {
        let (s, m_hat) = (dq[i] - z[i], y[4 * N + i]);
        out[i] = dq[i];
        out[N + i] = (m_hat * dz[i] - DAMPING * s) / MASSES[i];
        out[2 * N + i] = d_state[i];
        out[3 * N + i] = d_state[N + i];
        out[4 * N + i] = -ADAPTATION * dz[i] * s;
        out[5 * N + i] = DAMPING * s * s;
        out[6 * N] += e[i] * (e[i] + GAMMA * selection[i] + drive(t));
    }
    out
}

fn start() -> [f64; LEN] {
    let mut y = [0.0; LEN];
    y[..N].copy_from_slice(&STARTS);
    y[N..2 * N].copy_from_slice(&VELOCITIES);
    // As `start` of the law has it, with z(0) = 0.
    let mut state = [1.0; 3 * N];
    let heard = Heard::new(&[0.0; N], &[0.0; 2 * N], N).unwrap();
    let law = Observer::new(N, sliding(Choice::Implicit), KAPPA);
    law.start(1, Measured { q: &STARTS, dq: &VELOCITIES }, &[0.0; 3 * N], heard, &mut state).unwrap();
    assert_eq!(state[2 * N..], [0.0; N]);
    y[2 * N..4 * N].copy_from_slice(&state[..2 * N]);
    y[4 * N..5 * N].fill(0.2);
    y
}

/// Steps of the classical Runge-Kutta method, with what is to be seen after each.
fn run(weights: &Weights, h: f64, count: u32, mut seen: impl FnMut(u32, f64, &[f64; LEN])) {
    let mut y = start();
    seen(0, 0.0, &y);
    for n in 0..count {
        let t = f64::from(n) * h;
        let moved = |k: &[f64; LEN], h: f64| core::array::from_fn(|c| y[c] + h * k[c]);
        let k1 = rate(weights, t, &y);
        let k2 = rate(weights, t + h / 2.0, &moved(&k1, h / 2.0));
        let k3 = rate(weights, t + h / 2.0, &moved(&k2, h / 2.0));
        let k4 = rate(weights, t + h, &moved(&k3, h));
        y = core::array::from_fn(|c| y[c] + h / 6.0 * (k1[c] + 2.0 * (k2[c] + k3[c]) + k4[c]));
        seen(n + 1, f64::from(n + 1) * h, &y);
    }
}

/// V = ½ ξ̃ᵀL ξ̃ loses |e|² + γ eᵀς + eᵀ1 ξ̇_0, and V_i of (6)–(7) loses sᵀK s, along a run; and the leader is followed.
#[test]
fn own_observer_and_robots_lose_what_is_derived_along_a_run() {
    let value = |t: f64, y: &[f64; LEN]| -> [f64; N + 1] {
        let (e, xi) = errors(&MUTUAL, t, &y[2 * N..3 * N], &y[3 * N..4 * N]);
        core::array::from_fn(|i| {
            if i == N {
                return 0.5 * e.iter().zip(&xi).map(|(e, xi)| e * xi).sum::<f64>();
            }
            let z = y[3 * N + i] - KAPPA * (y[i] - y[2 * N + i]);
            let (s, off) = (y[N + i] - z, y[4 * N + i] - MASSES[i]);
            0.5 * (MASSES[i] * s * s + off * off / ADAPTATION)
        })
    };
    let (mut first, mut worst, mut last) = ([0.0; N + 1], 0.0_f64, [0.0; LEN]);
    run(&MUTUAL, 1e-3, 40_000, |n, t, y| {
        let now = value(t, y);
        if n == 0 {
            first = now;
        }
        for (k, (now, first)) in now.iter().zip(&first).enumerate() {
            let lost = if k == N { y[6 * N] } else { y[5 * N + k] };
            worst = worst.max((now + lost - first).abs());
        }
        last = *y;
    });
    assert!(first.iter().all(|v| *v > 0.05), "{first:?}");
    assert!(worst < 1e-7, "{worst:e}");
    let [q_0, dq_0, _] = leader(40.0);
    for i in 0..N {
        // What a layer leaves: |e| ≤ width in the end.
        let (q, dq) = ((last[i] - q_0).abs(), (last[N + i] - dq_0).abs());
        assert!(q < 0.1 && dq < 0.1, "{i}: {q} {dq}");
        assert!((last[i] - last[2 * N + i]).abs() < 2e-2, "{}", last[i] - last[2 * N + i]);
    }
}

/// With a sign, over directed links, max|ξ̃_i| falls at γ − sup|ξ̇_0| at least and stays at zero, up to what a step leaves.
#[test]
fn own_observer_has_the_leader_in_a_finite_time_over_directed_links() {
    let h = 1e-4;
    let y = start();
    let (mut x, mut v) = (y[2 * N..3 * N].to_vec(), y[3 * N..4 * N].to_vec());
    let largest =
        |t: f64, x: &[f64], v: &[f64]| errors(&DIRECTED, t, x, v).1.iter().fold(0.0_f64, |most, xi| most.max(xi.abs()));
    let supremum = (0.384_f64 * 0.384 + (ALPHA * 0.48) * (ALPHA * 0.48)).sqrt();
    let margin = GAMMA - supremum;
    let began = largest(0.0, &x, &v);
    assert!(began > 0.5 && margin > 1.0, "{began} {margin}");
    let mut slower = 0.0_f64;
    for n in 0..60_000_u32 {
        let t = f64::from(n) * h;
        let now = largest(t, &x, &v);
        slower = slower.max(now - (began - margin * t).max(0.0));
        let (e, _) = errors(&DIRECTED, t, &x, &v);
        let (_, _, rate) = observer(&DIRECTED, t, [&STARTS, &VELOCITIES], [&x, &v], e.map(|e| saturated(e, 0.0)));
        for i in 0..N {
            x[i] += h * rate[i];
            v[i] += h * rate[N + i];
        }
    }
    // Steps leave a few times h γ.
    assert!(slower < 10.0 * h * GAMMA, "{slower:e}");
}

/// What happens to a robot moves its own z and no estimate; under (110) it moves its neighbours.
#[test]
fn own_observer_hears_no_robot_and_eq_110_does() {
    let (x, v) = ([0.3, -0.2, 0.8], [0.1, 0.5, -0.4]);
    let (pushed, faster) =
        ([STARTS[0] + 0.7, STARTS[1], STARTS[2]], [VELOCITIES[0] - 0.4, VELOCITIES[1], VELOCITIES[2]]);
    let free = observer(&DIRECTED, 1.0, [&STARTS, &VELOCITIES], [&x, &v], [0.2; N]);
    let held = observer(&DIRECTED, 1.0, [&pushed, &faster], [&x, &v], [0.2; N]);
    assert_eq!(free.2, held.2);
    assert_eq!((&free.0[1..], &free.1[1..]), (&held.0[1..], &held.1[1..]));
    assert!((held.0[0] - free.0[0] + KAPPA * 0.7).abs() < 1e-12);
    assert!((held.1[0] - free.1[0] - KAPPA * 0.4).abs() < 1e-12);

    let by_measurements = |q: &[f64], dq: &[f64]| {
        let (degree, all) = sums(&DIRECTED, 1.0, [q, dq]);
        let (mut z, mut dz, mut rate) = ([0.0; N], [0.0; N], [0.0; 2 * N]);
        let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
        let heard = Heard::new(&degree, &all, N).unwrap();
        let law = Following::new(N, sliding(Choice::Implicit));
        law.evaluate(1, Measured { q, dq }, &[0.0; 2 * N], heard, out).unwrap();
        dz
    };
    let given_way = by_measurements(&pushed, &faster)[1] - by_measurements(&STARTS, &VELOCITIES)[1];
    assert!((given_way - 0.9 * (-0.4 + ALPHA * 0.7)).abs() < 1e-12, "{given_way}");
}

/// Estimates that obey (110) with themselves in the place of the robot are (110) with s = 0.
#[test]
fn own_observer_is_eq_110_of_its_estimates() {
    let (x, v, selection) = ([0.3, -0.2, 0.8], [0.1, 0.5, -0.4], [0.2, -1.0, 0.7]);
    let (_, _, rate) = observer(&DIRECTED, 1.0, [&STARTS, &VELOCITIES], [&x, &v], selection);
    let (degree, all) = sums(&DIRECTED, 1.0, [&x, &v]);
    let (mut z, mut dz, mut of_110) = ([0.0; N], [0.0; N], [0.0; 2 * N]);
    let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut of_110 };
    let state = [v, selection].concat();
    let heard = Heard::new(&degree, &all, N).unwrap();
    let law = Following::new(N, sliding(Choice::Implicit));
    law.evaluate(1, Measured { q: &x, dq: &v }, &state, heard, out).unwrap();
    assert_eq!((&rate[..N], &rate[N..2 * N]), (&v[..], &dz[..]));
}

/// Against `validation/observer`, which integrates the errors of the proof.
#[test]
fn val_observer_agrees_with_an_independent_solver() {
    let text = include_str!("../../../validation/observer/observer.json");
    let truth: Value = serde_json::from_str(text).unwrap();
    let case = &truth[0];
    let times = case["t_s"].as_array().unwrap();
    let mut compared = 0;
    run(&DIRECTED, 2.5e-4, 24_000, |n, t, y| {
        if n == 0 || n % 1000 != 0 {
            return;
        }
        let row = (n / 1000 - 1) as usize;
        assert!((times[row].as_f64().unwrap() - t).abs() < 1e-9);
        for (agent, of_truth) in case["agents"].as_array().unwrap().iter().enumerate() {
            for (column, name) in ["q", "dq", "x", "v", "theta_hat"].into_iter().enumerate() {
                let (ours, theirs) = (y[column * N + agent], of_truth[name][row].as_f64().unwrap());
                assert!((ours - theirs).abs() < 1e-7, "{name} of {agent} at {t}: {ours} {theirs}");
                compared += 1;
            }
        }
    });
    assert_eq!(compared, 24 * 3 * 5);
}
