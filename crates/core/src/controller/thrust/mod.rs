//! Consensus of thrust-propelled vehicles: (45)–(46), (49)–(50), (57)–(58), alone or in formation.
//!
//! **Dynamic feedback linearisation.** The thrust σ is a state of the controller, its rate an input. From (44), with
//! S(ω) e₃ = (ω₂, −ω₁, 0) and any a,
//!
//! ```text
//! m x⃛ = −R (σ ω₂, −σ ω₁, σ̇)
//! m (x⃛ + a ẍ) − a m g e₃ = −R (σ ω₂, −σ ω₁, σ̇ + a σ) = u                    (45), (47)
//! v = −Rᵀ u   ⇒   ω₂ = v₁/σ,   ω₁ = −v₂/σ,   σ̇ = v₃ − a σ                     for σ ≠ 0
//! ```
//!
//! **Designs.** An agent may keep an offset d(t) of its own from where all agree. With x̃ = x − d,
//!
//! ```text
//! (46)   a = α + β + Σ w   u = m (ψ + d⃛ + a d̈) − a m g e₃
//!        ψ = −αβ x̃' − Σ w [(α+β) x̃' + αβ x̃ − αβ x̃_j(t−T)]
//!        so  x̃''' = −(α+β) x̃'' − αβ x̃' − Σ w [x̃'' + (α+β) x̃' + αβ x̃ − αβ x̃_j(t−T)]
//!
//! (50)   a = α*   u = m w − k s        (57)   a = α*   u = m̂ w        (58)   m̂' = −γ* wᵀ ṡ
//!        w = (z̈ + d⃛) + α* (ż + d̈) − α* g e₃,    s = ẋ − (z + ḋ),    z from (49) with x̃ in place of x
//! ```
//!
//! ψ is (24) of order two without its ż, and (49) is (24) of order three, so both come from [`Consensus`]. Without an offset
//! these are the paper's equations. With one, agents have to tell each other x̃ = x − d. All of them put the same law on
//! x̃ as the paper puts on x, so they agree on x̃: a formation, which translates and turns as the offsets say.
//!
//! **Proofs.** (47) and (50) give m s̈ = −α* m ṡ − k s, which is (52); with V = ½ m |ṡ|² + ½ k |s|²,
//!
//! ```text
//! V̇ = −α* m |ṡ|²
//! ```
//!
//! (47) and (57) give m s̈ = −α* m ṡ + (m̂ − m) w; with V = ½ m |ṡ|² + (m̂ − m)²/2γ* again V̇ = −α* m |ṡ|².
//!
//! **Pushes.** A force f from outside adds f/m to ẍ, and the laws know nothing of it. Let ρ be ṡ without that part, so that
//! ṡ = ρ + f/m and m ρ̇ is what m s̈ is above. V with ρ in the place of ṡ needs no derivative of f:
//!
//! ```text
//! V̇ = −α* m |ρ|² + (k/m) sᵀf  under (50),   V̇ = −α* m |ρ|² − (m̂ − m) wᵀf/m  under (57)
//! ```
//!
//! **m̂ without acceleration.** ṡ contains ẍ. By parts,
//!
//! ```text
//! m̂(t) = m̂(0) + I(t) − γ* (wᵀs)(t),   İ = γ* ẇᵀ s,   I(0) = γ* (wᵀs)(0),   ẇ = (z⃛ + d⁗) + α* (z̈ + d⃛)
//! ```
//!
//! The paper parts wᵀẍ, and wᵀż stays under the integral; that is the same number. Parting wᵀṡ keeps I small: where all
//! is well it tends to a constant, while ∫ wᵀż + ẇᵀẋ follows the motion.
//!
//! **Bounds.** wᵀṡ holds the acceleration, so m̂' cannot be slowed down at a bound: u takes Π(m̂) with what is found by parts for μ, as derived
//! in `law::clamped`, with ρ = α*. V has W/γ* for its last term, and loses (α*/γ*)(Π(μ) − m)(μ − Π(μ)) more.
//!
//! **Heading.** ω₃ is free. Let b = R e₁, where the body looks, and ψ_r the heading to keep, ψ̇_r = r. Then
//!
//! ```text
//! ω₃ = r + k_ψ (b₁ sin ψ_r − b₂ cos ψ_r)
//! ```
//!
//! where the bracket is sin(ψ_r − ψ) times the length of b's horizontal part. It needs no angle of the body, so it is smooth
//! everywhere, also where the body looks straight down. For an upright vehicle ψ̇ = ω₃ and ψ → ψ_r from all sides but the
//! opposite one.
//!
//! **σ near zero.** The law divides by σ. Either the run stops at a floor σ₀ > 0, or, if wanted, σ̇ is not let below
//! −(σ − σ₀)/T₀, so σ ≥ σ₀ for ever. Where that bound acts the vehicle does not do what u says, and no theorem holds.

mod accelerated;
mod cascade;
mod design;
#[cfg(test)]
mod tests;
mod vehicle;

pub use accelerated::{AccelerationMeasured, ThrustByAcceleration};
pub use cascade::{RateLoop, RotorcraftMeasured, ThrustCascade};
pub use design::{Floor, ThrustDesign, Yaw};

use alloc::vec::Vec;

use super::{Balance, Jets};
use crate::attitude::{Quaternion, cross, dot, rotate, rotate_back};
use crate::law::Range;
use crate::plant::{Vehicle, VehicleState};
use crate::reference::{
    Consensus, Heard, Measured, Position, Reference, ReferenceOut, RootSet, RootsError, polynomial,
};
use crate::signal::{Block, Signal};
use crate::{LengthError, sine_and_cosine};

/// Control of a thrust-propelled vehicle by its thrust and its angular velocity.
///
/// State: z, ż, z̈ (not under (46)), σ, ψ_r, and I under (58). Shown: z, ż, z̈, s (not under (46)), m̂ under
/// (58).
///
/// **Source**: (45)–(47), (49), (50), (57), (58), Theorems 4 and 5. **Measures**: x, ẋ, attitude. **Transmits**: x, or
/// x − d in a formation.
/// **Requires**: positive roots, α*, k and γ*; a network as for Theorem 3 with (24); σ away from zero; d with four bounded
/// derivatives.
/// **Guarantees**: x̃_i − x̃_j → 0 and x̃_i' → 0. Under (50) and (57) ω₁, ω₂ and σ̇ are differentiable through switches and
/// delay jumps.
/// **Deviates from the paper**: offsets; m̂ by parts as in the head of this file; a law for ω₃; a floor for σ.
///
/// It sees no acceleration:
///
/// ```compile_fail,E0609
/// fn acceleration(measured: forwardstep_core::plant::VehicleState<'_>) -> [f64; 3] {
///     *measured.ddx
/// }
/// ```
///
/// Where all agree at rest σ carries the weight and nothing moves; a neighbour elsewhere moves z⃛ first, by (49):
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, Jets, Thrust, ThrustDesign};
/// use forwardstep_core::plant::{Plant, Vehicle};
/// use forwardstep_core::reference::Heard;
///
/// let design = ThrustDesign::Differentiable { alpha_star: 4.0, stiffness: 20.0 };
/// let vehicle = Vehicle { mass: 1.5, gravity: 9.81 };
/// let law = Thrust::new(design, [1.0, 2.0, 3.0], vehicle.mass, vehicle.gravity)?;
/// let at_rest = [0.5, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// for shift in [0.0, 0.1] {
///     let w = 0.8;
///     let (degree, sums) = ([w], [w * (0.5 + shift), w * 1.0, w * -2.0]);
///     let given = ControllerInput { measured: law.see(&at_rest)?, heard: Heard::new(&degree, &sums, 3)?, target: Jets::NONE };
///     let size = |blocks: Vec<(_, usize)>| blocks.iter().map(|(_, n)| n).sum::<usize>();
///     let (mut state, mut d_state) = (vec![0.0; size(law.states())], vec![0.0; size(law.states())]);
///     law.start(&mut (), given, &[], &mut state)?;
///     let (mut input, mut shown, mut rate) = ([0.0; 4], vec![0.0; size(law.shown())], [0.0; 10]);
///     law.evaluate(&mut (), given, &state, ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown })?;
///     vehicle.rate(&mut (), &at_rest, &input, &[], &mut rate)?;
///     assert!((input[0] - 1.5 * 9.81).abs() < 1e-12 && rate.iter().all(|rate| rate.abs() < 1e-12));
///     // α₀ = 1 · 2 · 3
///     assert!((d_state[6] - 6.0 * w * shift).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Thrust {
    consensus: Consensus<Position>,
    /// The coefficient of p in (25), which for two roots is their sum; read by (46) alone.
    alpha_plus_beta: f64,
    design: ThrustDesign,
    /// m, or m̂(0) under (58), kg.
    pub mass: f64,
    /// g, m/s².
    pub gravity: f64,
    /// What ω₃ is used for.
    pub yaw: Yaw,
    /// What happens near σ = 0.
    pub floor: Floor,
    /// σ(0), N; m g or m̂(0) g when it is not given.
    pub thrust_start: Option<f64>,
    /// Where m is known to be, kg; read under (58).
    pub bounds: Option<Range>,
}

/// What the outer law asks for at one instant.
struct Flight {
    sigma: f64,
    d_sigma: f64,
    omega: [f64; 3],
    /// −Rᵀ u.
    v: [f64; 3],
    /// u̇, where it exists without derivatives of what is heard; up to a part that vanishes with ṡ under (58).
    du: Option<[f64; 3]>,
}

/// v = −Rᵀ u.
fn backward(attitude: Quaternion, u: [f64; 3]) -> [f64; 3] {
    rotate_back(attitude, u).map(|v| -v)
}

/// w = (z̈ + d⃛) + a (ż + d̈) − a g e₃.
fn driving(dz: &[f64], ddz: &[f64], target: Jets<'_>, [a, gravity]: [f64; 2]) -> [f64; 3] {
    let d = |k: usize, r: usize| target.get(k).map_or(0.0, |jet| jet[r]);
    let mut w: [f64; 3] = core::array::from_fn(|k| ddz[k] + d(k, 3) + a * (dz[k] + d(k, 2)));
    w[2] -= a * gravity;
    w
}

/// z, ż, … at the start: s(0) = 0 when nothing else is wanted.
fn begin_reference(
    reference: &mut [f64],
    dx: &[f64; 3],
    target: Jets<'_>,
    wanted: &[Vec<f64>],
) -> Result<(), LengthError> {
    check_target(target)?;
    reference.fill(0.0);
    for k in 0..reference.len().min(3) {
        reference[k] = dx[k] - target.get(k).map_or(0.0, |jet| jet[1]);
    }
    for (block, wanted) in reference.chunks_exact_mut(3).zip(wanted) {
        LengthError::check("the start of the reference", 3, wanted.len())?;
        block.copy_from_slice(wanted);
    }
    Ok(())
}

/// What V holds of an estimate μ of `mass`, γ* times, and what it loses of it beyond a bound, over α*; with Π(μ) − m.
fn learnt(bounds: Option<Range>, mu: f64, mass: f64) -> [f64; 3] {
    let delta = mu - mass;
    bounds.map_or([0.5 * delta * delta, 0.0, delta], |range| {
        [range.potential(mu, mass), range.withheld(mu, mass), range.nearest(mu) - mass]
    })
}

/// An offset has three axes.
fn check_target(target: Jets<'_>) -> Result<(), LengthError> {
    if target.is_empty() { Ok(()) } else { LengthError::check("target", 3, target.len()) }
}

impl Thrust {
    /// A vehicle of mass `mass` (what is known of it) that keeps heading zero and stops where σ falls to a tenth of m g. The roots
    /// −α, −β and, where there is one, −γ are in 1/s.
    ///
    /// # Errors
    /// [`RootsError`] when a root is not positive, or there are not [`ThrustDesign::order`] of them.
    pub fn new(
        design: ThrustDesign,
        roots_per_s: impl Into<RootSet>,
        mass: f64,
        gravity: f64,
    ) -> Result<Self, RootsError> {
        let roots = roots_per_s.into();
        if roots.len() != design.order() {
            return Err(RootsError::Order { need: design.order(), got: roots.len() });
        }
        let alpha_plus_beta = polynomial(&roots)?[1];
        Ok(Thrust {
            consensus: Consensus::new([(roots, 0.0)])?,
            alpha_plus_beta,
            design,
            mass,
            gravity,
            yaw: Yaw { heading: 0.0, rate: 0.0, gain: 1.0 },
            floor: Floor::Stops(0.1 * mass * gravity),
            thrust_start: None,
            bounds: None,
        })
    }

    /// Which of the paper's controllers it is.
    pub fn design(&self) -> ThrustDesign {
        self.design
    }

    fn state_blocks(&self) -> Vec<Block> {
        let mut states: Vec<Block> =
            (0..self.design.reference_len() / 3).map(|r| (Signal::Reference(r as u8), 3)).collect();
        states.extend([(Signal::Thrust, 1), (Signal::Heading, 1)]);
        states.extend(self.design.adapts().then_some((Signal::Estimate, 1)));
        states
    }

    fn shown_blocks(&self) -> Vec<Block> {
        let mut shown: Vec<Block> =
            (0..self.design.reference_len() / 3).map(|r| (Signal::Reference(r as u8), 3)).collect();
        shown.extend((self.design.reference_len() > 0).then_some((Signal::TrackingError, 3)));
        shown.extend(self.design.adapts().then_some((Signal::Estimate, 1)));
        shown
    }

    /// Numbers in [`Thrust::state_blocks`].
    fn state_len(&self) -> usize {
        self.design.reference_len() + 2 + usize::from(self.design.adapts())
    }

    /// Numbers in [`Thrust::shown_blocks`].
    fn shown_len(&self) -> usize {
        let reference = self.design.reference_len();
        let error = if reference > 0 { 3 } else { 0 };
        reference + error + usize::from(self.design.adapts())
    }

    /// σ of a state.
    fn sigma(&self, state: &[f64]) -> Option<f64> {
        state.get(self.design.reference_len()).copied()
    }

    /// s and w of z, ż, z̈.
    fn error_and_push(&self, dx: &[f64; 3], reference: &[f64], target: Jets<'_>) -> ([f64; 3], [f64; 3]) {
        let [alpha_star, ..] = self.design.gains();
        let s = core::array::from_fn(|k| dx[k] - reference[k] - target.get(k).map_or(0.0, |jet| jet[1]));
        (s, driving(&reference[3..6], &reference[6..9], target, [alpha_star, self.gravity]))
    }

    fn begin(
        &self,
        measured: VehicleState<'_>,
        target: Jets<'_>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", self.state_len(), state.len())?;
        let (reference, rest) = state.split_at_mut(self.design.reference_len());
        begin_reference(reference, measured.dx, target, wanted)?;
        rest[0] = self.thrust_start.unwrap_or(self.mass * self.gravity);
        rest[1] = self.yaw.heading;
        if let Some(integral) = rest.get_mut(2) {
            let (s, w) = self.error_and_push(measured.dx, reference, target);
            *integral = self.design.gains()[2] * dot(w, s);
        }
        Ok(())
    }

    /// The outer law; `shown` takes [`Thrust::shown_blocks`].
    fn fly(
        &self,
        measured: VehicleState<'_>,
        heard: Heard<'_, Position>,
        target: Jets<'_>,
        state: &[f64],
        [d_state, shown]: [&mut [f64]; 2],
    ) -> Result<Flight, LengthError> {
        LengthError::check("state", self.state_len(), state.len())?;
        LengthError::check("rate", state.len(), d_state.len())?;
        LengthError::check("shown", self.shown_len(), shown.len())?;
        check_target(target)?;
        let d = |k: usize, r: usize| target.get(k).map_or(0.0, |jet| jet[r]);
        let (reference, rest) = state.split_at(self.design.reference_len());
        let (d_reference, d_rest) = d_state.split_at_mut(self.design.reference_len());
        let (sigma, heading) = (rest[0], rest[1]);
        let x: [f64; 3] = core::array::from_fn(|k| measured.x[k] - d(k, 0));
        let dx: [f64; 3] = core::array::from_fn(|k| measured.dx[k] - d(k, 1));
        let own = Measured { q: &x, dq: &dx };
        let (mut z, mut dz) = ([0.0; 3], [0.0; 3]);

        let (a, u, du) = if self.design == ThrustDesign::Continuous {
            let mut rate = [0.0; 6];
            let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
            self.consensus.evaluate(3, own, &[0.0; 6], heard, out)?;
            let a = self.alpha_plus_beta + heard.degree.first().copied().unwrap_or(0.0);
            let mut u: [f64; 3] = core::array::from_fn(|k| self.mass * (rate[3 + k] + d(k, 3) + a * d(k, 2)));
            u[2] -= a * self.mass * self.gravity;
            (a, u, None)
        } else {
            let [alpha_star, stiffness, gamma_star] = self.design.gains();
            let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut *d_reference };
            self.consensus.evaluate(3, own, reference, heard, out)?;
            let (s, w) = self.error_and_push(measured.dx, reference, target);
            let dw: [f64; 3] =
                core::array::from_fn(|k| d_reference[6 + k] + d(k, 4) + alpha_star * (reference[6 + k] + d(k, 3)));
            let mut mass = match rest.get(2) {
                Some(integral) => self.mass + integral - gamma_star * dot(w, s),
                None => self.mass,
            };
            if let (Some(d_integral), Some(shown)) = (d_rest.get_mut(2), shown.last_mut()) {
                *d_integral = gamma_star * dot(dw, s);
                if let Some(range) = self.bounds {
                    *d_integral -= alpha_star * range.beyond(mass);
                    mass = range.nearest(mass);
                }
                *shown = mass;
            }
            shown[..9].copy_from_slice(reference);
            shown[9..12].copy_from_slice(&s);
            // ṡ as the model has it; only where the mass is known.
            let ddx = Vehicle { mass, gravity: self.gravity }.acceleration(*measured.attitude, sigma);
            let pull = |k: usize| if stiffness > 0.0 { stiffness * (ddx[k] - dz[k] - d(k, 2)) } else { 0.0 };
            let u = core::array::from_fn(|k| mass * w[k] - stiffness * s[k]);
            (alpha_star, u, Some(core::array::from_fn(|k| mass * dw[k] - pull(k))))
        };

        let v = backward(*measured.attitude, u);
        let d_sigma = self.floor.kept(sigma, v[2] - a * sigma);
        d_rest[0] = d_sigma;
        d_rest[1] = self.yaw.rate;
        let turn = self.yaw.turn(*measured.attitude, heading);
        Ok(Flight { sigma, d_sigma, omega: [-v[1] / sigma, v[0] / sigma, turn], v, du })
    }

    /// d/dt of the ω asked for, for a body that turns with `omega`; of ω₁ and ω₂ under (46) it is taken for zero.
    fn foresee(&self, flight: &Flight, measured: VehicleState<'_>, state: &[f64], omega: [f64; 3]) -> [f64; 3] {
        let heading = state.get(self.design.reference_len() + 1).copied().unwrap_or_default();
        let (sin, cos) = sine_and_cosine(heading);
        let look = rotate(*measured.attitude, [1.0, 0.0, 0.0]);
        let d_look = rotate(*measured.attitude, [0.0, omega[2], -omega[1]]);
        let Yaw { rate, gain, .. } = self.yaw;
        let turn = gain * (d_look[0] * sin - d_look[1] * cos + rate * (look[0] * cos + look[1] * sin));
        let Some(du) = flight.du else { return [0.0, 0.0, turn] };
        // v = −Rᵀ u, so v̇ = −Rᵀ u̇ − ω × v.
        let (back, bent) = (rotate_back(*measured.attitude, du), cross(omega, flight.v));
        let dv: [f64; 3] = core::array::from_fn(|k| -back[k] - bent[k]);
        let Flight { sigma, d_sigma, omega: [p, q, _], .. } = *flight;
        [-(dv[1] + p * d_sigma) / sigma, (dv[0] - q * d_sigma) / sigma, turn]
    }

    /// V and −V̇ of the head of this file, where m x⃛ misses by `slip` what u says, and the first three numbers of `external` are
    /// the force from outside, if there is one.
    fn translation_balance(
        &self,
        vehicle: &Vehicle,
        moving: VehicleState<'_>,
        target: Jets<'_>,
        state: &[f64],
        [slip, external]: [&[f64]; 2],
    ) -> Result<Balance, LengthError> {
        LengthError::check("state", self.state_len(), state.len())?;
        check_target(target)?;
        let (reference, rest) = state.split_at(self.design.reference_len());
        if reference.is_empty() {
            return Ok(Balance { value: 0.0, dissipation: 0.0 });
        }
        let [alpha_star, stiffness, gamma_star] = self.design.gains();
        let (s, w) = self.error_and_push(moving.dx, reference, target);
        let ddx = vehicle.acceleration(*moving.attitude, rest[0]);
        let ds: [f64; 3] =
            core::array::from_fn(|k| ddx[k] - reference[3 + k] - target.get(k).map_or(0.0, |jet| jet[2]));
        let mut value = 0.5 * vehicle.mass * dot(ds, ds) + 0.5 * stiffness * dot(s, s);
        let force = |along: [f64; 3]| along.iter().zip(external).map(|(a, f)| a * f).sum::<f64>() / vehicle.mass;
        let (mut power, mut withheld) = (stiffness * force(s), 0.0);
        if let Some(integral) = rest.get(2)
            && gamma_star > 0.0
        {
            let mu = self.mass + integral - gamma_star * dot(w, s);
            let [learnt, beyond, delta] = learnt(self.bounds, mu, vehicle.mass);
            withheld = alpha_star / gamma_star * beyond;
            value += learnt / gamma_star;
            power -= delta * force(w);
        }
        let slipped: f64 = ds.iter().zip(slip).map(|(ds, slip)| ds * slip).sum();
        Ok(Balance { value, dissipation: alpha_star * vehicle.mass * dot(ds, ds) + withheld - slipped - power })
    }
}
