//! Closed-loop trajectories against solvers that nobody here wrote: see `validation/trajectories/README.md`.

use std::ops::ControlFlow;

use crate::cases::{Case, ReferenceCase, cases, setup};
use crate::common::{is_long, some};
use forwardstep_sim::{Ending, Method, Outcome, Setup, Signal, simulate};

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

/// The last recorded values of one agent, ordered as the case stores them.
fn last(outcome: &Outcome, agent: usize, signal: Signal) -> Vec<f64> {
    let columns = outcome.recording.columns.iter().filter(|c| c.agent == agent && c.signal == signal);
    columns.map(|c| *c.values.last().unwrap()).collect()
}

/// The largest difference from one sample of a case, over q, q̇, z … and ϑ̂.
fn difference(case: &Case, setup: &Setup, sample: usize) -> f64 {
    let mut setup = setup.clone();
    setup.time.end_s = case.samples.times_s[sample];
    setup.time.record_every_s = setup.time.end_s;
    let outcome = run(&setup);
    let mut worst: f64 = 0.0;
    for (agent, truth) in case.samples.agents.iter().enumerate() {
        let mut compare = |signal, expected: &[f64]| {
            let got = last(&outcome, agent, signal);
            assert_eq!(got.len(), expected.len(), "{signal:?}");
            for (a, b) in got.iter().zip(expected) {
                worst = worst.max((a - b).abs());
            }
        };
        compare(Signal::Position, &truth.q[sample]);
        compare(Signal::Velocity, &truth.dq[sample]);
        for (r, z) in truth.reference[sample].iter().enumerate() {
            compare(Signal::Reference(r as u8), z);
        }
        if !case.agents[agent].knows_theta {
            compare(Signal::Estimate, &truth.theta_hat[sample]);
        }
    }
    worst
}

#[test]
fn val_trajectories_agree_with_an_independent_solver() {
    let mut table = Vec::new();
    for case in some(cases(), 3) {
        let mut setup = setup(&case);
        setup.solver.method = Method::Adaptive { rtol: 1e-10, atol: 1e-11 };
        let worst = (0..case.samples.times_s.len())
            .filter(|sample| case.samples.times_s[*sample] > 0.0)
            .map(|sample| difference(&case, &setup, sample))
            .fold(0.0, f64::max);
        table.push(format!("{:40} {worst:.2e}", case.name));
        assert!(worst <= 1e-7, "{}: differs by {worst:e}", case.name);
    }
    for kind in ["-pure-", "-lambda-", "-backstepping-"] {
        assert!(cases().iter().filter(|case| case.name.contains(kind)).count() >= 2, "{kind}");
    }
    assert!(table.len() >= if is_long() { 37 } else { 13 });
    println!("{}", table.join("\n"));
}

#[test]
fn val_trajectories_error_asked_for_is_the_error_got() {
    // Global error ≤ 10 × tolerance, jumping delays and switching graphs included.
    let mut table = Vec::new();
    for case in cases() {
        for rtol in [1e-4, 1e-6, 1e-8] {
            let mut setup = setup(&case);
            setup.solver.method = Method::Adaptive { rtol, atol: rtol };
            let sample = case.samples.times_s.len() - 1;
            let worst =
                [sample / 3, sample / 2, sample].map(|s| difference(&case, &setup, s)).into_iter().fold(0.0, f64::max);
            table.push((worst / rtol, format!("{:40} {rtol:.0e} {worst:.2e} {:.2}", case.name, worst / rtol)));
        }
    }
    for (_, row) in &table {
        println!("{row}");
    }
    for (ratio, row) in &table {
        assert!(*ratio <= 10.0, "{row}");
    }
}

#[test]
fn val_trajectories_fixed_step_converges_with_order_four() {
    // Steps end on break-points, so the order survives jumps.
    for name in ["10-mixed-delays", "15-order2-both-switching"] {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        let error = |step_s: f64| {
            let mut setup = setup(&case);
            setup.solver.method = Method::Fixed { step_s };
            difference(&case, &setup, case.samples.times_s.len() - 1)
        };
        let (coarse, fine) = (error(0.004), error(0.002));
        let order = (coarse / fine).log2();
        println!("{name}: {coarse:.2e} → {fine:.2e}, order {order:.2}");
        assert!(order > 3.5, "{name}: order {order}");
    }
}

#[test]
fn thm_lyapunov_balance_holds_along_real_runs() {
    // V̇ = −sᵀ(K + D)s, integrated along the run as an extra state: the paper's own identity. The baseline has none: its
    // z jumps, and what it takes for ż is filtered.
    for case in cases().into_iter().filter(|case| !matches!(case.reference, ReferenceCase::Backstepping { .. })) {
        let rtol = 1e-6;
        let mut setup = setup(&case);
        setup.solver.method = Method::Adaptive { rtol, atol: 1e-3 * rtol };
        setup.time.record_every_s = setup.time.end_s / 200.0;
        let outcome = run(&setup);
        for agent in 0..setup.agents.len() {
            let column = |signal| {
                outcome
                    .recording
                    .columns
                    .iter()
                    .find(|c| c.agent == agent && c.signal == signal)
                    .map(|c| &c.values)
                    .unwrap()
            };
            let (v, w) = (column(Signal::Lyapunov), column(Signal::Dissipation));
            for (v_t, w_t) in v.iter().zip(w) {
                let defect = (v_t + w_t - v[0]).abs();
                assert!(defect <= 10.0 * rtol * v[0].max(1e-3), "{} agent {agent}: {defect:e} of {}", case.name, v[0]);
            }
        }
    }
}
