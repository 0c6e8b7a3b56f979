//! Offsets that take a thrust to zero.

use forwardstep_check::{Answer, Id, check};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Trajectory};
use forwardstep_sim::{Exchange, ThrustKind};

use crate::common::kinds::{fading_power_of_time, rest_at, vehicle};
use crate::common::{edge, setup};

/// What is said of the thrust of two vehicles of 2 kg with a floor of 0.5 N, of which one keeps this offset.
fn thrust(design: ThrustKind, offset: [Path; 3]) -> (Answer, String) {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)];
    let two = vec![vehicle(design, Floor::Stops(0.5)), vehicle(design, Floor::Stops(0.5))];
    let mut setup = setup(two, Exchange::Position, Schedule::fixed(edges), vec![Delay::constant(0.0)], 60.0);
    setup.agents[0].target = Some(Trajectory::new(offset.to_vec()).unwrap());
    let found = check(&setup).hypotheses.into_iter().find(|hypothesis| hypothesis.id == Id::NonzeroThrust).unwrap();
    (found.answer(), found.because())
}

fn sine(size: f64, rad_per_s: f64) -> Path {
    Path::Formula((Expression::variable(0) * rad_per_s).sin_of() * size)
}

#[test]
fn regress_an_offset_beyond_free_fall_is_told_before_the_run() {
    let rest = || rest_at(0.0);
    for design in [ThrustKind::Continuous, ThrustKind::Differentiable { alpha_star: 4.0, stiffness: 20.0 }] {
        // 4 · 9 = 36 m/s², and 9.81 at its most: d̈ = g where the sine is −0.2725.
        let (answer, because) = thrust(design, [rest(), rest(), sine(4.0, 3.0)]);
        assert!(answer == Answer::NotShown && because.contains("at t = 1.139194 s"), "{because}");
        // Up to 9.7 m/s² 0.22 N are left, below the floor; up to 9.5 0.62 N.
        assert_eq!(thrust(design, [rest(), rest(), sine(9.7, 1.0)]).0, Answer::NotShown);
        assert_eq!(thrust(design, [rest(), rest(), sine(9.5, 1.0)]).0, Answer::Watched);
        // What moves it to the side meanwhile carries it.
        assert_eq!(thrust(design, [sine(4.0, 3.0), rest(), sine(4.0, 3.0)]).0, Answer::Watched);
        // Once is not again and again: nobody needs to agree by then.
        assert_eq!(thrust(design, [rest(), rest(), fading_power_of_time(40.0, 5.0)]).0, Answer::Watched);
    }
}
