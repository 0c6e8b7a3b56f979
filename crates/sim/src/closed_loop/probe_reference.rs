//! What reference dynamics from outside say of themselves, tried at random states.

use forwardstep_core::LengthError;
use forwardstep_core::reference::{Measured, ReferenceOut};

use super::assembly::Assembly;
use super::columns::Inputs;
use super::error::SetupError;
use super::references::dynamics;
use crate::probe::{Counterexample, Draws, Identity, Probe, STATES, apart};
use crate::reference::{Dynamics, LinearReference, LinearTerms, ReferenceFamily};
use crate::setup::Setup;

/// Axes that are tried side by side.
const AXES: usize = 2;

/// Tries whether the reference dynamics of `setup` are what the engine takes them for: z, ż, … as the state has them, rates whose
/// part of the state is linear and the same whatever is heard and measured, one axis like the other, where they say that they are
/// affine and sampled agents step them exactly, a start that is the one asked for, and z^(ℓ) the linear form that their author says it is, where there is one.
///
/// # Errors
/// [`SetupError`] when they cannot be built.
pub fn probe_reference(setup: &Setup) -> Result<Probe, SetupError> {
    let (mut draws, mut probe) = (Draws::new(), Probe::default());
    for state in 0..if setup.agents.is_empty() { 0 } else { STATES } {
        let agent = state % setup.agents.len();
        let own = &setup.agents[agent];
        let reference = dynamics(&Assembly::new(setup, &[agent]))?;
        // What a filter holds is no z.
        let leads = setup.reference.interface().family != ReferenceFamily::Backstepping;
        let free = setup.reference.free_derivatives(own.roots_per_s.len()).min(reference.vectors());
        let free = if leads { free } else { 0 };
        let tried = Tried::new(reference, &mut draws);
        let linear = setup.reference.linear(own, setup.exchange);
        let found = tried
            .first(free, linear.as_ref())
            .map_err(|error| SetupError::ReferenceShape { reference: setup.reference.words().name, error })?;
        match found {
            None => {}
            Some(Ok(())) => probe.states += 1,
            Some(Err((identity, value, expected))) => {
                probe.states += 1;
                probe.found = Some(Counterexample { identity, t_s: 0.0, state: tried.state, value, expected });
                break;
            }
        }
    }
    Ok(probe)
}

/// An identity with the side that the author is asked of, and the other.
type Failure = (Identity, f64, f64);

/// One agent at random states.
struct Tried {
    reference: Dynamics,
    degree: [f64; 1],
    q: Vec<f64>,
    dq: Vec<f64>,
    sums: Vec<f64>,
    state: Vec<f64>,
    other: Vec<f64>,
    /// q̈ and Σ_j w_ij q̈_j.
    accelerations: [Vec<f64>; 2],
}

/// What the dynamics give.
#[derive(Default)]
struct Given {
    z: Vec<f64>,
    dz: Vec<f64>,
    rate: Vec<f64>,
}

impl Tried {
    fn new(reference: Dynamics, draws: &mut Draws) -> Self {
        let mut numbers = |length: usize| (0..length).map(|_| 2.0 * draws.unit()).collect::<Vec<f64>>();
        let (vectors, channels) = (reference.vectors(), reference.transmitted().channels());
        let states = AXES * vectors;
        let (q, dq, sums) = (numbers(AXES), numbers(AXES), numbers(AXES * channels));
        let (state, other) = (numbers(states), numbers(states));
        let accelerations = [numbers(AXES), numbers(AXES)];
        let degree = [1.0 + draws.unit()];
        Tried { reference, degree, q, dq, sums, state, other, accelerations }
    }

    fn at(&self, [q, dq, sums, state]: [&[f64]; 4]) -> Result<Given, LengthError> {
        let numbers = |length| vec![0.0; length];
        let mut given = Given { z: numbers(AXES), dz: numbers(AXES), rate: numbers(state.len()) };
        let out = ReferenceOut { z: &mut given.z, dz: &mut given.dz, d_state: &mut given.rate };
        let heard = Inputs { degree: &self.degree, sums, external: None };
        self.reference.evaluate(AXES, Measured { q, dq }, state, (0.0, heard), out)?;
        Ok(given)
    }

    /// The first identity that fails; nothing where something is not finite.
    fn first(&self, free: usize, said: Option<&LinearReference>) -> Result<Option<Result<(), Failure>>, LengthError> {
        let Tried { q, dq, sums, state, other, .. } = self;
        let zeros = |of: &[f64]| vec![0.0; of.len()];
        let swapped = |of: &[f64]| of.chunks_exact(AXES).flat_map(|pair| [pair[1], pair[0]]).collect::<Vec<f64>>();
        let both: Vec<f64> = state.iter().zip(other).map(|(x, y)| x + y).collect();
        let (no_q, no_sums, origin) = (zeros(q), zeros(sums), zeros(state));
        let here = self.at([q, dq, sums, state])?;
        let moved = self.at([q, dq, sums, &both])?;
        let [alone, nothing] = [other, &origin].map(|state| self.at([&no_q, &no_q, &no_sums, state]));
        let (alone, nothing) = (alone?, nothing?);
        let turned = self.at([&no_q, &no_q, &no_sums, &swapped(other)])?;
        let mut started = origin.clone();
        let heard = Inputs { degree: &self.degree, sums, external: None };
        self.reference.start(AXES, Measured { q, dq }, state, heard, &mut started)?;
        let begun = self.at([q, dq, sums, &started])?;

        let mut pairs: Vec<Failure> = Vec::new();
        let mut equal = |identity, value: &[f64], expected: &[f64]| {
            pairs.extend(value.iter().zip(expected).map(|(value, expected)| (identity, *value, *expected)));
        };
        let derivatives = self.reference.derivatives() * AXES;
        if derivatives > 0 {
            equal(Identity::Derivatives, &here.z, &state[..AXES]);
            equal(Identity::Derivatives, &here.rate[..derivatives - AXES], &state[AXES..derivatives]);
            equal(Identity::Derivatives, &here.dz, &here.rate[..AXES]);
        }
        let changes: Vec<f64> = moved.rate.iter().zip(&here.rate).map(|(moved, here)| moved - here).collect();
        let linear: Vec<f64> = alone.rate.iter().zip(&nothing.rate).map(|(alone, zero)| alone - zero).collect();
        if self.reference.is_affine() {
            equal(Identity::Affine, &changes, &linear);
            let swapped_back: Vec<f64> =
                swapped(&turned.rate).iter().zip(&swapped(&nothing.rate)).map(|(turned, zero)| turned - zero).collect();
            equal(Identity::Axes, &swapped_back, &linear);
        }
        if free > 0 {
            equal(Identity::Start, &begun.z, &state[..AXES]);
        }
        if let Some(said) = said {
            pairs.extend(self.linear_form(said, &here)?);
        }
        let mut all = pairs.iter().flat_map(|(_, value, expected)| [*value, *expected]);
        if !all.all(f64::is_finite) {
            return Ok(None);
        }
        let size = |values: &[f64]| values.iter().fold(1.0, |size: f64, value| size.max(value.abs()));
        let size = size(&moved.rate).max(size(&alone.rate)).max(size(&here.dz));
        let failed = pairs.into_iter().find(|(_, value, expected)| apart(*value, *expected, size));
        Ok(Some(failed.map_or(Ok(()), Err)))
    }

    /// z^(ℓ) beside the form that is said to be it; for an ℓ of one more than there are derivatives of z in the state its derivative, by the
    /// linearity of what it is the derivative of.
    fn linear_form(&self, linear: &LinearReference, here: &Given) -> Result<Vec<Failure>, LengthError> {
        let Tried { q, dq, sums, state, accelerations: [ddq, heard_ddq], .. } = self;
        let derivatives = self.reference.derivatives();
        let top = |given: &Given| match derivatives.checked_sub(1) {
            None => given.z.clone(),
            Some(last) => given.rate[last * AXES..(last + 1) * AXES].to_vec(),
        };
        let zeros = |of: &[f64]| vec![0.0; of.len()];
        let (no_q, no_sums, origin) = (zeros(q), zeros(sums), zeros(state));
        // What does not depend on the state.
        let nothing = top(&self.at([&no_q, &no_q, &no_sums, &origin])?);
        let less_nothing = |values: Vec<f64>| values.iter().zip(&nothing).map(|(value, zero)| value - zero).collect();
        let mut z: Vec<Vec<f64>> = state.chunks_exact(AXES).take(derivatives).map(<[f64]>::to_vec).collect();
        let value: Vec<f64> = match linear.order.checked_sub(derivatives) {
            Some(0) if linear.constant => less_nothing(top(here)),
            Some(0) => top(here),
            Some(1) => {
                z.push(top(here));
                let later = sums.iter().skip(AXES).chain(heard_ddq).take(sums.len()).copied();
                less_nothing(top(&self.at([dq, ddq, &later.collect::<Vec<f64>>(), &here.rate])?))
            }
            _ => return Ok(vec![(Identity::LinearOrder, linear.order as f64, derivatives as f64)]),
        };
        // What there is not is one: a form that speaks of it is another.
        let q_jet = [q, dq, ddq];
        let sum = |terms: &LinearTerms, axis: usize| -> f64 {
            let of_q = terms.q.iter().enumerate().map(|(r, a)| a * q_jet.get(r).map_or(1.0, |q| q[axis]));
            let of_z = terms.z.iter().enumerate().map(|(r, a)| a * z.get(r).map_or(1.0, |z| z[axis]));
            of_q.chain(of_z).sum()
        };
        let heard = |r: usize, axis: usize| sums.get(r * AXES + axis).copied().unwrap_or(1.0);
        let form = |axis: usize| {
            let received = linear.heard[0] * heard(0, axis) + linear.heard[1] * heard(1, axis);
            sum(&linear.own, axis) + self.degree[0] * sum(&linear.coupled, axis) - received
        };
        Ok((0..AXES).map(|axis| (Identity::LinearForm, form(axis), value[axis])).collect())
    }
}
