//! Reference dynamics from outside: what is asked of them, and what becomes of those that are something else.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::reference::{
    AxisInput, AxisOutput, Choice, Derived, Heard, Measured, PerAxis, Position, PositionVelocity, Reference,
    ReferenceOut, Sliding,
};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::probe::{Identity, STATES, probe_reference};
use forwardstep_sim::reference::{
    Consensus, Dynamics, LinearReference, LinearTerms, PureIntegral, ReferenceDynamics, ReferenceFamily,
    ReferenceInterface, ReferenceWords, Roots,
};
use forwardstep_sim::system::{Declaration, Known as Knowledge};
use forwardstep_sim::{
    AgentSetup, Assembly, BreakdownCause, Ending, Exchange, Known, Network, RobotSetup, Setup, SetupError, Signal,
    simulate,
};

/// z̈ = −2 ż − q̇ − d q + Σ_j w_ij q_j, in one of several ways.
#[derive(Clone, Debug)]
struct Own {
    way: Way,
    exchange: Exchange,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// As it is written, with a number added.
    Plain,
    /// It is not affine in ż.
    Saturated,
    /// Neither, and it says so.
    SaturatedAndSaysSo,
    /// What multiplies z depends on q.
    Bilinear,
    /// Axes have different coefficients.
    Uneven,
    /// The second state is not the rate of the first.
    NotARate,
    /// ż is not the rate of z.
    OtherAcceleration,
    /// It starts from half of what was asked for.
    Halved,
    /// It does not say what its linear form is, or says something else: by itself, beside the weights, of what is heard, without the
    /// number, with q̈, with a derivative of z that there is not, and of another order.
    SaysNothing,
    SaysOtherOwn,
    SaysOtherCoupled,
    SaysOtherHeard,
    SaysNoConstant,
    SaysAcceleration,
    SaysTooMuch,
    SaysOtherOrder,
    SaysNextOrder,
    /// Not a number.
    NotANumber,
    /// It is built for one agent more.
    OneMore,
    /// It says that more of its state is z, ż, … than there is.
    TooManyDerivatives,
    /// It has a set-valued sign.
    Sign,
    /// What it says is exchanged, it does not hear.
    OtherExchange,
}

impl ReferenceDynamics for Own {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "an own reference", key: "own" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface {
            family: ReferenceFamily::Own,
            exchanges: &[Exchange::Position, Exchange::PositionVelocity],
            roots: Roots::None,
            manipulability: false,
            nonlinear_coupling: false,
        }
    }

    fn free_derivatives(&self, _: usize) -> usize {
        2
    }

    fn known(&self) -> Knowledge {
        Knowledge::Declared(Declaration { source: "no proof".into(), promises: "nothing".into(), claims: Vec::new() })
    }

    /// z̈ = −2 ż − q̇ + Σ w [heard − q] + 0.3, or something else.
    fn linear(&self, _: &AgentSetup, exchange: Exchange) -> Option<LinearReference> {
        let velocity = if exchange == Exchange::Position { 0.0 } else { -1.0 };
        let mut linear = LinearReference {
            order: 2,
            own: LinearTerms { q: vec![0.0, -1.0], z: vec![0.0, -2.0] },
            constant: true,
            coupled: LinearTerms { q: vec![-1.0], z: Vec::new() },
            heard: [-1.0, velocity],
        };
        match self.way {
            Way::SaysNothing | Way::SaturatedAndSaysSo => return None,
            Way::SaysOtherOwn => linear.own.z[1] = -2.000_1,
            Way::SaysOtherCoupled => linear.coupled.z = vec![1e-4],
            Way::SaysOtherHeard => linear.heard[1] += 1e-4,
            Way::SaysNoConstant => linear.constant = false,
            Way::SaysAcceleration => linear.own.q.push(1e-4),
            Way::SaysTooMuch => linear.own.z.push(1e-4),
            Way::SaysOtherOrder => linear.order = 4,
            Way::SaysNextOrder => linear.order = 3,
            _ => {}
        }
        Some(linear)
    }

    fn check(&self, _: &Setup) -> Result<(), SetupError> {
        Ok(())
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        let way = self.way;
        let agents = assembly.agents().len() + usize::from(way == Way::OneMore);
        let derivatives = if way == Way::TooManyDerivatives { 3 } else { 2 };
        let positions = |exchange| (exchange == Exchange::Position) != (way == Way::OtherExchange);
        if positions(self.exchange) {
            let law = move |given: AxisInput<'_, '_, Position>, asked: &mut AxisOutput<'_, '_>| {
                step(way, &given, given.heard_position(), asked);
            };
            let inner = PerAxis::new([agents, 2, derivatives], law);
            return Ok(Dynamics::position(Spoilt { inner, way, sliding: sliding() }));
        }
        let law = move |given: AxisInput<'_, '_, PositionVelocity>, asked: &mut AxisOutput<'_, '_>| {
            step(way, &given, given.heard_position() + given.heard_velocity(), asked);
        };
        let inner = PerAxis::new([agents, 2, derivatives], law);
        Ok(Dynamics::position_velocity(Spoilt { inner, way, sliding: sliding() }))
    }
}

fn step<X: forwardstep_core::reference::Exchange>(
    way: Way,
    given: &AxisInput<'_, '_, X>,
    heard: f64,
    asked: &mut AxisOutput<'_, '_>,
) {
    let (z, dz) = (given.state(0), given.state(1));
    let ddz = -2.0 * dz - given.dq() - given.degree() * given.q() + heard + 0.3;
    let ddz = match way {
        Way::Saturated | Way::SaturatedAndSaysSo => ddz.tanh(),
        Way::Bilinear => ddz - 0.5 * given.q() * z,
        Way::Uneven => ddz - given.axis() as f64 * z,
        Way::NotANumber => f64::NAN,
        _ => ddz,
    };
    asked.reference(z, if way == Way::OtherAcceleration { 0.0 } else { dz });
    asked.rate(0, if way == Way::NotARate { dz + 0.1 * given.q() } else { dz });
    asked.rate(1, ddz);
    // What there is not is not written.
    asked.rate(7, 1.0);
    assert!(given.state(7).is_nan());
}

fn sliding() -> Sliding {
    Sliding { derived: Derived::Nothing, alpha: 1.0, beta: 1.0, gamma: 1.0, choice: Choice::Implicit }
}

/// Dynamics whose start, or whose sign, is another.
struct Spoilt<R> {
    inner: R,
    way: Way,
    sliding: Sliding,
}

impl<R: Reference> Reference for Spoilt<R> {
    type Exchange = R::Exchange;

    fn agents(&self) -> usize {
        self.inner.agents()
    }

    fn vectors(&self) -> usize {
        self.inner.vectors()
    }

    fn derivatives(&self) -> usize {
        self.inner.derivatives()
    }

    fn sliding(&self) -> Option<&Sliding> {
        (self.way == Way::Sign).then_some(&self.sliding)
    }

    fn is_affine(&self) -> bool {
        self.way != Way::SaturatedAndSaysSo
    }

    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, R::Exchange>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        self.inner.evaluate(axes, measured, state, heard, out)
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, R::Exchange>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.inner.start(axes, measured, given, heard, state)?;
        if self.way == Way::Halved {
            state.iter_mut().for_each(|entry| *entry *= 0.5);
        }
        Ok(())
    }
}

/// Two masses that hear each other.
fn setup(way: Way, exchange: Exchange) -> Setup {
    let mass = |k: usize| {
        AgentSetup::new(format!("mass-{k}"), RobotSetup::point_mass(2, 1.0 + k as f64), Known::gain(5.0))
            .at(&[k as f64, -0.5])
    };
    let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::constant(0.2));
    Setup::new(vec![mass(0), mass(1)], Arc::new(Own { way, exchange }), exchange, network, 3.0)
}

/// Shipped ones say their form too, (3) and (23) that of the derivative of what they integrate.
#[test]
fn what_shipped_reference_dynamics_say_of_themselves_is_so() {
    let shipped: [(Arc<dyn ReferenceDynamics>, &[usize]); 2] =
        [(Arc::new(Consensus), &[1, 2, 3, 6]), (Arc::new(PureIntegral), &[2])];
    for ((reference, orders), exchange) in shipped.iter().flat_map(|kind| EXCHANGES.map(|exchange| (kind, exchange))) {
        for order in orders.iter().filter(|order| exchange == Exchange::PositionVelocity || **order > 1) {
            let mut setup = setup(Way::Plain, exchange);
            setup.reference = Arc::clone(reference);
            for (i, agent) in setup.agents.iter_mut().enumerate() {
                agent.roots_per_s =
                    (0..*order).map(|r| 0.5 + 0.7 * r as f64 + 0.1 * i as f64).collect::<Vec<_>>().into();
                agent.manipulability = 0.3;
            }
            assert!(setup.reference.linear(&setup.agents[0], exchange).is_some());
            let probe = probe_reference(&setup).unwrap();
            assert_eq!((probe.states, probe.found), (STATES, None), "{order} {exchange:?}");
        }
    }
}

const EXCHANGES: [Exchange; 2] = [Exchange::Position, Exchange::PositionVelocity];

#[test]
fn what_they_say_of_themselves_is_found_out() {
    for exchange in EXCHANGES {
        for (way, found) in [
            (Way::Plain, None),
            (Way::SaysNothing, None),
            (Way::SaysOtherOwn, Some(Identity::LinearForm)),
            (Way::SaysOtherCoupled, Some(Identity::LinearForm)),
            (Way::SaysOtherHeard, Some(Identity::LinearForm)),
            (Way::SaysNoConstant, Some(Identity::LinearForm)),
            (Way::SaysAcceleration, Some(Identity::LinearForm)),
            (Way::SaysTooMuch, Some(Identity::LinearForm)),
            (Way::SaysOtherOrder, Some(Identity::LinearOrder)),
            (Way::SaysNextOrder, Some(Identity::LinearForm)),
            (Way::Saturated, Some(Identity::Affine)),
            (Way::SaturatedAndSaysSo, None),
            (Way::Bilinear, Some(Identity::Affine)),
            (Way::Uneven, Some(Identity::Axes)),
            (Way::NotARate, Some(Identity::Derivatives)),
            (Way::OtherAcceleration, Some(Identity::Derivatives)),
            (Way::Halved, Some(Identity::Start)),
        ] {
            let probe = probe_reference(&setup(way, exchange)).unwrap();
            assert_eq!(probe.found.as_ref().map(|found| found.identity), found, "{way:?}");
            assert_eq!(probe.states == STATES, found.is_none(), "{way:?}");
        }
        let probe = probe_reference(&setup(Way::NotANumber, exchange)).unwrap();
        assert_eq!((probe.states, probe.found), (0, None));
    }
}

#[test]
fn what_cannot_be_run_is_refused_with_the_reason() {
    for exchange in EXCHANGES {
        let refused = |way| simulate(&setup(way, exchange), &mut |_| ControlFlow::Continue(())).err().unwrap();
        let reference = "an own reference";
        let shape = |what, need, got| SetupError::ReferenceShape { reference, error: LengthError { what, need, got } };
        assert_eq!(refused(Way::OneMore), shape("agents", 2, 3));
        assert_eq!(refused(Way::TooManyDerivatives), shape("derivatives of z in the state", 2, 3));
        assert_eq!(refused(Way::Sign), SetupError::SignWithoutLeader { reference });
        assert_eq!(refused(Way::OtherExchange), SetupError::ReferenceExchange { reference, exchange });
        for error in [refused(Way::OneMore), refused(Way::Sign), refused(Way::OtherExchange)] {
            assert_eq!(error.path(&setup(Way::Plain, exchange)).to_string(), "reference");
        }
    }
}

#[test]
fn what_is_not_a_number_breaks_the_run_down() {
    for exchange in EXCHANGES {
        for sampled in [false, true] {
            let mut setup = setup(Way::NotANumber, exchange);
            if sampled {
                setup = setup.sampled(50.0);
            }
            let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
            let Ending::BrokeDown(breakdown) = outcome.ending else { panic!("{:?}", outcome.ending) };
            assert_eq!(breakdown.cause, BreakdownCause::NotFinite);
        }
    }
}

#[test]
fn their_state_is_recorded_and_sampling_tends_to_continuous_time() {
    for exchange in EXCHANGES {
        let run = |setup: &Setup| simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap().recording;
        for way in [Way::Plain, Way::SaturatedAndSaysSo] {
            let continuous = run(&setup(way, exchange));
            let of = |signal| continuous.columns.iter().filter(|column| column.signal == signal).count();
            assert_eq!([of(Signal::Reference(0)), of(Signal::Reference(1)), of(Signal::Reference(2))], [4, 4, 0]);
            let apart = |hz| {
                let sampled = run(&setup(way, exchange).sampled(hz));
                (sampled.last(0, Signal::Position, 0) - continuous.last(0, Signal::Position, 0)).abs()
            };
            let [coarse, fine] = [apart(50.0), apart(400.0)];
            assert!(fine < 0.2 * coarse && coarse < 0.05, "{coarse} {fine}");
        }
    }
}
