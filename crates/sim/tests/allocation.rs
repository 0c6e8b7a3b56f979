//! Steps do not allocate: only history, waiting events and the recording grow, in chunks.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod cases;
mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ops::ControlFlow;

use cases::{cases, setup};
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::push::{Between, Course, Effect, Push, Table};
use forwardstep_sim::{Actuators, Control, Sensors, Setup, VelocitySensor, simulate};

struct Counting;

thread_local! {
    /// Of this thread alone: on a busy machine the harness prints in the midst of a run.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    // While a thread ends there is no counter.
    let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: passes everything on to the system allocator unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Lets the weight of every edge, and every delay that varies, follow a formula.
fn weights_swing(setup: &mut Setup) {
    let end_s = setup.time.end_s;
    let swing =
        |mean: f64, amplitude: f64| BoundedFormula::new(Expression::variable(0).sin_of() * amplitude + mean, end_s);
    setup.network.weights = vec![swing(1.0, 0.5)];
    for edge in setup.network.schedule.graphs.iter_mut().flatten() {
        edge.weight = Weight::Formula(0);
    }
    for delay in
        setup.network.delays.iter_mut().filter(|delay| delay.downcast::<forwardstep_sim::delay::Sinusoid>().is_some())
    {
        *delay = Delay::new(swing(0.3, 0.1));
    }
}

/// Lets a virtual spring lead the first agent along a table.
fn a_hand_leads(setup: &mut Setup) {
    let axes = setup.agents[0].robot.axes.len();
    let times_s: Vec<f64> = (0..200).map(|k| 0.05 * k as f64).collect();
    let values = (0..200 * axes).map(|k| 0.01 * k as f64).collect();
    let table = Course::Table(Table { times_s, values, between: Between::Linear });
    let (stiffness, damping) = (vec![3.0; axes], vec![1.0; axes]);
    let hand = Effect::SpringOnAxes { axes: (0..axes).collect(), stiffness, damping, target: table };
    setup.agents[0].pushes = vec![Push { effect: hand, from_s: 0.1, until_s: f64::INFINITY }];
}

/// Digital control with everything that it can have.
fn sampled() -> Control {
    let sensors = Sensors {
        velocity: VelocitySensor::Filtered { cut_off_hz: 50.0 },
        position_noise: 1e-5,
        position_quantum: 1e-6,
        ..Sensors::default()
    };
    let actuators = Actuators { torque_quantum: 1e-3, ..Actuators::default() };
    Control { sample_hz: 500.0, computation_delay_s: 0.001, sensors, actuators, failures: Default::default() }
}

#[test]
fn alloc_steps_do_not_allocate() {
    for (case, how) in
        cases().into_iter().flat_map(|case| ["plain", "formulas", "pushed", "sampled"].map(|how| (case.clone(), how)))
    {
        let mut setup = setup(&case);
        setup.time.record_every_s = 0.01;
        match how {
            "formulas" => weights_swing(&mut setup),
            "pushed" => a_hand_leads(&mut setup),
            "sampled" => setup.control = Some(sampled()),
            _ => {}
        }
        assert_steps_do_not_allocate(&format!("{} {how}", case.name), &setup);
    }
    for (name, mut setup) in common::every_kind() {
        // What moves slowly shall take enough steps to be counted.
        setup.solver.max_step_s = Some(0.02);
        assert_steps_do_not_allocate(name, &setup);
        assert_steps_do_not_allocate(name, &common::sampled(setup, 500.0));
    }
}

fn assert_steps_do_not_allocate(name: &str, setup: &Setup) {
    let how = if setup.control.is_some() { "sampled" } else { "continuous" };
    let (mut before, mut steps) = (None, 0_u64);
    simulate(setup, &mut |progress| {
        // The first quarter fills the ring of history and the queue of events.
        if progress.t_s > 0.25 * progress.end_s {
            before.get_or_insert_with(|| ALLOCATIONS.get());
            steps += 1;
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    let grown = ALLOCATIONS.get() - before.unwrap();
    assert!(steps > 100, "{name}, {how}: {steps} steps");
    assert!(grown <= 6, "{name}, {how}: {grown} allocations in {steps} steps");
}
