//! Feedback linearisation as the second step of Section IV, for (33) with χ and ψ known.
//!
//! ```text
//! d^k x/dt^k = χ(x*) + ψ(x*) u                                            (33)
//! s = d^(k−1)x/dt^(k−1) − z,   ṡ = χ − ż + ψ u                             second line of (43)
//! u = (ż − χ − k s)/ψ
//! ```
//!
//! z comes from the reference dynamics of [`Guide`], which also says how the first line of (43) is reduced to degree zero.
//! Then ṡ = −k s, so V = ½ s² loses V̇ = −k s², and s is square-integrable and vanishes, exponentially. Neither step
//! differentiates anything: ż is a state of the reference for ℓ ≥ 2, and for ℓ = 1 what its dynamics give.

use alloc::vec::Vec;

use super::following::{ChainError, ChainMeasured, Following, FollowingWork};
use super::{Asked, Balance, Controller, Given, Trouble, Truth};
use crate::LengthError;
use crate::plant::{Chain, Terms, total};
use crate::reference::Position;
use crate::signal::Block;

#[cfg(doc)]
use super::Guide;

/// Control of (33) by feedback linearisation.
///
/// State: z, ż, …, z^(ℓ−1). Shown: the same, s, ψ, and x − x_d when it tracks.
///
/// **Source**: (33)–(43), Remark 6. **Measures**: x, ẋ, …, d^(k−1)x/dt^(k−1). **Transmits**: x.
/// **Requires**: ψ away from zero; k positive; positive roots, k + ℓ − 1 to track and k + ℓ − 2 to agree, ℓ ≥ 1; x_d with
/// k + ℓ − 1 bounded derivatives, or a network as for Theorem 3 with (24).
/// **Guarantees**: x − x_d → 0 with its derivatives; with a network x_i − x_j → 0 and all derivatives → 0. u is ℓ − 2 times
/// continuously differentiable through switches and delay jumps.
/// **Deviates from the paper**: nothing.
#[derive(Clone, Debug)]
pub struct Linearising<T> {
    terms: T,
    theta: Vec<f64>,
    following: Following,
}

impl<T: Terms> Linearising<T> {
    /// For a plant with these terms and the known θ.
    ///
    /// # Errors
    /// [`ChainError`] when the reference does not suit the plant, or lengths differ.
    pub fn new(terms: T, theta: Vec<f64>, following: Following) -> Result<Self, ChainError> {
        following.check(&terms)?;
        LengthError::check("theta", terms.parameters(), theta.len())?;
        Ok(Linearising { terms, theta, following })
    }

    /// How z is followed.
    pub fn following(&self) -> &Following {
        &self.following
    }
}

impl<T: Terms> Controller for Linearising<T> {
    type Plant = Chain<T>;
    type Exchange = Position;
    type Measured<'a> = ChainMeasured<'a>;
    type Scratch = FollowingWork<T::Scratch>;

    const MEASURES: &'static [&'static str] = &["position", "its derivatives below the order of the plant"];

    fn scratch(&self) -> Self::Scratch {
        self.following.work(&self.terms)
    }

    fn states(&self) -> Vec<Block> {
        self.following.states(self.terms.order())
    }

    fn shown(&self) -> Vec<Block> {
        self.following.shown(self.terms.order(), 0)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<ChainMeasured<'a>, LengthError> {
        LengthError::check("output", self.terms.order(), output.len())?;
        Ok(ChainMeasured { x: output })
    }

    fn start(
        &self,
        _: &mut Self::Scratch,
        given: Given<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", total(&self.states()), state.len())?;
        self.following.start(self.terms.order(), given.measured.x, wanted, state)
    }

    fn evaluate(
        &self,
        work: &mut Self::Scratch,
        given: Given<'_, Self>,
        state: &[f64],
        asked: Asked<'_>,
    ) -> Result<(), LengthError> {
        let Asked { input, d_state, shown } = asked;
        self.following.lengths(&self.terms, 0, [state.len(), d_state.len(), input.len(), shown.len()])?;
        let x = given.measured.x;
        let found = self.following.evaluate(&self.terms, work, given, x, state, (d_state, shown))?;
        let mut chi = found.chi;
        for (phi, theta) in work.phi.iter().zip(&self.theta) {
            chi += phi * theta;
        }
        input[0] = (found.dz - chi - self.following.gain_per_s * found.s) / found.psi;
        Ok(())
    }

    fn trouble(&self, _: &[f64], shown: &[f64]) -> Option<Trouble> {
        self.following.trouble(self.terms.order(), shown)
    }

    fn balance(
        &self,
        _: &mut Self::Scratch,
        _: Truth<'_, Self::Plant>,
        _: Given<'_, Self>,
        _: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let s = self.following.s(&self.terms, 0, shown)?;
        Ok(Balance { value: 0.5 * s * s, dissipation: self.following.gain_per_s * s * s })
    }
}
