//! Reference dynamics stepped while their inputs are held.
//!
//! All reference dynamics of the paper are affine in their own state, each axis like the others, and stepped exactly: with q, q̇ and
//! what is heard held,
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
//!
//! Other ones, such as a nonlinear protocol, take one step of the classical Runge–Kutta method, whose error is of order five in h and
//! lost beside the first order of the hold.

use alloc::vec;
use alloc::vec::Vec;

use crate::reference::{Exchange, Heard, Measured, Reference, ReferenceOut};
use crate::{LengthError, Scalar};

/// Terms of the series for |A h| ≤ ½; the next would be 2^−17/18! of the first.
const TERMS: u32 = 17;

/// What is held from a sample on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Since<'a, X: Exchange> {
    pub(crate) measured: Measured<'a>,
    /// With the time of the sample.
    pub(crate) heard: Heard<'a, X>,
    /// f(x) then.
    pub(crate) rate: &'a [f64],
}

/// Working memory of [`Hold::advance`].
#[derive(Clone, Debug)]
pub(crate) struct Hold {
    axes: usize,
    order: usize,
    zeros: Vec<f64>,
    /// A unit state, and what the dynamics return for it; or the state of a stage, and its rate.
    unit: Vec<f64>,
    rate: Vec<f64>,
    /// What they return for no state; or the sum of the stages.
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

    /// Moves `state` on by `h`.
    #[inline(always)]
    pub(crate) fn advance<F: Reference>(
        &mut self,
        reference: &F,
        since: Since<'_, F::Exchange>,
        h: f64,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        if !reference.is_affine() {
            return self.advance_in_stages(reference, since, h, state);
        }
        self.linearise(reference, since.heard.degree)?;
        self.integrate(h);
        let rate = since.rate;
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

    /// The classical Runge–Kutta method, whose first stage is known.
    #[inline(always)]
    fn advance_in_stages<F: Reference>(
        &mut self,
        reference: &F,
        Since { measured, heard, rate }: Since<'_, F::Exchange>,
        h: f64,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let Hold { unit: stage, rate: k, rest: sum, unused: [z, dz], .. } = self;
        LengthError::check("reference state", stage.len(), state.len())?;
        LengthError::check("reference rate", k.len(), rate.len())?;
        k.copy_from_slice(rate);
        sum.copy_from_slice(rate);
        for (when, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            for ((stage, x), k) in stage.iter_mut().zip(&*state).zip(&*k) {
                *stage = x + when * h * k;
            }
            let out = ReferenceOut { z, dz, d_state: k };
            reference.evaluate(self.axes, measured, stage, heard.at(heard.time_s + when * h), out)?;
            for (sum, k) in sum.iter_mut().zip(&*k) {
                *sum += weight * k;
            }
        }
        for (x, sum) in state.iter_mut().zip(&*sum) {
            *x += h / 6.0 * sum;
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
    use crate::reference::{AxisOutput, Backstepping, Consensus, PerAxis, Position, PositionVelocity, PureIntegral};

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
                let measured = Measured { q: &q, dq: &dq };
                law.evaluate(axes, measured, &state, heard, out).unwrap();
                let since = Since { measured, heard, rate: &rate };
                hold.advance(law, since, h / f64::from(parts), &mut state).unwrap();
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
            let heard = Heard { degree: &[0.0], sums, time_s: 0.0 };
            law.evaluate(1, measured, &state, heard, out).unwrap();
            let [z, dz] = state;
            Hold::new(1, 2, 1).advance(&law, Since { measured, heard, rate: &rate }, h, &mut state).unwrap();
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

    /// ż = −z² + 3 t² + t⁶ has z = t³ for a solution; a step from t = 0.4 to 0.4 + h misses it by a fifth power of h.
    #[test]
    fn prop_what_is_not_affine_is_stepped_to_the_fifth_order_and_time_goes_on() {
        let law = PerAxis::<Position, _>::new([1, 1, 1], |given, asked: &mut AxisOutput<'_, '_>| {
            let (z, t) = (given.state(0), given.time_s());
            let cube = t * t * t;
            let share = given.heard_position() - given.q() - given.dq() + given.degree();
            asked.rate(0, share * (cube * cube + 3.0 * t * t - z * z));
        });
        let law = law.nonlinear();
        let miss = |h: f64| {
            // What is heard, measured and weighed makes the share one: all of them are held.
            let (measured, heard) =
                (Measured { q: &[0.3, 0.3], dq: &[0.2, 0.2] }, Heard::new(&[0.8], &[0.7, 0.7], 2).unwrap());
            let heard = heard.at(0.4);
            let (mut state, mut rate) = ([0.064, 0.064], [0.0; 2]);
            let out = ReferenceOut { z: &mut [0.0; 2], dz: &mut [0.0; 2], d_state: &mut rate };
            law.evaluate(2, measured, &state, heard, out).unwrap();
            Hold::new(2, 1, 1).advance(&law, Since { measured, heard, rate: &rate }, h, &mut state).unwrap();
            assert_eq!(state[0].to_bits(), state[1].to_bits());
            (state[0] - libm::pow(0.4 + h, 3.0)).abs()
        };
        let [coarse, fine] = [miss(0.1), miss(0.05)];
        assert!(coarse < 1e-5 && fine < coarse / 25.0 && fine > coarse / 40.0, "{coarse} {fine}");
    }
}
