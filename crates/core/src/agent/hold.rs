//! A linear reference stepped exactly while its inputs are held.
//!
//! All reference dynamics of the paper are affine in their own state: with q, q̇ and what is heard held,
//!
//! ```text
//! ẋ = f(x) = A x + b        x(h) = x + h f(x) + h²/2 A f(x) + h³/6 A² f(x) + …
//! ```
//!
//! and A v is what the same dynamics return for the state v when everything else is zero, so no matrix is ever formed. The
//! series stops when its terms no longer count. It is used on parts of h that are halved until some forty terms
//! are enough, which they are while h times the fastest root is below about eight.

use alloc::vec;
use alloc::vec::Vec;

use crate::LengthError;
use crate::reference::{Exchange, Heard, Measured, Reference, ReferenceOut};

/// Terms of the series before the step is halved instead.
const MOST_TERMS: u32 = 40;

/// Halvings at most: enough while h times the fastest root is below some 30 000, a period of an hour for a root of 8 1/s.
const MOST_HALVINGS: u32 = 12;

/// Working memory of [`Hold::advance`].
#[derive(Clone, Debug)]
pub(crate) struct Hold {
    axes: usize,
    zeros: Vec<f64>,
    /// The state at the start of a part, the part's outcome, the term of the series at hand and the one to come.
    base: Vec<f64>,
    sum: Vec<f64>,
    term: Vec<f64>,
    next: Vec<f64>,
    /// z and ż, which nobody asks for here.
    unused: [Vec<f64>; 2],
}

impl Hold {
    /// For `axes` axes and a state of `n` numbers.
    pub(crate) fn new(axes: usize, n: usize) -> Self {
        let state = || vec![0.0; n];
        Hold {
            axes,
            // As many as any message has numbers.
            zeros: vec![0.0; 4 * axes],
            base: state(),
            sum: state(),
            term: state(),
            next: state(),
            unused: [vec![0.0; axes], vec![0.0; axes]],
        }
    }

    /// Moves `state` on by `h`; `rate` is f(state).
    #[inline(always)]
    pub(crate) fn advance<F: Reference>(
        &mut self,
        reference: &F,
        measured: Measured<'_, f64>,
        heard: Heard<'_, f64, F::Exchange>,
        h: f64,
        state: &mut [f64],
        rate: &[f64],
    ) -> Result<(), LengthError> {
        let mut halvings = 0;
        let mut parts = 1_u64;
        self.base.copy_from_slice(state);
        self.term.copy_from_slice(rate);
        loop {
            let part = h / parts as f64;
            let mut converged = true;
            for done in 0..parts {
                if done > 0 {
                    let [z, dz] = &mut self.unused;
                    let out = ReferenceOut { z, dz, d_state: &mut self.term };
                    reference.evaluate(self.axes, measured, state, heard, out)?;
                }
                converged = self.part(reference, heard.degree, part, state)?;
                if !converged {
                    break;
                }
            }
            if converged || halvings == MOST_HALVINGS {
                return Ok(());
            }
            halvings += 1;
            parts *= 2;
            state.copy_from_slice(&self.base);
            self.term.copy_from_slice(rate);
        }
    }

    /// Sums the series over one part, from f(state) in `term`; whether it converged.
    #[inline(always)]
    fn part<F: Reference>(
        &mut self,
        reference: &F,
        degree: &[f64],
        part: f64,
        state: &mut [f64],
    ) -> Result<bool, LengthError> {
        let zeros = &self.zeros[..self.axes];
        let nothing = Measured { q: zeros, dq: zeros };
        let split = <F::Exchange as Exchange>::split(&self.zeros, self.axes);
        let too_short = LengthError {
            what: "sums heard",
            need: <F::Exchange as Exchange>::CHANNELS * self.axes,
            got: self.zeros.len(),
        };
        let silence: Heard<'_, f64, F::Exchange> = Heard { degree, sums: split.ok_or(too_short)? };
        self.sum.copy_from_slice(state);
        for x in &mut self.term {
            *x *= part;
        }
        // Where terms cancel a sum may be next to nothing; terms that small against the first one count for nothing too.
        let floor = 1e-30 * self.term.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        for k in 2..=MOST_TERMS {
            let counts = add(&mut self.sum, &self.term, floor);
            if !counts {
                state.copy_from_slice(&self.sum);
                return Ok(true);
            }
            let [z, dz] = &mut self.unused;
            let out = ReferenceOut { z, dz, d_state: &mut self.next };
            reference.evaluate(self.axes, nothing, &self.term, silence, out)?;
            let factor = part / f64::from(k);
            for (term, next) in self.term.iter_mut().zip(&self.next) {
                *term = factor * *next;
            }
        }
        state.copy_from_slice(&self.sum);
        Ok(false)
    }
}

/// sum ← sum + term; whether the term was large enough to count.
#[inline(always)]
fn add(sum: &mut [f64], term: &[f64], floor: f64) -> bool {
    const ROUNDING: f64 = 0.25 * f64::EPSILON;
    let mut counts = false;
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += *term;
        counts |= term.abs() > (ROUNDING * sum.abs()).max(floor);
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{Consensus, Position};

    /// ℓ = 2 of (24) with d = 0 is z̈ = −α₁ ż − α₀ q̇, whose solution is known.
    #[test]
    fn prop_a_held_step_is_exact_however_long() {
        for (a, b, h) in [(1.0, 2.0, 0.01), (1.0, 2.0, 1.0), (3.0, 50.0, 4.0), (0.2, 900.0, 0.5)] {
            let law = Consensus::<Position>::new([(&[a, b][..], 0.0)]).unwrap();
            let measured = Measured { q: &[0.3], dq: &[-0.7] };
            let sums = Position::split(&[0.0][..], 1).unwrap();
            let heard = Heard { degree: &[0.0], sums };
            let mut state = [0.4, -1.3];
            let mut rate = [0.0; 2];
            let out = ReferenceOut { z: &mut [0.0], dz: &mut [0.0], d_state: &mut rate };
            law.evaluate(1, measured, &state, heard, out).unwrap();
            let [z, dz] = state;
            Hold::new(1, 2).advance(&law, measured, heard, h, &mut state, &rate).unwrap();
            // α₁ = a + b: ż relaxes towards −α₀ q̇ / α₁.
            let (alpha_0, alpha_1) = (a * b, a + b);
            let rest = -alpha_0 * -0.7 / alpha_1;
            let decay = libm::exp(-alpha_1 * h);
            let expected = [z + rest * h + (dz - rest) * (1.0 - decay) / alpha_1, rest + (dz - rest) * decay];
            for (got, want) in state.iter().zip(expected) {
                assert!((got - want).abs() < 1e-11 * (1.0 + want.abs()), "{got} {want} for {a} {b} {h}");
            }
        }
    }
}
