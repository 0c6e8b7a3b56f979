//! The simulator's sampled controllers, driven from outside by nothing but the public interface: the same bits, for every kind
//! of system.

use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::reference::Consensus;
use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::agent::{Inbox, StepError};
use forwardstep_core::plant::total;
use forwardstep_core::robot::tree::Uncertain;
use forwardstep_core::sampled::{
    Arrival, BeforeFirst, Counts, Keep, Limits, Mailbox, SafeCommand, Sampled, StartState,
};
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, Loss, PacketLink};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Adaptive, AgentSetup, Ending, Observers, Outcome, Sensors, Setup, SetupError, Signal, Start, TimeSpan,
    VelocitySensor, recipe, recipes, simulate_with,
};

/// Exact in binary, so that rows of the recording and samples are the same instants.
const HZ: f64 = 512.0;

/// Digital control, every sample recorded.
fn at_samples(mut setup: Setup, end_s: f64) -> Setup {
    setup = crate::common::sampled(setup, HZ);
    setup.time.end_s = end_s;
    setup.time.record_every_s = 1.0 / HZ;
    setup
}

fn controllers(setup: &Setup) -> Vec<Box<dyn Sampled>> {
    recipes(setup).unwrap().iter().map(|recipe| recipe.build().unwrap()).collect()
}

/// What one controller took and gave at one sample of a run.
struct Logged {
    now_s: f64,
    measured: Vec<f64>,
    message: Vec<f64>,
    degree: f64,
    sums: Vec<f64>,
    command: Vec<f64>,
}

/// A run, and what every agent took and gave, sample by sample.
fn logged(setup: &Setup) -> (Outcome, Vec<Vec<Logged>>) {
    let mut log: Vec<Vec<Logged>> = setup.agents.iter().map(|_| Vec::new()).collect();
    let outcome = simulate_with(
        setup,
        &mut |_| ControlFlow::Continue(()),
        Observers {
            samples: Some(&mut |taken| {
                assert_eq!(taken.sample as usize, log[taken.agent].len());
                log[taken.agent].push(Logged {
                    now_s: taken.now_s,
                    measured: taken.measured.to_vec(),
                    message: taken.message.to_vec(),
                    degree: taken.inbox.degree,
                    sums: taken.inbox.sums.to_vec(),
                    command: taken.command.to_vec(),
                });
            }),
            ..Observers::default()
        },
    );
    let outcome = outcome.unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    (outcome, log)
}

/// The edges of the graph in force.
fn graph(schedule: &Schedule, t_s: f64) -> &[Edge] {
    let segment = schedule.segments().find(|segment| t_s < segment.end_s - 1e-9).unwrap();
    schedule.graph(segment.graph)
}

fn assert_bits(what: &str, row: usize, agent: usize, got: &[f64], want: &[f64]) {
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(got), bits(want), "{what}, sample {row}, agent {agent}: {got:?} and {want:?}");
}

/// Sampled agents that measure what was measured in a run, and send each other messages: each goes by its edge's delay into the
/// mailbox of its receiver.
struct Replay<'a> {
    setup: &'a Setup,
    log: &'a [Vec<Logged>],
    agents: Vec<Box<dyn Sampled>>,
    mailboxes: Vec<Mailbox>,
    /// What everybody sent, sample by sample.
    sent: Vec<Vec<Vec<f64>>>,
}

impl<'a> Replay<'a> {
    fn new(setup: &'a Setup, log: &'a [Vec<Logged>]) -> Self {
        Replay { setup, log, agents: controllers(setup), mailboxes: Vec::new(), sent: Vec::new() }
    }

    /// Everybody's message, then the leader's.
    fn messages(&self, row: usize) -> Vec<Vec<f64>> {
        let t_s = self.log[0][row].now_s;
        let mut messages = Vec::new();
        for (controller, log) in self.agents.iter().zip(self.log) {
            let mut message = vec![0.0; controller.message_len()];
            controller.message(t_s, &log[row].measured, &mut message).unwrap();
            messages.push(message);
        }
        // An agent that leads has said its own.
        if let Some((following, leader)) =
            self.setup.following().and_then(|all| all.motion().map(|motion| (all, motion)))
        {
            let (m, len) = (leader.trajectory.axes(), messages[0].len());
            let mut jets = vec![[0.0; 5]; m];
            leader.trajectory.jets(t_s, &mut jets);
            let said = |k: usize| {
                let jet = &jets[k % m];
                match following.design {
                    FollowingDesign::Composite => {
                        following.beta.mul_add(jet[1], following.alpha.mul_add(jet[0], jet[2]))
                    }
                    _ => jet[k / m],
                }
            };
            messages.push((0..len).map(said).collect());
        }
        messages
    }

    fn sample(&mut self, row: usize) {
        let (network, t_s) = (&self.setup.network, self.log[0][row].now_s);
        let sample_hz = self.setup.control.as_ref().unwrap().sample_hz;
        self.sent.push(self.messages(row));
        if row == 0 {
            // Everybody is taken to have sent the first message for ever.
            let initial = |message: &Vec<f64>| BeforeFirst::Initial { stamp_s: 0.0, message: message.clone() };
            for agent in &self.agents {
                let initial = self.sent[0].iter().map(initial).collect();
                let mut mailbox = Mailbox::new(agent.message_len(), initial).unwrap();
                // Delays in theory may grow faster than time.
                mailbox.keep(Keep::Last);
                self.mailboxes.push(mailbox);
            }
        }
        let edges = graph(&network.schedule, t_s);
        for (receiver, mailbox) in self.mailboxes.iter_mut().enumerate() {
            let mut weights = vec![0.0; network.agents];
            for edge in edges.iter().filter(|edge| edge.to == receiver) {
                weights[edge.from] = network.weight_at(edge.weight, t_s);
                let delay = &network.delays[edge.delay];
                let sent_s = delay.sent_on(delay.piece_at(t_s + 1e-12), t_s);
                let stamp = ((sent_s * sample_hz + 1e-6).floor().max(0.0) as usize).min(row);
                let stamp_s = self.log[0][stamp].now_s;
                mailbox.post(t_s, edge.from, stamp_s, &self.sent[stamp][edge.from]).unwrap();
            }
            mailbox.set_weights(&weights).unwrap();
            let own = &self.sent[row][receiver];
            let inbox = match network.coupling {
                Coupling::Linear => mailbox.inbox(t_s),
                coupling => mailbox.inbox_through(t_s, own, |own, heard| coupling.taken(own, heard)).unwrap(),
            };
            let logged = &self.log[receiver][row];
            assert_bits("what is sent", row, receiver, own, &logged.message);
            assert_bits("degree", row, receiver, &[inbox.degree], &[logged.degree]);
            assert_bits("what is heard", row, receiver, inbox.sums, &logged.sums);
            self.agents[receiver].step(t_s, &logged.measured, inbox).unwrap();
            assert_bits("command", row, receiver, self.agents[receiver].command(), &logged.command);
        }
    }

    /// How many of the senders' messages became what, over all mailboxes.
    fn counts(&self) -> Counts {
        let mut all = Counts::default();
        for counts in self.mailboxes.iter().flat_map(|mailbox| (0..).map_while(|sender| mailbox.counts(sender))) {
            all.heard += counts.heard;
            all.late += counts.late;
            all.repeated += counts.repeated;
            all.refused += counts.refused;
        }
        all
    }
}

/// Steps all agents from outside; every number that they take and give is that of the run, and everything that they tell is what
/// the table has.
fn assert_same_bits(name: &str, setup: &Setup) -> Counts {
    let (outcome, log) = logged(setup);
    let mut replay = Replay::new(setup, &log);
    let exact = setup.control.as_ref().unwrap().sensors == Sensors::default();
    let mut compared = 0;
    for row in 0..log[0].len() {
        replay.sample(row);
        // The last row is seen from the left.
        for column in outcome.recording.columns.iter().filter(|_| row + 1 < outcome.recording.t_s.len()) {
            let agent = &replay.agents[column.agent];
            // The table has the state as it is, not as it was measured.
            let measured = agent.measures().iter().any(|(signal, _)| *signal == column.signal);
            let input = agent.inputs().iter().any(|(signal, _)| *signal == column.signal);
            // Of a spacecraft it shows what is asked of the wheels, and the table has what they do.
            let torque = column.signal == Signal::Torque && !input;
            let made_of_it =
                torque || !exact && !input && !matches!(column.signal, Signal::Reference(_) | Signal::Estimate);
            let transmitted = agent.diagnostics(column.signal).filter(|_| !measured && !made_of_it);
            if let (Some(transmitted), true) = (transmitted, outcome.recording.t_s[row] == log[0][row].now_s) {
                let what = format!("{name}, {:?} {}", column.signal, column.axis);
                assert_bits(
                    &what,
                    row,
                    column.agent,
                    &transmitted[column.axis..=column.axis],
                    &column.values[row..=row],
                );
                compared += 1;
            }
        }
    }
    let inputs: usize = replay.agents.iter().map(|agent| total(agent.inputs())).sum();
    assert!(log[0].len() > 100 && compared > 50 * inputs, "{name}: {compared} numbers of {} samples", log[0].len());
    let counts = replay.counts();
    assert_eq!(counts.refused, 0, "{name}");
    counts
}

#[test]
fn digest_every_kind_has_the_bits_of_the_simulator_when_it_is_driven_from_outside() {
    for (name, setup) in crate::common::every_kind() {
        let counts = assert_same_bits(name, &at_samples(setup.clone(), 2.0));
        assert_eq!(counts.late, 0, "{name}");
        // At a rate that binary numbers cannot write, with noise.
        let mut setup = crate::common::sampled(setup, 500.0);
        setup.time = TimeSpan { end_s: 1.0, record_every_s: 0.002, record_at: forwardstep_sim::RecordAt::Intervals };
        let control = setup.control.as_mut().unwrap();
        let measured = |agent: &AgentSetup| agent.interface().unwrap().measures_velocity;
        let velocity_noise = if setup.agents.iter().any(measured) { 1e-5 } else { 0.0 };
        control.sensors = Sensors { position_noise: 1e-6, velocity_noise, seed: 3, ..Sensors::default() };
        assert_same_bits(name, &setup);
    }
}

#[test]
fn digest_robots_with_encoders_and_limits_have_the_bits_of_the_simulator() {
    let mut late = 0;
    for case in crate::cases::cases() {
        let mut setup = at_samples(crate::cases::setup(&case), 1.5);
        let control = setup.control.as_mut().unwrap();
        control.sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 40.0 };
        control.sensors.position_quantum = 1e-6;
        let axes = setup.agents[0].robot.axes.len();
        control.actuators.torque_limit = Some(vec![15.0; axes]);
        control.actuators.torque_rate_limit = Some(vec![400.0; axes]);
        late += assert_same_bits(&case.name, &setup).late;
    }
    assert!(late > 10, "some delays grow faster than time");
}

#[test]
fn digest_a_tree_of_links_has_the_bits_of_the_simulator() {
    let mut setup = crate::common::single::anthropomorphic(Uncertain::Tool);
    setup.reference = Arc::new(Consensus);
    setup.network = crate::common::switching();
    let first = &mut setup.agents[0];
    let estimate_start = first.robot.theta.iter().map(|theta| 0.8 * theta).collect();
    let (damping, adaptation) = (Gain::Bandwidth(20.0), Gain::Bandwidth(3.0));
    first.law = Arc::new(Adaptive { damping, adaptation, estimate_start, bounds: None });
    (first.target, first.roots_per_s, first.manipulability) = (None, [1.0, 2.0, 3.0].into(), 0.4);
    for k in 1..3 {
        let name = format!("agent-{k}");
        let q = setup.agents[0].start.q.iter().map(|q| q + 0.3 * k as f64).collect();
        let start = Start { q, ..setup.agents[0].start.clone() };
        setup.agents.push(AgentSetup { name, start, ..setup.agents[0].clone() });
    }
    assert_same_bits("tree", &at_samples(setup, 2.0));
}

#[test]
fn digest_packets_by_a_nonlinear_protocol_have_the_bits_of_the_simulator() {
    let mut setup = at_samples(crate::common::chains::adaptive(), 2.0);
    let link = PacketLink {
        first_s: 0.0,
        every_s: 2.0 / HZ,
        latency_s: 3.0 / HZ,
        jitter_s: 12.0 / HZ,
        loss: Loss::Random { probability: 0.3 },
        most_in_a_row: None,
        seed: 5,
    };
    setup.network = crate::common::switching();
    setup.network.delays = vec![Delay::new(link.trace((0, 1), 2.0).unwrap())];
    setup.network.coupling = Coupling::Saturated { limit: 0.05 };
    let counts = assert_same_bits("packets", &setup);
    assert!(counts.heard > 100 && counts.repeated > 100 && counts.late == 0, "{counts:?}");
}

#[test]
fn alloc_sampled_controllers_and_mailboxes_never_allocate() {
    for (name, setup) in crate::common::every_kind() {
        let (_, log) = logged(&at_samples(setup.clone(), 0.25));
        for (agent, mut recipe) in recipes(&setup).unwrap().into_iter().enumerate() {
            for by_itself in [false, true] {
                if by_itself {
                    // Even where the first sample sets the state.
                    recipe.start = StartState::FirstSample { wanted: Vec::new() };
                }
                let mut controller = recipe.build().unwrap();
                let mut message = vec![0.0; controller.message_len()];
                let mut mailbox = Mailbox::new(message.len(), vec![BeforeFirst::Silent; 3]).unwrap();
                let counted = allocation_counter::measure(|| {
                    mailbox.set_weights(&[0.0, 0.5, 0.7]).unwrap();
                    for Logged { now_s, measured, .. } in &log[agent][..20] {
                        controller.message(*now_s, measured, &mut message).unwrap();
                        assert_eq!(mailbox.post(*now_s, 1, *now_s, &message), Ok(Arrival::Heard));
                        controller.step(*now_s, measured, mailbox.inbox(*now_s)).unwrap();
                        // A failure costs nothing either.
                        controller.step(*now_s, measured, mailbox.inbox(*now_s)).unwrap_err();
                        std::hint::black_box(controller.diagnostics(Signal::Reference(0)));
                    }
                });
                assert_eq!(counted.count_total, 0, "{name}, agent {agent}");
            }
        }
    }
}

#[test]
fn controllers_measure_what_their_laws_read_and_nothing_else() {
    let kinds = crate::common::every_kind();
    let kind = |name: &str| kinds.iter().find(|(kind, _)| *kind == name).unwrap().1.clone();
    let measures = |name: &str| controllers(&kind(name))[0].measures().to_vec();
    assert_eq!(measures("spacecraft"), [(Signal::Position, 4)]);
    assert_eq!(measures("passivity-filter"), [(Signal::Position, 4)]);
    assert_eq!(measures("masses-tracking").iter().map(|(signal, _)| *signal).collect::<Vec<_>>(), [Signal::Position]);
    let arm = [(Signal::Position, 2), (Signal::Velocity, 2), (Signal::TaskPosition, 2)];
    assert_eq!(measures("tip-of-a-planar-arm"), arm);
    assert_eq!(measures("vehicles-adaptive"), [(Signal::Position, 3), (Signal::Velocity, 3), (Signal::Attitude, 4)]);

    // With encoders velocities are made of positions, for the law and for the message.
    let mut setup = at_samples(kind("following-110"), 1.0);
    setup.control.as_mut().unwrap().sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 50.0 };
    let arm = recipe(&setup, 2).unwrap().build().unwrap();
    assert_eq!((arm.measures(), arm.message_len()), (&[(Signal::Position, 2)][..], 4));
    let error = recipe(&setup, 9).err().unwrap();
    assert_eq!(error, SetupError::NoAgent { agent: 9, agents: 4 });
}

#[test]
fn limits_that_are_enforced_are_those_of_the_recipe_with_and_without_digital_control() {
    let (_, mut setup) =
        crate::common::every_kind().into_iter().find(|(name, _)| *name == "tip-of-a-planar-arm").unwrap();
    assert_eq!(recipe(&setup, 0).unwrap().limits, None);
    let own = &mut setup.agents[0];
    own.enforce_limits = true;
    own.robot.axes[0].effort_limit = Some(50.0);
    own.robot.axes[1].effort_limit = Some(20.0);
    let rate = vec![f64::INFINITY; 2];
    assert_eq!(recipe(&setup, 0).unwrap().limits, Some(Limits { torque: vec![50.0, 20.0], rate }));
    let mut setup = crate::common::sampled(setup, 100.0);
    let actuators = &mut setup.control.as_mut().unwrap().actuators;
    actuators.torque_limit = Some(vec![30.0, 30.0]);
    actuators.torque_rate_limit = Some(vec![1e3, 2e3]);
    // Whole quanta only, so that rounding leads nowhere else.
    actuators.torque_quantum = 8.0;
    let limits = recipe(&setup, 0).unwrap().limits;
    assert_eq!(limits, Some(Limits { torque: vec![24.0, 16.0], rate: vec![1e3, 2e3] }));
}

#[test]
fn an_agent_that_starts_by_itself_comes_to_the_same_state_as_one_that_was_told() {
    // Without noise and delay the first sample holds all that the start was computed from.
    for (name, setup) in crate::common::every_kind() {
        let setup = at_samples(setup, 0.25);
        let (_, log) = logged(&setup);
        let mut transmitted = Replay::new(&setup, &log);
        transmitted.sample(0);
        for (k, mut recipe) in recipes(&setup).unwrap().into_iter().enumerate() {
            recipe.start = StartState::FirstSample { wanted: setup.agents[k].start.reference.clone() };
            let mut alone = recipe.build().unwrap();
            let Logged { now_s, measured, degree, sums, message, .. } = &log[k][0];
            let far = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-12 * (1.0 + a.abs());
            // What it says before it has started is what it will start with.
            let mut first = vec![0.0; alone.message_len()];
            alone.message(*now_s, measured, &mut first).unwrap();
            assert!(
                first.len() == message.len() && !first.iter().zip(message).any(far),
                "{name}: {first:?} {message:?}"
            );
            alone.step(*now_s, measured, Inbox { degree: *degree, sums }).unwrap();
            let (transmitted, alone) = (transmitted.agents[k].state(), alone.state());
            assert!(
                transmitted.len() == alone.len() && !transmitted.iter().zip(alone).any(far),
                "{name}: {transmitted:?} {alone:?}"
            );
        }
    }
}

#[test]
fn a_law_that_would_divide_by_nothing_fails_with_its_reason() {
    let (_, setup) = crate::common::every_kind().into_iter().find(|(name, _)| *name == "vehicles-adaptive").unwrap();
    let mut recipe = recipe(&setup, 0).unwrap();
    recipe.safe = SafeCommand::Values(vec![5.0, 0.0, 0.0, 0.0]);
    let StartState::State(mut state) = recipe.start.clone() else { panic!("as in the run") };
    let measured = [0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let inbox = Inbox { degree: 0.0, sums: &[0.0; 3] };
    let mut hovering = recipe.build().unwrap();
    hovering.step(0.0, &measured, inbox).unwrap();
    let sigma = hovering.command()[0];
    assert!(sigma > 1.0);
    // σ is a state of the law; below its floor of 1 N the attitude means nothing.
    let at = state.iter().position(|x| *x == sigma).unwrap();
    state[at] = 0.5;
    recipe.start = StartState::State(state);
    let mut falling = recipe.build().unwrap();
    let error = falling.step(0.0, &measured, inbox).unwrap_err();
    assert!(matches!(error, StepError::Singular { signal: Signal::Thrust, floor: 1.0, .. }), "{error}");
    assert_eq!(falling.command(), [5.0, 0.0, 0.0, 0.0]);
}
