//! What was transmitted stays within its budget of memory; a run whose steps would need more ends, and says why.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod common;

use forwardstep_sim::reference::Consensus;
use std::alloc::{GlobalAlloc, Layout, System};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use common::{axes, run, sampled, silent};
use forwardstep_core::Gain;
use forwardstep_core::robot::PointMass;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    AgentSetup, AxisUnit, BreakdownCause, Ending, Known, Method, Network, Outcome, RobotSetup, Setup, SetupError,
    Start, Stiffness, simulate, validate,
};

struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);
/// Tests take turns: what other threads allocate would count.
static TURN: Mutex<()> = Mutex::new(());

fn turn() -> MutexGuard<'static, ()> {
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

fn more(bytes: usize) {
    let held = HELD.fetch_add(bytes, Ordering::Relaxed) + bytes;
    MOST.fetch_max(held, Ordering::Relaxed);
}

// SAFETY: passes everything on to the system allocator unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        more(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // The old block and the new one are there at once, at worst.
        more(size);
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A point mass of 2 kg on a line; K/m is half of `damping`.
fn mass(index: usize, damping: f64) -> AgentSetup {
    AgentSetup {
        name: format!("mass-{index}"),
        robot: RobotSetup {
            kind: Arc::new(PointMass { dimension: 1 }),
            theta: vec![2.0],
            theta_names: vec!["mass".into()],
            axes: axes(&["x"], AxisUnit::Metre),
        },
        roots_per_s: vec![1.0].into(),
        manipulability: 0.0,
        law: Arc::new(Known { damping: Gain::Number(damping) }),
        target: None,
        start: Start { q: vec![index as f64], dq: vec![0.3], rest: Vec::new(), reference: vec![vec![0.0]] },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// Three masses in a ring, the second of which is damped by `damping`, that hear each other after `delay_s`.
fn ring(damping: f64, delay_s: f64, end_s: f64, memory_budget_bytes: u64) -> Setup {
    let agents = vec![mass(1, 5.0), mass(2, damping), mass(3, 5.0)];
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    let network = Network {
        schedule: Schedule::fixed(vec![edge(0, 1), edge(1, 2), edge(2, 0)]),
        delays: vec![Delay::constant(delay_s)],
        ..silent(3)
    };
    let mut setup = common::setup(agents, Arc::new(Consensus), network, end_s);
    setup.solver.memory_budget_bytes = memory_budget_bytes;
    setup
}

/// Runs, and tells by how many bytes more than at its first step were held at once.
fn measured(setup: &Setup) -> (Outcome, usize) {
    let mut first = None;
    let outcome = simulate(setup, &mut |_| {
        first.get_or_insert_with(|| {
            let held = HELD.load(Ordering::Relaxed);
            MOST.store(held, Ordering::Relaxed);
            held
        });
        ControlFlow::Continue(())
    })
    .unwrap();
    (outcome, MOST.load(Ordering::Relaxed) - first.unwrap())
}

fn memory_full(outcome: &Outcome) -> (usize, f64, f64, Stiffness) {
    let Ending::BrokeDown(breakdown) = &outcome.ending else { panic!("{:?}", outcome.ending) };
    let BreakdownCause::MemoryFull { step_s, need_bytes, stiffness } = breakdown.cause else { panic!("{breakdown:?}") };
    assert!(outcome.recording.t_s.last().unwrap() <= &breakdown.t_s && breakdown.t_s > 0.0, "{breakdown:?}");
    (breakdown.agent, step_s, need_bytes, stiffness.unwrap())
}

#[test]
fn a_stiff_run_ends_within_its_budget_and_names_agent_rate_and_gain() {
    let _turn = turn();
    for budget in [40_000_u64, 1_000_000, 7_777_777] {
        let mut setup = ring(2e7, 5.0, 50.0, budget);
        setup.time.record_every_s = 1.5e-5;
        // Room for the rows that chunks are taken for, and for break-points.
        let recorded = 8 * (4096 + 2) * 20;
        let (outcome, grown) = measured(&setup);
        let (agent, step_s, need_bytes, Stiffness { rate_per_s, gains }) = memory_full(&outcome);
        assert!(grown as u64 <= budget + recorded, "{grown} bytes of {budget}");
        assert!(budget < 1_000_000 || 3 * grown as u64 >= budget / 2, "{grown} bytes of {budget}");
        assert_eq!(agent, 1);
        // The eigenvalue is K/m.
        assert!((0.5e7..2e7).contains(&rate_per_s), "{rate_per_s}");
        let gains = gains.unwrap();
        assert!((gains.damping_per_s - 1e7).abs() < 1e-3 && gains.adaptation_per_s.is_none(), "{gains:?}");
        assert!((0.1..3.5).contains(&(step_s * rate_per_s)), "{step_s}");
        // A piece holds five numbers for each of three that are sent, and three for its times.
        let pieces = 5.0 / step_s;
        assert!(
            (1.5 * 144.0 * pieces..3.01 * 144.0 * pieces).contains(&need_bytes),
            "{need_bytes} for {pieces} pieces"
        );
    }
}

#[test]
fn a_long_delay_is_no_reason_to_end_and_what_is_needed_is_what_is_told() {
    let _turn = turn();
    let default = forwardstep_sim::Solver::default().memory_budget_bytes;
    assert_eq!(default, 1 << 30);
    let plenty = run(&ring(5.0, 400.0, 1000.0, default));
    // The budget that a run asks for that ends is enough for it, with the same numbers.
    let (outcome, _) = measured(&ring(5.0, 400.0, 1000.0, 50_000));
    let (_, step_s, need_bytes, _) = memory_full(&outcome);
    assert!(need_bytes < 1e7 && step_s > 1e-3, "{need_bytes} {step_s}");
    let enough = run(&ring(5.0, 400.0, 1000.0, need_bytes as u64));
    assert_eq!(plenty.recording, enough.recording);
}

#[test]
fn steps_of_a_given_length_fill_the_budget_without_being_stiff() {
    let _turn = turn();
    let mut setup = ring(7.0, 5.0, 50.0, 100_000);
    setup.solver.method = Method::Fixed { step_s: 1e-4 };
    let (agent, step_s, _, stiffness) = memory_full(&measured(&setup).0);
    assert_eq!(agent, 1, "the fastest");
    assert!((step_s - 1e-4).abs() < 1e-12 && !stiffness.explains(step_s), "{step_s} {stiffness:?}");
    assert!((1.75..7.0).contains(&stiffness.rate_per_s), "{stiffness:?}");
}

#[test]
fn a_run_under_the_floor_says_how_fast_the_closed_loop_is() {
    let _turn = turn();
    let mut setup = ring(2e7, 0.5, 5.0, 1 << 30);
    setup.solver.min_step_s = 1e-5;
    let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let Ending::BrokeDown(breakdown) = outcome.ending else { panic!() };
    let BreakdownCause::StepUnderFloor { step_s, stiffness: Some(stiffness) } = breakdown.cause else { panic!() };
    assert!(breakdown.agent == 1 && step_s < 1e-5, "{breakdown:?}");
    assert!((0.5e7..2e7).contains(&stiffness.rate_per_s) && stiffness.forbids(1e-5), "{breakdown:?}");
    assert!(!stiffness.forbids(1e-8));
}

#[test]
fn a_budget_too_small_to_begin_with_is_refused_to_the_byte() {
    let _turn = turn();
    // Continuous: a piece and its draft. Sampled: the first sample and those of five seconds and two more.
    let continuous = ring(5.0, 5.0, 50.0, 0);
    let control = sampled(continuous.clone(), 100.0);
    for (mut setup, need_bytes) in [(continuous, 2 * (5 * 3 * 8 + 24)), (control, 3 * 8 * (500 + 3))] {
        for (memory_budget_bytes, refused) in [(need_bytes - 1, true), (need_bytes, false)] {
            setup.solver.memory_budget_bytes = memory_budget_bytes;
            let expected = if refused {
                Err(SetupError::Memory { need_bytes, budget_bytes: memory_budget_bytes })
            } else {
                Ok(())
            };
            assert_eq!(validate(&setup), expected);
        }
        assert!(!measured(&setup).0.recording.t_s.is_empty());
    }
}
