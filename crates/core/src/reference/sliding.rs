//! The set-valued sign of the designs that follow a leader: what it is taken of, and how a value of it is chosen.
//!
//! With ξ_i = a_i + β q̇_i + α q_i, where a is nothing (and β = 1) in (110), q̈ in (119) and ż in (122), or what is told as it stands,
//!
//! ```text
//! e_i = Σ_j w_ij (ξ_i − ξ_j)        ς_i ∈ Sgn(e_i): 1 for e_i > 0, −1 for e_i < 0, any of [−1, 1] for e_i = 0, axis by axis
//! ```
//!
//! A leader that moves is followed on e = 0, where ς takes whatever value in between keeps it there. A number that jumps
//! between 1 and −1 cannot do that: it chatters. So ς is not computed inside the vector field. It is a block of reference
//! state with rate zero, which the integrator, or the sampled controller, sets. In every design here −γ ς is a part of the rate of the block before
//! it, and with s (ṡ where a = q̈) held over a period h the sign moves e by −hγ L ς, L the Laplacian of the followers. Implicit
//! is the choice that suits the end of the period,
//!
//! ```text
//! ς ∈ Sgn(e − hγ L ς)
//! ```
//!
//! which is one value and no chatter. An agent by itself knows nothing of what its neighbours choose. With their ξ held the
//! equation reads ς_i ∈ Sgn(e_i − hγ d_i ς_i), d_i = Σ_j w_ij, and is solved by ς_i = sat(e_i/(hγ d_i)).

use crate::{LengthError, Scalar};

/// What ξ contains besides velocity and position, and what is transmitted for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Derived {
    /// Nothing: (110).
    Nothing,
    /// q̈: (119).
    Acceleration,
    /// ż: (122).
    ReferenceAcceleration,
    /// Nothing is left to compose: ξ is y, the one vector that is told.
    Composite,
}

/// How a value of the sign is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// Such that it suits the end of the period.
    Implicit,
    /// sgn e at the start of the period; for comparison: it chatters.
    Explicit,
    /// sat(e/ε) at every instant; for comparison: leaves an error of the size of ε.
    Layer {
        /// ε.
        width: f64,
    },
}

/// A set-valued sign in reference dynamics. Its last two blocks of state are what −γ ς is integrated into, and ς.
///
/// What one agent chooses solves ς ∈ Sgn(e − hγ d ς):
///
/// ```
/// use forwardstep_core::reference::{Choice, Derived, Sliding};
///
/// let sign = Sliding { derived: Derived::Nothing, alpha: 1.0, beta: 1.0, gamma: 5.0, choice: Choice::Implicit };
/// let (period_s, degree) = (0.1, 0.8);
/// for e in [-2.0, -0.3, 0.0, 0.1, 7.0] {
///     let selection = sign.alone(e, degree, period_s);
///     let left = e - period_s * sign.gamma * degree * selection;
///     assert!(left.abs() < 1e-12 || selection == left.signum());
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// What ξ contains besides velocity and position.
    pub derived: Derived,
    /// The factor of q in ξ.
    pub alpha: f64,
    /// The factor of q̇ in ξ.
    pub beta: f64,
    /// γ.
    pub gamma: f64,
    /// How ς is chosen.
    pub choice: Choice,
}

/// What e is made of on columns: own values and sums of what was heard, `axes · agents` entries each. The last of either is
/// not read when there is nothing derived, and of [`Derived::Composite`] only the first, which is y.
#[derive(Clone, Copy, Debug)]
pub struct SlidingInputs<'a> {
    /// q, q̇, a of everybody; or y.
    pub own: [&'a [f64]; 3],
    /// Σ_j w_ij, one entry per agent.
    pub degree: &'a [f64],
    /// Σ_j w_ij q_j, Σ_j w_ij q̇_j, Σ_j w_ij a_j.
    pub sums: [&'a [f64]; 3],
}

impl Sliding {
    /// Vectors that are transmitted besides what is measured.
    pub fn transmitted(&self) -> usize {
        match self.derived {
            Derived::Acceleration | Derived::ReferenceAcceleration => 1,
            Derived::Nothing | Derived::Composite => 0,
        }
    }

    /// Vectors that ξ is composed of.
    fn parts(&self) -> usize {
        match self.derived {
            Derived::Composite => 1,
            Derived::Nothing => 2,
            Derived::Acceleration | Derived::ReferenceAcceleration => 3,
        }
    }

    /// e of everybody.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn argument(&self, axes: usize, inputs: SlidingInputs<'_>, e: &mut [f64]) -> Result<(), LengthError> {
        let SlidingInputs { own, degree, sums } = inputs;
        let n = degree.len();
        LengthError::check("argument of the sign", axes * n, e.len())?;
        for column in own.iter().take(self.parts()).chain(sums.iter().take(self.parts())) {
            LengthError::check("what the sign is taken of", axes * n, column.len())?;
        }
        let (alpha, beta, derived) = (self.alpha, self.beta, self.derived);
        for (k, e) in e.iter_mut().enumerate() {
            let xi = |[q, dq, a]: [&[f64]; 3]| match derived {
                Derived::Composite => q[k],
                Derived::Nothing => Scalar::mul_add(alpha, q[k], beta * dq[k]),
                Derived::Acceleration | Derived::ReferenceAcceleration => {
                    Scalar::mul_add(alpha, q[k], beta * dq[k]) + a[k]
                }
            };
            // d ξ_i − Σ_j w_ij ξ_j.
            *e = degree[k % n] * xi(own) - xi(sums);
        }
        Ok(())
    }

    /// The value that one agent chooses at a sample, over a period of length `period_s`, for the argument `e`, when
    /// Σ_j w_ij = `degree`.
    pub fn alone(&self, e: f64, degree: f64, period_s: f64) -> f64 {
        match self.choice {
            Choice::Implicit => saturated(e, period_s * self.gamma * degree),
            Choice::Explicit => saturated(e, 0.0),
            Choice::Layer { width } => saturated(e, width),
        }
    }
}

/// sat(e/width): 1 above `width`, −1 below −`width`; for no width the sign, zero at zero.
pub fn saturated(e: f64, width: f64) -> f64 {
    // Not f64::clamp, which would let not-a-number through as it is: it must not get lost either.
    match () {
        () if e.is_nan() => e,
        () if e >= width && e > 0.0 => 1.0,
        () if e <= -width && e < 0.0 => -1.0,
        () if width > 0.0 => e / width,
        () => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_agent_alone_solves_its_own_inclusion() {
        let sign = Sliding { derived: Derived::Nothing, alpha: 1.0, beta: 1.0, gamma: 3.0, choice: Choice::Implicit };
        let (h, d) = (1e-3, 2.0);
        for e in [-1.0, -6e-3, -1e-3, 0.0, 2e-3, 5e-3, 6e-3, 0.4] {
            let selection = sign.alone(e, d, h);
            let rest = e - h * sign.gamma * d * selection;
            // ς ∈ Sgn(rest).
            let inside = rest.abs() < 1e-15 && selection.abs() <= 1.0;
            assert!(inside || selection == rest.signum(), "{e}: {selection} {rest}");
        }
        assert_eq!([-2.0, 0.0, 1e-9].map(|e| saturated(e, 0.0)), [-1.0, 0.0, 1.0]);
        assert!(saturated(f64::NAN, 1.0).is_nan());
    }

    #[test]
    fn the_argument_is_the_weighted_difference() {
        let sign =
            Sliding { derived: Derived::Acceleration, alpha: 0.7, beta: 1.9, gamma: 3.0, choice: Choice::Explicit };
        let ([q, dq, a], [q_j, dq_j, a_j], w) = ([0.3, -1.0, 2.0], [0.1, 0.4, -0.6], 1.5);
        let mut e = [0.0];
        let own = [&[q][..], &[dq], &[a]];
        let heard = [[w * q_j], [w * dq_j], [w * a_j]];
        let sums = [&heard[0][..], &heard[1], &heard[2]];
        sign.argument(1, SlidingInputs { own, degree: &[w], sums }, &mut e).unwrap();
        let xi = |q: f64, dq: f64, a: f64| a + 1.9 * dq + 0.7 * q;
        assert!((e[0] - w * (xi(q, dq, a) - xi(q_j, dq_j, a_j))).abs() < 1e-14);
    }
}
