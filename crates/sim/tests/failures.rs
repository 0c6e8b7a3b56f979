//! What happens when a sampled controller cannot go on as usual: messages that are too old, and steps that fail.

use forwardstep_sim::reference::Tracking;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::chains::{agent, number, x};
use crate::common::{column, consensus_of_masses, fixed, run, sampled, setup, silent};
use forwardstep_core::plant::Formulas;
use forwardstep_core::sampled::SafeCommand;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{
    ChainModel, ChainStep, Ending, Failures, Observers, Outcome, Setup, SetupError, Signal, simulate, simulate_with,
};

const HZ: f64 = 500.0;

/// Masses that hear each other 0.3 s late.
fn late(timeout_s: Option<f64>) -> Setup {
    let mut setup = sampled(consensus_of_masses(2.0), HZ);
    for delay in &mut setup.network.delays {
        *delay = Delay::constant(0.3);
    }
    let edges = setup.network.schedule.graph(0).to_vec();
    setup.network.schedule = Schedule::fixed(edges);
    setup.control.as_mut().unwrap().failures.message_timeout_s = timeout_s;
    setup
}

#[test]
fn messages_within_the_time_out_count_and_older_ones_do_not() {
    let any = run(&late(None));
    // The newest message is as old as the delay, to a period.
    assert_eq!(run(&late(Some(0.3))).recording, any.recording);
    assert_eq!(run(&late(Some(5.0))).recording, any.recording);
    for coupling in [Coupling::Linear, Coupling::Tanh { scale: 0.5 }] {
        let mut timed = late(Some(0.201));
        timed.network.coupling = coupling;
        let mut cut = late(None);
        cut.network.coupling = coupling;
        if coupling != Coupling::Linear {
            timed.exchange = forwardstep_sim::Exchange::Position;
            cut.exchange = forwardstep_sim::Exchange::Position;
        }
        // What is known of the start grows old like a message: after 0.2 s nobody hears anybody any more.
        let edges = cut.network.schedule.graph(0).to_vec();
        cut.network.schedule =
            Schedule::once(vec![Phase { dwell_s: 0.201, edges }, Phase { dwell_s: 10.0, edges: Vec::new() }]);
        let (timed, cut) = (run(&timed), run(&cut));
        for (a, b) in timed.recording.columns.iter().zip(&cut.recording.columns) {
            let most = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(most < 1e-9, "{:?} {most:e}", a.signal);
        }
        assert_ne!(timed.recording, any.recording);
    }
}

#[test]
fn senders_count_again_as_soon_as_something_newer_arrives() {
    // From 0.05 s to 0.45 s and back at once: with a time-out of 0.25 s every other half is silent.
    let mut setup = late(Some(0.25));
    for delay in &mut setup.network.delays {
        *delay = Delay::new(SawTooth { min_s: 0.05, max_s: 0.45, period_s: 0.8, offset_s: 0.0 });
    }
    setup.time.end_s = 4.0;
    let (mut heard, mut changes, mut before) = ([0_u32; 2], 0, None);
    let mut watch = |taken: forwardstep_sim::SampleTaken<'_>| {
        if taken.agent == 0 {
            let counts = taken.inbox.degree > 0.0;
            assert!(counts || taken.inbox.sums.iter().all(|sum| *sum == 0.0), "at {} s", taken.now_s);
            heard[usize::from(counts)] += 1;
            changes += u32::from(before.is_some_and(|before| before != counts));
            before = Some(counts);
        }
    };
    simulate_with(
        &setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { samples: Some(&mut watch), ..Observers::default() },
    )
    .unwrap();
    let share = f64::from(heard[0]) / f64::from(heard[0] + heard[1]);
    assert!((0.4..0.6).contains(&share) && changes >= 8, "{heard:?}, {changes}");
}

/// ẍ = x u, which is led through x = 0, where no u helps.
fn through_zero(safe_command: Option<SafeCommand>) -> Setup {
    let model = ChainModel::Derivatives(Arc::new(Formulas::new(2, &number(0.0), Vec::new(), &x(0)).unwrap()));
    let step = ChainStep::Linearising { gain_per_s: 2.0 };
    let mut chain = agent(1, model, &[], step, &[1.0, 2.0], &[1.0, -1.0]);
    chain.change_law(|law: &mut forwardstep_sim::ChainLaw| law.floor = 0.1);
    chain.target = Some(Trajectory::new(vec![fixed(-1.0)]).unwrap());
    let mut setup = sampled(setup(vec![chain], Arc::new(Tracking), silent(1), 5.0), HZ);
    setup.time.record_every_s = 0.002;
    setup.control.as_mut().unwrap().failures.safe_command = safe_command;
    setup
}

/// The commands at the rows where the law fails, and those at the rows before.
fn commands(outcome: &Outcome) -> Vec<(f64, f64)> {
    let (u, psi) = (column(outcome, 0, Signal::Torque, 0), column(outcome, 0, Signal::Divisor, 0));
    let fails = |row: &usize| psi[*row].abs() < 0.1 && psi[row - 1].abs() < 0.1;
    (1..u.len()).filter(fails).map(|row| (u[row], u[row - 1])).collect()
}

#[test]
fn a_safe_command_stands_where_a_step_fails_and_the_run_goes_on() {
    let outcome = simulate(&through_zero(None), &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(matches!(outcome.ending, Ending::BrokeDown(_)), "{:?}", outcome.ending);
    assert_eq!(outcome.statistics.failed_steps, 0);
    for (safe, stands) in
        [(SafeCommand::Zero, Some(0.0)), (SafeCommand::Values(vec![-0.75]), Some(-0.75)), (SafeCommand::HoldLast, None)]
    {
        let outcome = run(&through_zero(Some(safe.clone())));
        let failed = commands(&outcome);
        assert!(
            failed.len() > 20 && outcome.statistics.failed_steps >= failed.len() as u64,
            "{safe:?}: {}",
            failed.len()
        );
        for (command, before) in failed {
            assert_eq!(command, stands.unwrap_or(before), "{safe:?}");
        }
        // Beyond zero the law takes over again and reaches the target.
        let gap = *column(&outcome, 0, Signal::Error, 0).last().unwrap();
        assert!(gap.abs() < 0.2, "{safe:?}: {gap}");
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |failures: Failures| {
        let mut setup = through_zero(None);
        setup.control.as_mut().unwrap().failures = failures;
        simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err()
    };
    for timeout_s in [-0.1, f64::NAN, f64::INFINITY] {
        let error = refused(Failures { message_timeout_s: Some(timeout_s), ..Failures::default() });
        assert!(matches!(error, SetupError::Quantity(_)), "{error}");
    }
    let error = refused(Failures { safe_command: Some(SafeCommand::Values(vec![0.0; 2])), ..Failures::default() });
    assert!(error.to_string().contains("safe command"), "{error}");
}
