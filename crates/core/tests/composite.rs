//! Agreement with a leader on one vector: that it is z̈ as it is derived, its Lyapunov balances, its finite time, and what it does not hear.

use forwardstep_core::reference::{
    Choice, CompositeFollowing, Derived, Heard, Measured, Reference, ReferenceOut, Sliding, saturated,
};
use proptest::prelude::*;

const N: usize = 3;
const ALPHA: f64 = 1.2;
const BETA: f64 = 1.9;
const GAMMA: f64 = 2.5;
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
const OTHER: Weights = ([[0.0, 0.0, 0.6], [1.3, 0.0, 0.0], [0.0; N]], [0.0, 0.0, 0.4]);

/// q_0, q̇_0, q̈_0, d³q_0.
fn leader(t: f64) -> [f64; 4] {
    let (sin, cos) = (0.8 * t + 0.3).sin_cos();
    [0.6 * sin, 0.48 * cos, -0.384 * sin, -0.3072 * cos]
}

/// y_0.
fn transmitted(t: f64) -> f64 {
    let [q, dq, ddq, _] = leader(t);
    ddq + BETA * dq + ALPHA * q
}

/// ẏ_0.
fn drive(t: f64) -> f64 {
    let [_, dq, ddq, dddq] = leader(t);
    dddq + BETA * ddq + ALPHA * dq
}

fn law(choice: Choice) -> CompositeFollowing {
    CompositeFollowing::new(N, Sliding { derived: Derived::Composite, alpha: ALPHA, beta: BETA, gamma: GAMMA, choice })
}

/// e = L ỹ and ỹ.
fn errors((own, from_leader): &Weights, t: f64, y: &[f64]) -> ([f64; N], [f64; N]) {
    let apart: [f64; N] = core::array::from_fn(|i| y[i] - transmitted(t));
    let e = core::array::from_fn(|i| {
        (0..N).map(|j| own[i][j] * (apart[i] - apart[j])).sum::<f64>() + from_leader[i] * apart[i]
    });
    (e, apart)
}

/// z, ż and the rate of the state where robots are at `q` and move at `dq`.
fn evaluated(
    (own, from_leader): &Weights,
    t: f64,
    [q, dq]: [&[f64]; 2],
    [z, y]: [&[f64]; 2],
    selection: [f64; N],
) -> ([f64; N], [f64; N], [f64; 3 * N]) {
    let degree: [f64; N] = core::array::from_fn(|i| own[i].iter().sum::<f64>() + from_leader[i]);
    let sums: [f64; N] = core::array::from_fn(|i| {
        own[i].iter().zip(y).map(|(w, y)| w * y).sum::<f64>() + from_leader[i] * transmitted(t)
    });
    let (mut z_out, mut dz, mut rate) = ([0.0; N], [0.0; N], [0.0; 3 * N]);
    let out = ReferenceOut { z: &mut z_out, dz: &mut dz, d_state: &mut rate };
    let heard = Heard::new(&degree, &sums, N).unwrap();
    let state = [z, y, &selection].concat();
    law(Choice::Layer { width: WIDTH }).evaluate(1, Measured { q, dq }, &state, heard, out).unwrap();
    (z_out, dz, rate)
}

proptest! {
    /// z̈ = −β ż − α q̇ − Σ w (y_i − y_j) − γ ς with y = ż + β z + α q, for any state.
    #[test]
    fn own_composite_is_the_second_derivative_that_is_derived(
        q in prop::array::uniform3(-3.0..3.0),
        dq in prop::array::uniform3(-3.0..3.0),
        z in prop::array::uniform3(-3.0..3.0),
        y in prop::array::uniform3(-3.0..3.0),
        selection in prop::array::uniform3(-1.0..1.0),
        t in 0.0..10.0,
    ) {
        let (z_out, dz, rate) = evaluated(&DIRECTED, t, [&q, &dq], [&z, &y], selection);
        let (e, _) = errors(&DIRECTED, t, &y);
        prop_assert_eq!(z_out, z);
        prop_assert_eq!(&rate[..N], &dz[..]);
        prop_assert_eq!(&rate[2 * N..], &[0.0; N]);
        for i in 0..N {
            prop_assert!((y[i] - (dz[i] + BETA * z[i] + ALPHA * q[i])).abs() < 1e-12);
            // Differentiated, with ẏ as the law has it.
            let ddz = rate[N + i] - BETA * dz[i] - ALPHA * dq[i];
            let derived = -BETA * dz[i] - ALPHA * dq[i] - e[i] - GAMMA * selection[i];
            prop_assert!((ddz - derived).abs() < 1e-11, "{} {}", ddz, derived);
        }
    }
}

/// Columns of the closed loop with point masses: q, q̇, z, y, m̂, and what their balances have lost: ∫ sᵀK s of each, and of y.
const LEN: usize = 6 * N + 1;

fn rate(weights: &Weights, t: f64, x: &[f64; LEN]) -> [f64; LEN] {
    let (q, dq, z, y) = (&x[..N], &x[N..2 * N], &x[2 * N..3 * N], &x[3 * N..4 * N]);
    let (e, _) = errors(weights, t, y);
    let selection = e.map(|e| saturated(e, WIDTH));
    let (z, dz, d_state) = evaluated(weights, t, [q, dq], [z, y], selection);
    let mut out = [0.0; LEN];
    for i in 0..N {
        let (s, m_hat) = (dq[i] - z[i], x[4 * N + i]);
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
    let mut x = [0.0; LEN];
    x[..N].copy_from_slice(&STARTS);
    x[N..2 * N].copy_from_slice(&VELOCITIES);
    // As `start` of the law has it, with z(0) and ż(0) given.
    let (mut state, given) = ([1.0; 3 * N], [0.2, -0.1, 0.3, 0.5, 0.0, -0.4, 0.0, 0.0, 0.0]);
    let heard = Heard::new(&[0.0; N], &[0.0; N], N).unwrap();
    law(Choice::Implicit).start(1, Measured { q: &STARTS, dq: &VELOCITIES }, &given, heard, &mut state).unwrap();
    assert_eq!((&state[..N], &state[2 * N..]), (&given[..N], &[0.0; N][..]));
    for i in 0..N {
        assert!((state[N + i] - (given[N + i] + BETA * given[i] + ALPHA * STARTS[i])).abs() < 1e-15);
    }
    x[2 * N..4 * N].copy_from_slice(&state[..2 * N]);
    x[4 * N..5 * N].fill(0.2);
    x
}

/// Steps of the classical Runge-Kutta method, with what is to be seen after each.
fn run(weights: &Weights, h: f64, count: u32, mut seen: impl FnMut(f64, &[f64; LEN])) {
    let mut x = start();
    seen(0.0, &x);
    for n in 0..count {
        let t = f64::from(n) * h;
        let moved = |k: &[f64; LEN], h: f64| core::array::from_fn(|c| x[c] + h * k[c]);
        let k1 = rate(weights, t, &x);
        let k2 = rate(weights, t + h / 2.0, &moved(&k1, h / 2.0));
        let k3 = rate(weights, t + h / 2.0, &moved(&k2, h / 2.0));
        let k4 = rate(weights, t + h, &moved(&k3, h));
        x = core::array::from_fn(|c| x[c] + h / 6.0 * (k1[c] + 2.0 * (k2[c] + k3[c]) + k4[c]));
        seen(f64::from(n + 1) * h, &x);
    }
}

/// V = ½ ỹᵀL ỹ loses |e|² + γ eᵀς + eᵀ1 ẏ_0, and V_i of (6)–(7) loses sᵀK s, along a run; and the leader is followed.
#[test]
fn own_composite_and_robots_lose_what_is_derived_along_a_run() {
    let value = |t: f64, x: &[f64; LEN]| -> [f64; N + 1] {
        let (e, apart) = errors(&MUTUAL, t, &x[3 * N..4 * N]);
        core::array::from_fn(|i| {
            if i == N {
                return 0.5 * e.iter().zip(&apart).map(|(e, apart)| e * apart).sum::<f64>();
            }
            let (s, off) = (x[N + i] - x[2 * N + i], x[4 * N + i] - MASSES[i]);
            0.5 * (MASSES[i] * s * s + off * off / ADAPTATION)
        })
    };
    let (mut first, mut worst, mut last) = (None, 0.0_f64, [0.0; LEN]);
    run(&MUTUAL, 1e-3, 60_000, |t, x| {
        let now = value(t, x);
        let first = first.get_or_insert(now);
        for (k, (now, first)) in now.iter().zip(first.iter()).enumerate() {
            worst = worst.max((now + x[5 * N + k] - first).abs());
        }
        last = *x;
    });
    assert!(first.unwrap().iter().all(|v| *v > 0.05), "{first:?}");
    assert!(worst < 1e-7, "{worst:e}");
    let [q_0, dq_0, ..] = leader(60.0);
    for i in 0..N {
        // What a layer leaves: |e| ≤ width in the end.
        let (q, dq) = ((last[i] - q_0).abs(), (last[N + i] - dq_0).abs());
        assert!(q < 0.1 && dq < 0.1, "{i}: {q} {dq}");
    }
}

/// With a sign max|ỹ_i| falls at γ − sup|ẏ_0| at least and stays at zero, up to what a step leaves: over links that lead one way, and
/// over graphs that take turns.
#[test]
fn own_composite_has_the_leader_in_a_finite_time_over_graphs_that_take_turns() {
    let h = 1e-4;
    let supremum = ((1.2_f64 * 0.48 - 0.3072).powi(2) + (1.9_f64 * 0.384).powi(2)).sqrt();
    assert!((0..10_000).all(|k| drive(f64::from(k) * 1e-3).abs() <= supremum + 1e-12));
    let margin = GAMMA - supremum;
    for graphs in [vec![DIRECTED], vec![DIRECTED, OTHER, MUTUAL]] {
        let mut y = start()[3 * N..4 * N].to_vec();
        let largest = |t: f64, y: &[f64]| y.iter().fold(0.0_f64, |most, y| most.max((y - transmitted(t)).abs()));
        let began = largest(0.0, &y);
        assert!(began > 0.5 && margin > 1.0, "{began} {margin}");
        let mut slower = 0.0_f64;
        for n in 0..60_000_u32 {
            let t = f64::from(n) * h;
            let graph = &graphs[(n / 1300) as usize % graphs.len()];
            slower = slower.max(largest(t, &y) - (began - margin * t).max(0.0));
            let selection = errors(graph, t, &y).0.map(|e| saturated(e, 0.0));
            let (_, _, rate) = evaluated(graph, t, [&STARTS, &VELOCITIES], [&[0.0; N], &y], selection);
            for i in 0..N {
                y[i] += h * rate[N + i];
            }
        }
        // Steps leave a few times h γ.
        assert!(slower < 10.0 * h * GAMMA, "{slower:e}");
    }
}

/// What happens to a robot moves its own ż and nothing that is told.
#[test]
fn own_composite_hears_no_robot() {
    let (z, y) = ([0.3, -0.2, 0.8], [0.1, 0.5, -0.4]);
    let (pushed, faster) =
        ([STARTS[0] + 0.7, STARTS[1], STARTS[2]], [VELOCITIES[0] - 0.4, VELOCITIES[1], VELOCITIES[2]]);
    let free = evaluated(&DIRECTED, 1.0, [&STARTS, &VELOCITIES], [&z, &y], [0.2; N]);
    let held = evaluated(&DIRECTED, 1.0, [&pushed, &faster], [&z, &y], [0.2; N]);
    assert_eq!(free.2[N..], held.2[N..]);
    assert_eq!((&free.0, &free.1[1..]), (&held.0, &held.1[1..]));
    assert!((held.1[0] - free.1[0] + ALPHA * 0.7).abs() < 1e-12);
}
