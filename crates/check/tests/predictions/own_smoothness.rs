//! Jumps of the torque under reference dynamics from outside.

use std::sync::Arc;

use forwardstep_check::smoothness::Covered;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::{AxisInput, AxisOutput, PerAxis, Position, WrittenIn};
use forwardstep_sim::reference::{
    Backstepping, Desired, DesiredPolynomial, Dynamics, LinearReference, Protocol, ReferenceDynamics, ReferenceFamily,
    ReferenceInterface, ReferenceWords,
};
use forwardstep_sim::system::{Declaration, Known as Knowledge};
use forwardstep_sim::{AgentSetup, Assembly, Exchange, Setup, SetupError, Signal};

use super::smoothness::{arms, compare};

/// ż = y − 0.5 q + 0.2 and ẏ = −2 y − q̇ − Σ_j w_ij (q − q_j) + 0.3; ż is not affine if asked.
#[derive(Clone, Copy, Debug)]
struct Own {
    bent: bool,
}

impl ReferenceDynamics for Own {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "an own reference", key: "own" }
    }

    fn interface(&self) -> ReferenceInterface {
        let like = Backstepping { filter_s: 1.0, acceleration_limit: None };
        ReferenceInterface { family: ReferenceFamily::Own, ..like.interface() }
    }

    fn free_derivatives(&self, _: usize) -> usize {
        2
    }

    fn known(&self) -> Knowledge {
        Knowledge::Declared(Declaration { source: "no proof".into(), promises: "nothing".into(), claims: Vec::new() })
    }

    fn linear(&self, _: &AgentSetup, _: Exchange) -> Option<LinearReference> {
        None
    }

    fn check(&self, _: &Setup) -> Result<(), SetupError> {
        Ok(())
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        let bent = f64::from(u8::from(self.bent));
        let law = move |given: AxisInput<'_, '_, Position>, asked: &mut AxisOutput<'_, '_>| {
            let (z, y) = (given.state(0), given.state(1));
            let dz = y - 0.5 * given.q() + 0.2 + bent * given.q().sin();
            asked.reference(z, dz);
            asked.rate(0, dz);
            asked.rate(1, -2.0 * y - given.dq() - given.degree() * given.q() + given.heard_position() + 0.3);
        };
        Ok(Dynamics::position(PerAxis::new([assembly.agents().len(), 2, 1], law)))
    }
}

#[test]
fn own_reference_dynamics_show_themselves_how_many_derivatives_stay() {
    let mut setup = arms(Exchange::Position, 2);
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
    // Those that are not affine are not expanded, and the first variation says the same of them.
    for bent in [false, true] {
        setup.reference = Arc::new(Own { bent });
        let smoothness = compare(&setup, 2, false);
        let kind = Covered { signal: Signal::Torque, derivatives: 2, continuous: None };
        assert_eq!(smoothness.kinds(), [kind]);
        assert_eq!(smoothness.largest(kind, 0).map(|jump| jump.size), Some(0.0));
        assert!(smoothness.largest(kind, 1).unwrap().size > 0.1);
        let sides = smoothness.jumps.iter().flat_map(|jump| &jump.derivatives).flatten().map(|change| change.sides);
        assert!({ sides }.all(|sides| sides.is_none() == bent));
    }
}

/// A nonlinear protocol with the time in it jumps as the run does; it is not expanded, and the first variation tells.
#[test]
fn eq_43_the_torque_of_a_nonlinear_protocol_jumps_as_along_the_run() {
    let x = Expression::variable;
    for order in [2, 3] {
        let (heard, weights, t) = (x(order), x(order + 1), x(order + 2));
        let swell = Expression::number(2.0) + (t * 3.0).sin_of();
        let desired = Desired {
            polynomial: DesiredPolynomial::Coefficients([0.0, 2.0, 3.0][..order].to_vec()),
            coupling: None,
            heard: Vec::new(),
            follows_target: false,
            written: WrittenIn::Measured,
            protocol: Some(Protocol {
                term: swell * ((heard - weights * x(0)) * 2.0).tanh_of(),
                stable_because: None,
                input_to_state_stable_because: None,
            }),
        };
        let mut setup = arms(Exchange::Position, 2);
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
        setup.reference = Arc::new(desired);
        let smoothness = compare(&setup, 2, false);
        let sizes = |r: usize| {
            let jumps = smoothness.jumps.iter().filter_map(|jump| jump.derivatives.get(r)).flatten();
            jumps.map(|change| change.jump.abs()).fold(0.0, f64::max)
        };
        assert!(sizes(order - 2) > 0.1, "{order}: {}", sizes(order - 2));
        assert!((0..order - 2).all(|r| sizes(r) == 0.0), "{order}");
        let mut sides = smoothness.jumps.iter().flat_map(|jump| &jump.derivatives).flatten().map(|change| change.sides);
        assert!(sides.all(|sides| sides.is_none()));
    }
}
