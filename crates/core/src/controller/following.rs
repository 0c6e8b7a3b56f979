//! What the laws for (33) share: reference dynamics of order ℓ, s, and the terms of the plant.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::reference_model::{ReferenceModel, ReferenceModelError, ReferenceModelInput, ReferenceModelWork};
use super::{Controller, ControllerInput, Jets, Singularity};
use crate::LengthError;
use crate::error::GainError;
use crate::expression::ExpressionError;
use crate::plant::Terms;
use crate::reference::Position;
use crate::signal::{Block, Signal};

/// x* of a chain, all of it.
#[derive(Clone, Copy, Debug)]
pub struct ChainMeasured<'a> {
    /// x, ẋ, …, d^(k−1)x/dt^(k−1), or x_1 … x_n.
    pub x: &'a [f64],
}

/// Why there is no such law.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ChainError {
    /// The reference dynamics do not suit the plant.
    #[error(transparent)]
    ReferenceModel(#[from] ReferenceModelError),
    /// Lists that do not match.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// A gain that is not positive.
    #[error(transparent)]
    Gain(#[from] GainError),
    /// Φ is not an antiderivative of φ.
    #[error(
        "the antiderivative of regressor {} has the slope {slope} in the highest derivative where the regressor is {regressor}",
        .parameter + 1
    )]
    Antiderivative {
        /// Which one, from zero.
        parameter: usize,
        /// The slope found.
        slope: f64,
        /// What it should be.
        regressor: f64,
    },
    /// Φ could not be shown to be an antiderivative of φ: it is none at points that were not looked at, or is written too differently.
    #[error(
        "the antiderivative of regressor {} could not be shown to have the regressor as its slope in the highest derivative",
        .parameter + 1
    )]
    AntiderivativeNotShown {
        /// Which one, from zero.
        parameter: usize,
    },
    /// A start at which an estimate would stay.
    #[error(
        "the estimate of parameter {} starts at {start}, and this law keeps it strictly between its bounds, {lower} and {upper}, where \
         it adapts: let it start between them",
        .parameter + 1
    )]
    StartAtBound {
        /// Which one, from zero.
        parameter: usize,
        /// Where it starts.
        start: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// Terms that cannot be differentiated.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}

/// Every number positive and finite.
pub(super) fn positive(numbers: &[f64]) -> Result<(), GainError> {
    match numbers.iter().position(|number| !(*number > 0.0 && number.is_finite())) {
        Some(index) => Err(GainError::NotPositive { index, value: numbers[index] }),
        None => Ok(()),
    }
}

/// How z is followed.
#[derive(Clone, Debug)]
pub struct Following {
    /// Where z leads.
    pub guide: ReferenceModel,
    /// k of the laws, 1/s: how fast s vanishes.
    pub gain_per_s: f64,
    /// What |ψ| must stay above.
    pub floor: f64,
}

/// Working memory of a law for (33).
#[derive(Clone, Debug)]
pub struct FollowingWork<S> {
    pub(super) terms: S,
    guide: ReferenceModelWork,
    /// φ.
    pub(super) phi: Vec<f64>,
}

/// What [`Following::evaluate`] finds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// d^(k−1)x/dt^(k−1) − z.
    pub(super) s: f64,
    /// ż.
    pub(super) dz: f64,
    /// χ₀.
    pub(super) chi: f64,
    /// ψ.
    pub(super) psi: f64,
}

impl Following {
    /// ℓ, once the reference suits `terms` and the gain is positive.
    pub(super) fn check<T: Terms>(&self, terms: &T) -> Result<usize, ChainError> {
        positive(&[self.gain_per_s])?;
        Ok(self.guide.check(terms.order(), 1)?)
    }

    pub(super) fn work<T: Terms>(&self, terms: &T) -> FollowingWork<T::Scratch> {
        FollowingWork { terms: terms.scratch(), guide: self.guide.work(1), phi: vec![0.0; terms.parameters()] }
    }

    /// z, ż, …, z^(ℓ−1).
    pub(super) fn states(&self, order: usize) -> Vec<Block> {
        (0..self.guide.vectors(order)).map(|r| (self.guide.signal(r), 1)).collect()
    }

    /// z, ż, …, s, ψ, the estimates, and what is left to the target.
    pub(super) fn shown(&self, order: usize, estimates: usize) -> Vec<Block> {
        let mut shown = self.states(order);
        shown.extend([(Signal::TrackingError, 1), (Signal::Divisor, 1)]);
        if estimates > 0 {
            shown.push((Signal::Estimate, estimates));
        }
        if self.guide.tracks() {
            shown.push((Signal::Error, 1));
        }
        shown
    }

    /// s = 0 unless `wanted` says otherwise, and higher derivatives zero; the rest of the state is left alone.
    pub(super) fn start(
        &self,
        order: usize,
        (x, degree): (&[f64], &[f64]),
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let reference = &mut state[..self.guide.vectors(order)];
        reference.fill(0.0);
        if let (Some(z), Some(x)) = (reference.first_mut(), x.last()) {
            *z = *x;
        }
        for (z, wanted) in reference.iter_mut().zip(wanted) {
            LengthError::check("the start of the reference", 1, wanted.len())?;
            *z = wanted[0];
        }
        let top = x.len().saturating_sub(1);
        self.guide.begin(order, &x[top..], degree.first().copied().unwrap_or(0.0), reference)
    }

    /// The rate of the reference, s, and the terms of the plant; shows all of it.
    pub(super) fn evaluate<T, C>(
        &self,
        terms: &T,
        work: &mut FollowingWork<T::Scratch>,
        given: ControllerInput<'_, C>,
        x: &[f64],
        state: &[f64],
        (d_state, shown): (&mut [f64], &mut [f64]),
    ) -> Result<Found, LengthError>
    where
        T: Terms,
        C: Controller<Exchange = Position>,
    {
        let k = terms.order();
        let vectors = self.guide.vectors(k);
        LengthError::check("x", k, x.len())?;
        let z = &state[..vectors];
        let target = if self.guide.tracks() { given.target } else { Jets::NONE };
        let leads = ReferenceModelInput { measured: x, state: z, heard: given.heard, target };
        self.guide.rate(k, 1, leads, &mut work.guide, &mut d_state[..vectors])?;
        let (chi, psi) = terms.terms(&mut work.terms, x, &mut work.phi)?;
        let s = x.last().zip(z.first()).map_or(f64::NAN, |(x, z)| x - z);
        shown[..vectors].copy_from_slice(z);
        (shown[vectors], shown[vectors + 1]) = (s, psi);
        if let (Some(jet), Some(error)) = (target.get(0), shown.last_mut()) {
            *error = x[0] - jet[0];
        }
        Ok(Found { s, dz: d_state[0], chi, psi })
    }

    /// Checks the lengths of a state, its rate, an input and what is shown, with `estimates` numbers besides the reference.
    pub(super) fn lengths<T: Terms>(
        &self,
        terms: &T,
        estimates: usize,
        [state, d_state, input, shown]: [usize; 4],
    ) -> Result<(), LengthError> {
        let vectors = self.guide.vectors(terms.order());
        LengthError::check("state", vectors + estimates, state)?;
        LengthError::check("rate", vectors + estimates, d_state)?;
        LengthError::check("input", 1, input)?;
        LengthError::check("shown", vectors + 2 + estimates + usize::from(self.guide.tracks()), shown)
    }

    /// s, as it was shown.
    pub(super) fn s<T: Terms>(&self, terms: &T, estimates: usize, shown: &[f64]) -> Result<f64, LengthError> {
        let vectors = self.guide.vectors(terms.order());
        LengthError::check("shown", vectors + 2 + estimates + usize::from(self.guide.tracks()), shown.len())?;
        Ok(shown[vectors])
    }

    /// ψ close to zero.
    pub(super) fn trouble(&self, order: usize, shown: &[f64]) -> Option<Singularity> {
        let psi = *shown.get(self.guide.vectors(order) + 1)?;
        vanishes(psi, self.floor)
    }
}

/// A divisor that is closer to zero than it may be.
pub(super) fn vanishes(value: f64, floor: f64) -> Option<Singularity> {
    (value.abs() < floor).then_some(Singularity::Vanishes { signal: Signal::Divisor, axis: 0, value, floor })
}
