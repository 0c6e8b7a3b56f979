//! Links and weights of the new kinds against equal ones of the old.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use crate::cases::{cases, setup};
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::{Delay, Loss, PacketLink, SawTooth, Sinusoid};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{Ending, Method, Outcome, Setup, simulate};

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

/// The largest difference between two recordings.
fn difference(a: &Outcome, b: &Outcome) -> f64 {
    assert_eq!(a.recording.t_s, b.recording.t_s);
    let pairs = a.recording.columns.iter().zip(&b.recording.columns);
    pairs.flat_map(|(a, b)| a.values.iter().zip(&b.values)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A case with tight tolerances and few rows.
fn case(name: &str) -> Setup {
    let case = cases().into_iter().find(|case| case.name == name).unwrap();
    let mut setup = setup(&case);
    setup.solver.method = Method::Adaptive { rtol: 1e-11, atol: 1e-12 };
    setup.time.record_every_s = setup.time.end_s / 50.0;
    setup
}

fn swing(mean: f64, amplitude: f64, omega: f64, phase: f64) -> Expression {
    let angle = Expression::number(omega) * Expression::variable(0) + phase;
    Expression::number(mean) + Expression::number(amplitude) * angle.sin_of()
}

#[test]
fn a_formula_is_the_sinusoid_that_it_says() {
    let sinusoid = case("10-mixed-delays");
    let mut formula = sinusoid.clone();
    let mut replaced = 0;
    for delay in &mut formula.network.delays {
        if let Some(&Sinusoid { mean_s, amplitude_s, period_s, phase_rad }) = delay.downcast() {
            let swing = swing(mean_s, amplitude_s, TAU / period_s, phase_rad);
            *delay = Delay::new(BoundedFormula::new(swing, formula.time.end_s));
            replaced += 1;
        }
    }
    assert!(replaced > 0);
    let gap = difference(&run(&sinusoid), &run(&formula));
    println!("sinusoid and formula differ by {gap:.1e}");
    assert!(gap < 1e-9, "{gap:e}");
}

#[test]
fn packets_without_jitter_are_the_saw_tooth_that_they_say() {
    let mut tooth = case("10-mixed-delays");
    let mut edges: Vec<_> = tooth.network.schedule.graphs[0].to_vec();
    for edge in &mut edges {
        edge.delay = 0;
    }
    tooth.network.schedule = Schedule::fixed(edges.clone());
    tooth.network.delays = vec![Delay::new(SawTooth { min_s: 0.25, max_s: 0.75, period_s: 0.5, offset_s: 0.25 })];
    let link = PacketLink {
        every_s: 0.5,
        first_s: 0.0,
        latency_s: 0.25,
        jitter_s: 0.0,
        loss: Loss::Never,
        most_in_a_row: None,
        seed: 1,
    };
    let mut packets = tooth.clone();
    let trace = |(from, to)| Delay::new(link.trace((from, to), tooth.time.end_s).unwrap());
    packets.network.delays = edges.iter().map(|edge| trace((edge.from, edge.to))).collect();
    for (delay, edge) in edges.iter_mut().enumerate() {
        edge.delay = delay;
    }
    packets.network.schedule = Schedule::fixed(edges);
    let gap = difference(&run(&tooth), &run(&packets));
    println!("saw-tooth and packets differ by {gap:.1e}");
    assert!(gap < 1e-9, "{gap:e}");
}

#[test]
fn a_weight_by_formula_is_the_number_that_it_says() {
    // A formula with t in it whose value never changes, on every other edge.
    let constant = case("15-order2-both-switching");
    let mut formula = constant.clone();
    for edge in formula.network.schedule.graphs.iter_mut().flatten().step_by(2) {
        let weight = edge.weight.constant().unwrap();
        let still = Expression::variable(0) * 0.0 + weight;
        formula.network.weights.push(BoundedFormula::new(still, formula.time.end_s));
        edge.weight = Weight::Formula(formula.network.weights.len() - 1);
    }
    assert!(!formula.network.weights.is_empty());
    let gap = difference(&run(&constant), &run(&formula));
    println!("constant and formula differ by {gap:.1e}");
    assert!(gap < 1e-9, "{gap:e}");
}

#[test]
fn what_ends_before_the_run_is_refused() {
    let mut setup = case("10-mixed-delays");
    setup.network.delays[0] = Delay::new(BoundedFormula::new(swing(0.2, 0.1, 1.0, 0.0), 0.5));
    let refused = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(refused.contains("known until 0.5 s"), "{refused}");
}
