//! A vehicle of unknown mass by a measured acceleration. Not from the paper, whose Remark 8 names such laws for contrast.
//!
//! In the manner of that literature, derived here. (57) and (58) stay as they are, and z comes from (24) of order two in the place of
//! (49), which is of order three:
//!
//! ```text
//! z̈ = −(α+β) ż − αβ x̃' − Σ w [ż + (α+β) x̃' + αβ x̃ − αβ x̃_j(t−T)]
//! w = (z̈ + d⃛) + α* (ż + d̈) − α* g e₃,    s = ẋ − (z + ḋ),    u = m̂ w,    m̂' = −γ* wᵀ ṡ
//! ```
//!
//! z̈ jumps where the network switches, and w with it. So wᵀṡ cannot be integrated by parts, for ẇ is no function, and ṡ = ẍ − ż − d̈ takes
//! a measured ẍ. What one more order of the reference buys is that sensor, and input that is differentiable.
//!
//! **Proof.** As for (57): m s̈ = −α* m ṡ + (m̂ − m) w, and V = ½ m |ṡ|² + (m̂ − m)²/2γ* loses α* m |ṡ|². So ṡ is bounded and
//! square-integrable and m̂ is bounded. With ẍ = ż + ṡ in (24) of order two ṡ is an input of a linear system that agrees, whose velocities
//! are bounded with it; so w is, hence s̈, hence ṡ → 0, and vehicles agree as under Theorem 5. Bounds of m̂ are kept as in the head of
//! `thrust`, with what is integrated for μ.
//!
//! **The thrust is a state of the plant**, its rate an input: ẍ follows σ at once, and a law that sets σ could not measure an ẍ that is not
//! its own doing. What the sensor gives is without the part of a push.
//!
//! **What this costs.** A bias e of the accelerometer makes m̂' = −γ* wᵀ(ṡ + e), and
//!
//! ```text
//! V̇ = −α* m |ṡ|² − (m̂ − m) wᵀe
//! ```
//!
//! whose last term has no sign. w does not vanish: at rest it is −α* g e₃. So e₃ is taken for a wrong mass: m̂ → m g/(g − e₃) with ṡ → −e₃.
//! Then ż₃ = e₃ where all move evenly, and z̈ = 0 of vehicles with the same e₃, without delays, on a fixed graph with a spanning tree, leaves
//!
//! ```text
//! ẋ₃ = −e₃ (α + β + d) / (αβ + d (α+β)),   d = Σ γᵢ dᵢ,   γᵀL = 0,   Σ γᵢ = 1
//! ```
//!
//! so that they drift together for ever, at between e₃/(α+β) and e₃ (α+β)/(αβ). By parts, (58) reads no ẍ.

use alloc::vec;
use alloc::vec::Vec;

use super::{Floor, Yaw, backward, begin_reference, check_target, driving, learnt};
use crate::LengthError;
use crate::attitude::dot;
use crate::controller::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::law::Range;
use crate::plant::{AcceleratedVehicle, VehicleState};
use crate::reference::{Consensus, Measured, Position, Reference, ReferenceOut, RootSet, RootsError};
use crate::signal::{Block, Signal};

/// What is measured of a vehicle with an accelerometer.
#[derive(Clone, Copy, Debug)]
pub struct AccelerationMeasured<'a> {
    /// x, ẋ and the attitude.
    pub at: VehicleState<'a>,
    /// σ, N.
    pub thrust: f64,
    /// ẍ.
    pub ddx: &'a [f64; 3],
}

/// Control of a thrust-propelled vehicle of unknown mass whose acceleration is measured.
///
/// State: z, ż, ψ_r, and m̂ less m̂(0). Shown: z, ż, s, m̂, the measured ẍ, σ.
///
/// **Source**: own derivation, in the manner of what Remark 8 compares Theorem 5 with. **Measures**: x, ẋ, attitude, ẍ, σ.
/// **Transmits**: x, or x − d in a formation.
/// **Requires**: two positive roots, positive α* and γ*; a network as for Theorem 3 with (24); σ away from zero; d with three bounded
/// derivatives.
/// **Guarantees**: x̃_i − x̃_j → 0 and x̃_i' → 0. ω₁, ω₂ and σ̇ jump where the network switches.
///
/// Gravity tells the mass: where all agree at rest, too much of it lets the estimate fall once the vehicle rises.
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, Jets, ThrustByAcceleration};
/// use forwardstep_core::plant::{AcceleratedVehicle, Plant, Vehicle};
/// use forwardstep_core::reference::Heard;
///
/// let (believed, alpha_star, gamma_star) = (1.5, 4.0, 0.2);
/// let law = ThrustByAcceleration::new([alpha_star, gamma_star], [1.0, 2.0], believed, 9.81)?;
/// for (mass, sign) in [(1.5, 0.0), (1.2, -1.0), (1.8, 1.0)] {
///     let plant = AcceleratedVehicle { vehicle: Vehicle { mass, gravity: 9.81 }, bias: [0.0; 3] };
///     let at_rest = [0.5, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, believed * 9.81];
///     let mut output = [0.0; 14];
///     plant.output(&mut (), &at_rest, &mut output)?;
///     let heard = Heard::new(&[1.0], &at_rest[..3], 3)?;
///     let given = ControllerInput { measured: law.see(&output)?, heard, target: Jets::NONE };
///     let (mut state, mut d_state, mut shown) = ([0.0; 8], [0.0; 8], [0.0; 14]);
///     law.start(&mut (), given, &[], &mut state)?;
///     law.evaluate(&mut (), given, &state, ControllerOutput { input: &mut [0.0; 4], d_state: &mut d_state, shown: &mut shown })?;
///     // ẍ₃ = g (1 − m̂/m) and w₃ = −α* g
///     assert!((d_state[7] - gamma_star * alpha_star * 9.81 * 9.81 * (1.0 - believed / mass)).abs() < 1e-9);
///     assert_eq!(d_state[7].partial_cmp(&0.0), sign.partial_cmp(&0.0));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ThrustByAcceleration {
    consensus: Consensus<Position>,
    /// α*, 1/s, and γ*, kg s²/m².
    gains: [f64; 2],
    /// m̂(0), kg.
    pub mass: f64,
    /// g, m/s².
    pub gravity: f64,
    /// What ω₃ is used for.
    pub yaw: Yaw,
    /// What happens near σ = 0.
    pub floor: Floor,
    /// Where m is known to be, kg.
    pub bounds: Option<Range>,
}

/// Numbers in z, ż.
const REFERENCE: usize = 6;
/// Numbers in the state, and in what is shown.
const STATE: usize = REFERENCE + 2;
const SHOWN: usize = REFERENCE + 8;

/// What one instant holds: s, ṡ by the measured ẍ, w and z̈.
struct Errors {
    s: [f64; 3],
    ds: [f64; 3],
    w: [f64; 3],
    ddz: [f64; 3],
}

impl ThrustByAcceleration {
    /// A vehicle that is believed to have `mass` at the start, keeps heading zero and stops where σ falls to a tenth of that weight. The
    /// roots −α and −β are in 1/s; the gains are α* and γ*.
    ///
    /// # Errors
    /// [`RootsError`] when a root is not positive, or there are not two.
    pub fn new(gains: [f64; 2], roots_per_s: impl Into<RootSet>, mass: f64, gravity: f64) -> Result<Self, RootsError> {
        let roots = roots_per_s.into();
        if roots.len() != 2 {
            return Err(RootsError::Order { need: 2, got: roots.len() });
        }
        Ok(ThrustByAcceleration {
            consensus: Consensus::new([(roots, 0.0)])?,
            gains,
            mass,
            gravity,
            yaw: Yaw { heading: 0.0, rate: 0.0, gain: 1.0 },
            floor: Floor::Stops(0.1 * mass * gravity),
            bounds: None,
        })
    }

    fn errors(&self, given: ControllerInput<'_, Self>, state: &[f64]) -> Result<Errors, LengthError> {
        LengthError::check("state", STATE, state.len())?;
        check_target(given.target)?;
        let AccelerationMeasured { at, ddx, .. } = given.measured;
        let d = |k: usize, r: usize| given.target.get(k).map_or(0.0, |jet| jet[r]);
        let x: [f64; 3] = core::array::from_fn(|k| at.x[k] - d(k, 0));
        let dx: [f64; 3] = core::array::from_fn(|k| at.dx[k] - d(k, 1));
        let (mut z, mut dz, mut rate) = ([0.0; 3], [0.0; 3], [0.0; REFERENCE]);
        let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
        self.consensus.evaluate(3, Measured { q: &x, dq: &dx }, &state[..REFERENCE], given.heard, out)?;
        let [alpha_star, _] = self.gains;
        let ddz = [rate[3], rate[4], rate[5]];
        let w = driving(&dz, &ddz, given.target, [alpha_star, self.gravity]);
        let s = core::array::from_fn(|k| dx[k] - z[k]);
        Ok(Errors { s, ds: core::array::from_fn(|k| ddx[k] - dz[k] - d(k, 2)), w, ddz })
    }

    /// What is found of the mass, and what the law uses.
    fn found(&self, state: &[f64]) -> [f64; 2] {
        let mu = self.mass + state[REFERENCE + 1];
        [mu, self.bounds.map_or(mu, |range| range.nearest(mu))]
    }
}

impl Controller for ThrustByAcceleration {
    type Plant = AcceleratedVehicle;
    type Exchange = Position;
    type Measured<'a> = AccelerationMeasured<'a>;
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["position", "velocity", "attitude", "acceleration", "thrust"];
    const KNOWS_OFFSETS: bool = true;

    fn target_derivatives(&self) -> usize {
        // Those that the reference dynamics are differentiated into.
        3
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Block> {
        vec![(Signal::Reference(0), 3), (Signal::Reference(1), 3), (Signal::Heading, 1), (Signal::Estimate, 1)]
    }

    fn shown(&self) -> Vec<Block> {
        vec![
            (Signal::Reference(0), 3),
            (Signal::Reference(1), 3),
            (Signal::TrackingError, 3),
            (Signal::Estimate, 1),
            (Signal::Acceleration, 3),
            (Signal::Divisor, 1),
        ]
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::Attitude | Signal::Thrust | Signal::Acceleration)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<AccelerationMeasured<'a>, LengthError> {
        let (at, rest) = VehicleState::read(output)?;
        let short = LengthError { what: "thrust and acceleration", need: 4, got: rest.len() };
        let [thrust, ddx @ ..] = rest else { return Err(short) };
        Ok(AccelerationMeasured { at, thrust: *thrust, ddx: ddx.try_into().map_err(|_| short)? })
    }

    fn start(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", STATE, state.len())?;
        let (reference, rest) = state.split_at_mut(REFERENCE);
        begin_reference(reference, given.measured.at.dx, given.target, wanted)?;
        rest.copy_from_slice(&[self.yaw.heading, 0.0]);
        Ok(())
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        LengthError::check("input", 4, asked.input.len())?;
        LengthError::check("rate", STATE, asked.d_state.len())?;
        LengthError::check("shown", SHOWN, asked.shown.len())?;
        let Errors { s, ds, w, ddz } = self.errors(given, state)?;
        let AccelerationMeasured { at, thrust, ddx } = given.measured;
        let ([alpha_star, gamma_star], [mu, mass]) = (self.gains, self.found(state));

        let v = backward(*at.attitude, w.map(|w| mass * w));
        asked.input[0] = self.floor.kept(thrust, v[2] - alpha_star * thrust);
        asked.input[1] = -v[1] / thrust;
        asked.input[2] = v[0] / thrust;
        asked.input[3] = self.yaw.turn(*at.attitude, state[REFERENCE]);

        asked.d_state[..3].copy_from_slice(&state[3..REFERENCE]);
        asked.d_state[3..REFERENCE].copy_from_slice(&ddz);
        asked.d_state[REFERENCE] = self.yaw.rate;
        asked.d_state[REFERENCE + 1] = -gamma_star * dot(w, ds) - alpha_star * (mu - mass);

        asked.shown[..REFERENCE].copy_from_slice(&state[..REFERENCE]);
        let [x, y, z] = *ddx;
        asked.shown[REFERENCE..REFERENCE + 3].copy_from_slice(&s);
        asked.shown[REFERENCE + 3..].copy_from_slice(&[mass, x, y, z, thrust]);
        Ok(())
    }

    fn trouble(&self, _: &[f64], shown: &[f64]) -> Option<Singularity> {
        self.floor.trouble(*shown.get(SHOWN - 1)?)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, AcceleratedVehicle>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        _: &[f64],
    ) -> Result<Balance, LengthError> {
        let Errors { ds, w, .. } = self.errors(given, state)?;
        let AcceleratedVehicle { vehicle, bias } = truth.plant;
        let ([alpha_star, gamma_star], [mu, _], mass) = (self.gains, self.found(state), vehicle.mass);
        let ds: [f64; 3] = core::array::from_fn(|k| ds[k] - bias[k]);
        let (mut value, mut lost) = (0.5 * mass * dot(ds, ds), alpha_star * mass * dot(ds, ds));
        if gamma_star > 0.0 {
            let [learnt, beyond, delta] = learnt(self.bounds, mu, mass);
            value += learnt / gamma_star;
            lost += alpha_star / gamma_star * beyond + delta * dot(w, *bias);
        }
        Ok(Balance { value, dissipation: lost })
    }
}
