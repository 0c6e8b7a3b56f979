//! Roots in closed form, and the residue at zero.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::robot::PointMass;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::reference::{Consensus, PureIntegral};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{AgentSetup, Axis, AxisUnit, Exchange, Known, Network, RobotSetup, Solver, Start, TimeSpan};

use super::*;
use crate::predict;

/// Masses on a line with these links.
fn masses(exchange: Exchange, roots: &[&[f64]], links: &[(usize, usize, f64, f64)]) -> Setup {
    let noise = |k: usize| libm::sin(12.9898 * k as f64 + 0.7);
    let agent = |(i, roots): (usize, &&[f64])| AgentSetup {
        name: format!("mass-{i}"),
        robot: RobotSetup {
            kind: Arc::new(PointMass { dimension: 1 }),
            theta: vec![1.0],
            theta_names: vec!["mass".into()],
            axes: vec![Axis {
                name: "x".into(),
                unit: AxisUnit::Metre,
                position_limits: None,
                velocity_limit: None,
                effort_limit: None,
            }],
        },
        roots_per_s: roots.to_vec().into(),
        manipulability: 0.0,
        law: Arc::new(Known { damping: Gain::Number(1.0) }),
        target: None,
        start: Start {
            q: vec![noise(i)],
            dq: vec![noise(i + 7)],
            rest: Vec::new(),
            reference: (0..roots.len()).map(|r| vec![noise(i + 7 + 9 * r)]).collect(),
        },
        enforce_limits: false,
        pushes: Vec::new(),
    };
    let edge = |(k, link): (usize, &(usize, usize, f64, f64))| Edge {
        from: link.0,
        to: link.1,
        weight: link.2.into(),
        delay: k,
    };
    Setup {
        agents: roots.iter().enumerate().map(agent).collect(),
        reference: Arc::new(Consensus),
        exchange,
        network: Network {
            agents: roots.len(),
            schedule: Schedule::fixed(links.iter().enumerate().map(edge).collect()),
            delays: links.iter().map(|link| Delay::constant(link.3)).collect(),
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s: 10.0, record_every_s: 0.1, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver::default(),
        control: None,
    }
}

fn ring(agents: usize, weight: f64, delay_s: f64) -> Vec<(usize, usize, f64, f64)> {
    (0..agents).map(|i| (i, (i + 1) % agents, weight, delay_s)).collect()
}

fn near(found: [f64; 2], wanted: C, tolerance: f64) {
    let away = size(C::new(found[0], found[1]) - wanted);
    assert!(away < tolerance, "{found:?}, not {wanted}");
}

#[test]
fn a_ring_without_delay_has_the_roots_of_its_laplacian() {
    // With velocities and one root everything but −κ₀ is −k (1 − e^(2πij/n)).
    for agents in [2, 3, 5, 12] {
        let setup = masses(Exchange::PositionVelocity, &vec![&[9.0][..]; agents], &ring(agents, 1.3, 0.0));
        let found = rate(&setup).unwrap();
        let angle = core::f64::consts::TAU / agents as f64;
        near(found.root_per_s, C::new(-1.3 * (1.0 - libm::cos(angle)), (1.3 * libm::sin(angle)).abs()), 1e-9);
        assert!(found.correction_per_s < 1e-9 && found.backward_error < 1e-12, "{found:?}");
        assert_eq!(found.multiplicity, 1);
    }
    // Everybody hears everybody: −n w, n − 1 times.
    let all = (0..25).map(|k| (k / 5, k % 5, 0.6, 0.0)).filter(|link| link.0 != link.1).collect::<Vec<_>>();
    let found = rate(&masses(Exchange::PositionVelocity, &[&[9.0][..]; 5], &all)).unwrap();
    near(found.root_per_s, C::from(-3.0), 1e-7);
    assert_eq!(found.multiplicity, 4);
    // Slower than that is −κ₀, once for every agent.
    let found = rate(&masses(Exchange::PositionVelocity, &[&[0.4][..]; 5], &all)).unwrap();
    near(found.root_per_s, C::from(-0.4), 1e-7);
    assert_eq!(found.multiplicity, 5);
}

#[test]
fn two_agents_with_a_delay_have_the_roots_of_lambert() {
    // (p + w)² = w² e^(−2pT) beside −κ₀, so p = W_k(±w T e^(wT))/T − w.
    let links = |w, t| vec![(0, 1, w, t), (1, 0, w, t)];
    let (w, t) = (1.5, 0.4);
    let found = rate(&masses(Exchange::PositionVelocity, &[&[9.0][..]; 2], &links(w, t))).unwrap();
    let p = C::new(found.root_per_s[0], found.root_per_s[1]);
    let late = characteristic::exp(-p * t) * w;
    assert!(size((p + w) * (p + w) - late * late) < 1e-9, "{found:?}");
    // W_0(−0.6 e^0.6) by Newton's method elsewhere.
    near(found.root_per_s, C::new(-2.139_547_332, 3.471_532_017), 1e-8);
}

#[test]
fn the_residue_at_zero_is_the_value_agreed_upon() {
    let links = [(0, 1, 1.5, 0.3), (1, 2, 0.7, 0.0), (2, 0, 1.1, 0.5), (0, 2, 0.4, 0.2), (2, 3, 1.0, 0.7)];
    let orders: [&[&[f64]]; 3] = [
        &[&[1.2][..]; 4],
        &[&[1.2, 2.0], &[1.2, 0.8], &[1.2, 1.2], &[1.2, 3.0]],
        &[&[1.2, 2.0, 1.0], &[1.2, 0.8], &[1.2], &[1.2, 3.0, 3.0, 2.0]],
    ];
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for (k, roots) in orders.iter().enumerate() {
            let mut setup = masses(exchange, roots, &links);
            for agent in &mut setup.agents {
                // z(0) = q̇(0), so that the velocities sent before the start are the same.
                agent.start.reference[0] = agent.start.dq.clone();
            }
            if k == 1 {
                setup.reference = Arc::new(PureIntegral);
            }
            let followed = ideal(&setup).unwrap();
            let wanted = predict(&setup).unwrap().value[0];
            let modes = all_modes(&followed).unwrap();
            for agent in 0..4 {
                let value = modes[0].at(0.0)[(agent, 0)];
                assert!((value - wanted).abs() < 1e-6, "{exchange:?}, {k}: {value}, not {wanted}");
            }
        }
    }
}

#[test]
fn of_several_roots_in_one_place_the_largest_disagreement_need_not_be_at_the_start() {
    // The second hears the first, which rests: q₂ − q₁ = (2 t e^(−t) + e^(−2t)) of what it is at the start.
    let mut setup = masses(Exchange::PositionVelocity, &[&[1.0, 2.0][..]; 2], &[(0, 1, 1.0, 0.0)]);
    for (agent, q) in setup.agents.iter_mut().zip([0.0, 3.0]) {
        agent.start = Start { q: vec![q], dq: vec![0.0], rest: Vec::new(), reference: Vec::new() };
    }
    let found = rate(&setup).unwrap();
    assert_eq!(found.multiplicity, 3);
    near(found.root_per_s, C::from(-1.0), 1e-6);
    // 2 t e^(−t) is largest at t = 1.
    assert!((found.excited - 6.0 / core::f64::consts::E).abs() < 1e-3, "{found:?}");
}

#[test]
fn a_large_network_is_decided_by_its_laplacian_if_all_is_uniform() {
    let agents = 80;
    let setup = masses(Exchange::Position, &vec![&[1.0, 2.0][..]; agents], &ring(agents, 1.0, 0.2));
    let large = rate(&setup).unwrap();
    // The same equation for the first eigenvalue of the ring.
    let mu = characteristic::exp(C::new(0.0, core::f64::consts::TAU / agents as f64));
    let p = C::new(large.root_per_s[0], large.root_per_s[1]);
    let rest = (p + 1.0) * (p + 1.0) * (p / 2.0 + 1.0) - mu * characteristic::exp(-p * 0.2);
    assert!(size(rest) < 1e-9 && p.re < -1e-4 && p.re > -1e-2, "{large:?}");
    let mut uneven = setup.clone();
    uneven.agents[3].roots_per_s.real[0] = 1.5;
    let too_large = Err(NoRate::TooLarge { unknowns: 80 * 3 + 80 * 6 });
    assert_eq!(rate(&uneven), too_large);
    for (weight, delay_s) in [(1.5, 0.2), (1.0, 0.3)] {
        let mut links = ring(agents, 1.0, 0.2);
        (links[7].2, links[7].3) = (weight, delay_s);
        assert_eq!(rate(&masses(Exchange::Position, &vec![&[1.0, 2.0][..]; agents], &links)), too_large);
    }
    let more = 201;
    let setup = masses(Exchange::Position, &vec![&[1.0, 2.0][..]; more], &ring(more, 1.0, 0.2));
    assert_eq!(rate(&setup), Err(NoRate::TooLarge { unknowns: more * 9 }));
}

/// The others of a network in which one agent hears no other have the roots of their own designs among those of the network.
#[test]
fn regress_roots_that_are_nearly_equal_are_told_apart() {
    for (roots, rightmost) in [
        (&[1.0, 1.01][..], 1.0),
        (&[1.0, 1.02, 3.0], 1.0),
        (&[1.0, 1.001], 1.0),
        (&[1.14, 1.15, 1.52, 1.69, 3.97], 1.14),
        (&[1.0, 1.0], 1.0),
    ] {
        let setup = masses(Exchange::PositionVelocity, &[roots; 2], &[(0, 1, 1.55, 0.1)]);
        let found = rate(&setup).unwrap();
        near(found.root_per_s, C::from(-rightmost), 1e-5);
        assert!(found.correction_per_s < 1e-5 && found.backward_error < 1e-9, "{roots:?}: {found:?}");
        assert!(found.multiplicity >= 2, "{roots:?}: {found:?}");
    }
}
