//! A linear reference stepped exactly while its inputs are held.
//!
//! All reference dynamics of the paper are affine in their own state, each axis like the others: with q, q̇ and what is heard
//! held,
//!
//! ```text
//! ẋ = f(x) = A x + b        x(h) = x + Φ(h) f(x),     Φ(h) = ∫₀ʰ exp(A σ) dσ = h + h²/2 A + h³/6 A² + …
//! ```
//!
//! The columns of A, ℓ × ℓ, are what the same dynamics return for unit states, less what they return for none, when everything
//! else is zero. The series is
//! summed for a part of h so short that it needs few terms; then, since exp(A h) = 1 + A Φ(h),
//!
//! ```text
//! Φ(2h) = Φ(h) (2 + A Φ(h))
//! ```
//!
//! doubles the part until it is h. That holds for any h and any roots.

use alloc::vec;
use alloc::vec::Vec;

use crate::reference::{Heard, Measured, Reference, ReferenceOut};
use crate::{LengthError, Scalar};

/// Terms of the series for |A h| ≤ ½; the next would be 2^−17/18! of the first.
const TERMS: u32 = 17;

/// Working memory of [`Hold::advance`].
#[derive(Clone, Debug)]
pub(crate) struct Hold {
    axes: usize,
    order: usize,
    zeros: Vec<f64>,
    /// A unit state, and what the dynamics return for it.
    unit: Vec<f64>,
    rate: Vec<f64>,
    /// What they return for no state.
    rest: Vec<f64>,
    /// z and ż, which are not needed here.
    unused: [Vec<f64>; 2],
    /// A, Φ and products, ℓ × ℓ, row by row.
    a: Vec<f64>,
    phi: Vec<f64>,
    term: Vec<f64>,
    product: Vec<f64>,
}

impl Hold {
    /// For `axes` axes and a state of `vectors` blocks, for messages of `channels` vectors.
    pub(crate) fn new(axes: usize, vectors: usize, channels: usize) -> Self {
        let (state, matrix) = (|| vec![0.0; axes * vectors], || vec![0.0; vectors * vectors]);
        Hold {
            axes,
            order: vectors,
            zeros: vec![0.0; channels.max(1) * axes],
            unit: state(),
            rate: state(),
            rest: state(),
            unused: [vec![0.0; axes], vec![0.0; axes]],
            a: matrix(),
            phi: matrix(),
            term: matrix(),
            product: matrix(),
        }
    }

    /// Moves `state` on by `h` under the weights of `degree`; `rate` is f(state).
    #[inline(always)]
    pub(crate) fn advance<F: Reference>(
        &mut self,
        reference: &F,
        degree: &[f64],
        h: f64,
        state: &mut [f64],
        rate: &[f64],
    ) -> Result<(), LengthError> {
        self.linearise(reference, degree)?;
        self.integrate(h);
        for axis in 0..self.axes {
            for row in 0..self.order {
                let mut sum = state[row * self.axes + axis];
                for column in 0..self.order {
                    sum = self.phi[row * self.order + column].mul_add(rate[column * self.axes + axis], sum);
                }
                state[row * self.axes + axis] = sum;
            }
        }
        Ok(())
    }

    /// A, column by column.
    #[inline(always)]
    fn linearise<F: Reference>(&mut self, reference: &F, degree: &[f64]) -> Result<(), LengthError> {
        let nothing = Measured { q: &self.zeros[..self.axes], dq: &self.zeros[..self.axes] };
        let zero_input = Heard::new(degree, &self.zeros, self.axes)?;
        let [z, dz] = &mut self.unused;
        self.unit.fill(0.0);
        let out = ReferenceOut { z, dz, d_state: &mut self.rest };
        reference.evaluate(self.axes, nothing, &self.unit, zero_input, out)?;
        for column in 0..self.order {
            self.unit.fill(0.0);
            if let Some(one) = self.unit.get_mut(column * self.axes) {
                *one = 1.0;
            }
            let [z, dz] = &mut self.unused;
            let out = ReferenceOut { z, dz, d_state: &mut self.rate };
            reference.evaluate(self.axes, nothing, &self.unit, zero_input, out)?;
            for row in 0..self.order {
                let of = |rates: &[f64]| rates.get(row * self.axes).copied().unwrap_or(0.0);
                self.a[row * self.order + column] = of(&self.rate) - of(&self.rest);
            }
        }
        Ok(())
    }

    /// Φ(h).
    #[inline(always)]
    fn integrate(&mut self, h: f64) {
        let n = self.order;
        let size =
            self.a.chunks_exact(n.max(1)).map(|row| row.iter().map(|a| a.abs()).sum::<f64>()).fold(0.0, f64::max);
        let mut doublings = 0_u32;
        let mut part = h;
        // A rate that is not finite stops nothing here; it shows in the state.
        while size * part > 0.5 && doublings < 2100 {
            part *= 0.5;
            doublings += 1;
        }
        self.term.fill(0.0);
        for row in 0..n {
            self.term[row * n + row] = part;
        }
        self.phi.copy_from_slice(&self.term);
        for k in 2..=TERMS {
            multiply(n, &self.a, &self.term, &mut self.product);
            let factor = part / f64::from(k);
            for ((term, product), phi) in self.term.iter_mut().zip(&self.product).zip(&mut self.phi) {
                *term = factor * product;
                *phi += *term;
            }
        }
        for _ in 0..doublings {
            multiply(n, &self.a, &self.phi, &mut self.product);
            for row in 0..n {
                self.product[row * n + row] += 2.0;
            }
            multiply(n, &self.phi, &self.product, &mut self.term);
            self.phi.copy_from_slice(&self.term);
        }
    }
}

/// out = a b, n × n.
#[inline(always)]
fn multiply(n: usize, a: &[f64], b: &[f64], out: &mut [f64]) {
    for row in 0..n {
        for column in 0..n {
            let mut sum = 0.0;
            for k in 0..n {
                sum = Scalar::mul_add(a[row * n + k], b[k * n + column], sum);
            }
            out[row * n + column] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{
        AxisOutput, Backstepping, Consensus, Exchange, PerAxis, Position, PositionVelocity, PureIntegral,
    };

    /// Steps once over `h`, then in `parts` parts with the inputs held all along; both states.
    fn both_ways<F: Reference>(law: &F, start: &[f64], h: f64, parts: u32) -> [Vec<f64>; 2] {
        let axes = 2;
        let channels = <F::Exchange as Exchange>::CHANNELS;
        let (q, dq, degree) = ([0.3, -1.1], [-0.7, 0.2], [1.5]);
        let sums: Vec<f64> = (0..channels * axes).map(|k| 0.4 - 0.3 * k as f64).collect();
        let mut hold = Hold::new(axes, law.vectors(), channels);
        [1, parts].map(|parts| {
            let mut state = start.to_vec();
            for _ in 0..parts {
                let (mut z, mut dz, mut rate) = ([0.0; 2], [0.0; 2], vec![0.0; start.len()]);
                let heard = Heard { degree: &degree, sums: F::Exchange::split(&sums, axes).unwrap(), time_s: 0.0 };
                let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
                law.evaluate(axes, Measured { q: &q, dq: &dq }, &state, heard, out).unwrap();
                hold.advance(law, &degree, h / f64::from(parts), &mut state, &rate).unwrap();
            }
            state
        })
    }

    fn assert_same([once, often]: [Vec<f64>; 2]) {
        let size = once.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        for (a, b) in once.iter().zip(&often) {
            assert!((a - b).abs() < 1e-10 * size, "{once:?} {often:?}");
        }
    }

    #[test]
    fn prop_one_long_step_is_many_short_ones_for_every_design() {
        let start = [0.4, -1.3, 0.2, 0.9, -0.5, 0.1, 0.8, -0.2];
        for lambda in [0.0, 0.7] {
            for order in 1..=4 {
                let roots = &[1.0, 2.0, 0.5, 30.0][..order];
                let law = Consensus::<PositionVelocity>::new([(roots, lambda)]).unwrap();
                assert_same(both_ways(&law, &start[..2 * order], 0.8, 64));
            }
            let law = PureIntegral::<Position>::new([(&[1.0, 2.0][..], lambda)]).unwrap();
            assert_same(both_ways(&law, &start[..4], 0.8, 64));
        }
        // A rate that does not vanish with the state, with what is measured and with what is heard.
        let drawn = PerAxis::<Position, _>::new([1, 2, 2], |given, asked: &mut AxisOutput<'_, '_>| {
            let (z, dz) = (given.state(0), given.state(1));
            asked.rate(0, dz);
            asked.rate(1, 0.7 - 3.0 * dz - given.degree() * z + given.heard_position() - given.q());
        });
        assert_same(both_ways(&drawn, &start[..4], 0.8, 64));
        // A filter a hundred thousand times as fast as the sample has simply settled.
        let law = Backstepping::new([(1e-7, f64::INFINITY)]).unwrap();
        let [once, _] = both_ways(&law, &[5.0, -5.0], 0.01, 1);
        for (axis, f) in once.iter().enumerate() {
            let z = 0.4 - 0.3 * axis as f64 - 1.5 * [0.3, -1.1][axis];
            assert!((f - z).abs() < 1e-12, "{f} {z}");
        }
    }

    /// ℓ = 2 of (24) with d = 0 is z̈ = −α₁ ż − α₀ q̇, whose solution is known.
    #[test]
    fn prop_a_held_step_is_exact_however_long() {
        for (a, b, h) in [(1.0, 2.0, 0.01), (1.0, 2.0, 1.0), (3.0, 50.0, 4.0), (0.2, 900.0, 0.5), (1.0, 1e5, 1e3)] {
            let law = Consensus::<Position>::new([(&[a, b][..], 0.0)]).unwrap();
            let measured = Measured { q: &[0.3], dq: &[-0.7] };
            let sums = Position::split(&[0.0][..], 1).unwrap();
            let mut state = [0.4, -1.3];
            let mut rate = [0.0; 2];
            let out = ReferenceOut { z: &mut [0.0], dz: &mut [0.0], d_state: &mut rate };
            law.evaluate(1, measured, &state, Heard { degree: &[0.0], sums, time_s: 0.0 }, out).unwrap();
            let [z, dz] = state;
            Hold::new(1, 2, 1).advance(&law, &[0.0], h, &mut state, &rate).unwrap();
            // α₁ = a + b: ż relaxes towards −α₀ q̇ / α₁.
            let (alpha_0, alpha_1) = (a * b, a + b);
            let rest = -alpha_0 * -0.7 / alpha_1;
            let decay = libm::exp(-alpha_1 * h);
            let expected = [z + rest * h + (dz - rest) * (1.0 - decay) / alpha_1, rest + (dz - rest) * decay];
            for (got, want) in state.iter().zip(expected) {
                assert!((got - want).abs() < 1e-10 * (1.0 + want.abs()), "{got} {want} for {a} {b} {h}");
            }
        }
    }
}
