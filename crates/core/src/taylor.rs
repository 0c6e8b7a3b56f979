//! Truncated Taylor series in time: a robot model that computes with them gives derivatives of its outputs without differences.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::Scalar;

/// x(t* + h) = Σ_k c_k hᵏ up to k = `N` − 1: entry k is the k-th derivative at t* over k!.
///
/// Coefficient k of a result depends on coefficients 0 … k of the operands only, so those above may be not-a-number where they are not
/// known yet. The first coefficient of [`Scalar::mul_add`], [`Scalar::sin_cos`] and of the four operations has the bits that `f64` gives; the others are
/// not rounded once.
///
/// ```
/// use forwardstep_core::{Scalar, Taylor};
///
/// // t = 0 + h: sin t = h − h³/6.
/// let (sin, _) = Taylor([0.0, 1.0, 0.0, 0.0]).sin_cos();
/// assert_eq!(sin.0, [0.0, 1.0, 0.0, -1.0 / 6.0]);
/// assert_eq!(sin.derivative(3), -1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor<const N: usize>(pub [f64; N]);

impl<const N: usize> Taylor<N> {
    /// A value of whose derivatives nothing is known: they are not-a-number.
    pub fn value(value: f64) -> Self {
        Taylor(core::array::from_fn(|k| if k == 0 { value } else { f64::NAN }))
    }

    /// The derivative of order `order` at t*, in the unit of the value over sᵒʳᵈᵉʳ; not-a-number from `N` on.
    pub fn derivative(&self, order: usize) -> f64 {
        let factorial: f64 = (1..=order).map(|k| k as f64).product();
        self.0.get(order).map_or(f64::NAN, |c| c * factorial)
    }

    /// Sets coefficient `k` + 1, if there is one, to what makes `rate` the derivative of this series at coefficient `k`.
    pub fn integrate(&mut self, rate: &Self, k: usize) {
        if let (Some(next), Some(rate)) = (self.0.get_mut(k + 1), rate.0.get(k)) {
            *next = rate / (k + 1) as f64;
        }
    }
}

/// Σ_{j=from..=k} a_j b_{k−j}.
#[inline(always)]
fn convolved(a: &[f64], b: &[f64], from: usize, k: usize) -> f64 {
    (from..=k).map(|j| a[j] * b[k - j]).sum()
}

impl<const N: usize> Add for Taylor<N> {
    type Output = Self;
    #[inline(never)]
    fn add(self, b: Self) -> Self {
        Taylor(core::array::from_fn(|k| self.0[k] + b.0[k]))
    }
}

impl<const N: usize> Sub for Taylor<N> {
    type Output = Self;
    #[inline(never)]
    fn sub(self, b: Self) -> Self {
        Taylor(core::array::from_fn(|k| self.0[k] - b.0[k]))
    }
}

impl<const N: usize> Neg for Taylor<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Taylor(self.0.map(|c| -c))
    }
}

// Kernels are inlined as a whole into their callers; a product of series, which is a loop of its own, is not.
impl<const N: usize> Mul for Taylor<N> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, b: Self) -> Self {
        let first = |k: usize| self.0[0] * b.0[k];
        Taylor(core::array::from_fn(|k| if k == 0 { first(0) } else { first(k) + convolved(&self.0, &b.0, 1, k) }))
    }
}

impl<const N: usize> Div for Taylor<N> {
    type Output = Self;
    #[inline(never)]
    fn div(self, b: Self) -> Self {
        // c b = a, order by order.
        let mut c = [0.0; N];
        for k in 0..N {
            let known: f64 = (0..k).map(|j| c[j] * b.0[k - j]).sum();
            c[k] = if k == 0 { self.0[0] / b.0[0] } else { (self.0[k] - known) / b.0[0] };
        }
        Taylor(c)
    }
}

impl<const N: usize> Scalar for Taylor<N> {
    const ZERO: Self = Taylor([0.0; N]);

    /// A constant.
    fn splat(value: f64) -> Self {
        Taylor(core::array::from_fn(|k| if k == 0 { value } else { 0.0 }))
    }

    #[inline(never)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        let value = |k: usize| convolved(&self.0, &a.0, 0, k) + b.0[k];
        Taylor(core::array::from_fn(|k| if k == 0 { self.0[0].mul_add(a.0[0], b.0[0]) } else { value(k) }))
    }

    /// By its value: a series that is just at the limit stays as it is.
    fn saturate(self, limit: Self) -> Self {
        match (self.0.first(), limit.0.first()) {
            (Some(value), Some(bound)) if value > bound => limit,
            (Some(value), Some(bound)) if *value < -bound => -limit,
            _ => self,
        }
    }

    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        // (sin a)' = a' cos a and (cos a)' = −a' sin a, order by order.
        let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
        for k in 0..N {
            (sin[k], cos[k]) = if k == 0 {
                self.0[0].sin_cos()
            } else {
                let rate = |of: &[f64]| (1..=k).map(|j| j as f64 * self.0[j] * of[k - j]).sum::<f64>() / k as f64;
                (rate(&cos), -rate(&sin))
            };
        }
        (Taylor(sin), Taylor(cos))
    }

    /// At zero that of zero.
    fn positive(self) -> Self {
        if self.0[0] <= 0.0 { Self::ZERO } else { self }
    }

    #[inline(never)]
    fn tanh(self) -> Self {
        // (tanh a)' = a' (1 − tanh² a), order by order: `rest` is 1 − tanh² a as far as it is known.
        let (mut tanh, mut rest) = ([0.0; N], [0.0; N]);
        for k in 0..N {
            tanh[k] = if k == 0 {
                libm::tanh(self.0[0])
            } else {
                (1..=k).map(|j| j as f64 * self.0[j] * rest[k - j]).sum::<f64>() / k as f64
            };
            let squared: f64 = (0..=k).map(|j| tanh[j] * tanh[k - j]).sum();
            rest[k] = if k == 0 { 1.0 - squared } else { -squared };
        }
        Taylor(tanh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Series = Taylor<6>;

    /// t = t* + h.
    const fn time(at: f64) -> Series {
        Taylor([at, 1.0, 0.0, 0.0, 0.0, 0.0])
    }

    fn close(found: Series, derivatives: [f64; 6]) {
        for (order, derivative) in derivatives.into_iter().enumerate() {
            let found = found.derivative(order);
            assert!((found - derivative).abs() < 1e-12 * (1.0 + derivative.abs()), "{order}: {found} {derivative}");
        }
    }

    #[test]
    fn products_and_quotients_have_the_derivatives_of_their_closed_forms() {
        let t = time(2.0);
        close(t * t * t, [8.0, 12.0, 12.0, 6.0, 0.0, 0.0]);
        close(t.mul_add(t, -t), [2.0, 3.0, 2.0, 0.0, 0.0, 0.0]);
        close(t.neg_mul_add(t, t), [-2.0, -3.0, -2.0, 0.0, 0.0, 0.0]);
        // (1/t)⁽ᵏ⁾ = (−1)ᵏ k!/tᵏ⁺¹
        close(Series::splat(1.0) / t, [0.5, -0.25, 0.25, -0.375, 0.75, -1.875]);
        close((t * t - t) / t, [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn sine_and_cosine_have_the_derivatives_of_their_closed_forms() {
        // sin(3t) and cos(3t), and sin²+cos² of an angle that is not linear.
        let (s, c) = ((1.2_f64).sin(), (1.2_f64).cos());
        let angle = Series::splat(3.0) * time(0.4);
        let (sin, cos) = Scalar::sin_cos(angle);
        close(sin, [s, 3.0 * c, -9.0 * s, -27.0 * c, 81.0 * s, 243.0 * c]);
        close(cos, [c, -3.0 * s, -9.0 * c, 27.0 * s, 81.0 * c, -243.0 * s]);
        let (sin, cos) = Scalar::sin_cos(time(0.7) * time(0.7) * time(0.7));
        close(sin * sin + cos * cos, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn hyperbolic_tangents_have_the_derivatives_of_their_closed_form() {
        let u = libm::tanh(0.3);
        let rest = 1.0 - u * u;
        // By u' = 1 − u², five times, for tanh(t) and with a factor per order for tanh(2t).
        let orders = [
            u,
            rest,
            -2.0 * u * rest,
            rest * (6.0 * u * u - 2.0),
            u * rest * (16.0 - 24.0 * u * u),
            rest * (16.0 - 120.0 * u * u + 120.0 * u * u * u * u),
        ];
        close(Scalar::tanh(time(0.3)), orders);
        let mut factor = 1.0;
        close(Scalar::tanh(Series::splat(2.0) * time(0.15)), orders.map(|order| (order * factor, factor *= 2.0).0));
    }

    #[test]
    fn prop_values_are_those_of_doubles_and_what_is_not_known_stays_above() {
        let (a, b, c) = (Series::value(0.1), Series::value(-0.7), Series::value(1e9));
        assert_eq!((a * b).0[0], 0.1 * -0.7);
        assert_eq!((a / b).0[0], 0.1 / -0.7);
        assert_eq!(a.mul_add(b, c).0[0], Scalar::mul_add(0.1, -0.7, 1e9));
        assert_eq!(Scalar::sin_cos(b).0.0[0], Scalar::sin_cos(-0.7_f64).0);
        let known = |x: Series| x.0.iter().take_while(|c| c.is_finite()).count();
        let mut two = Series::value(3.0);
        two.integrate(&a, 0);
        assert_eq!(two.0[1], 0.1);
        for x in [two * two, time(1.0) / two, two.mul_add(two, two), Scalar::sin_cos(two).1, two - a * a * two] {
            assert_eq!(known(x), if x.0[0] == 3.0 - 0.1 * 0.1 * 3.0 { 1 } else { 2 }, "{x:?}");
        }
        two.integrate(&two.clone(), 5);
        assert!(two.derivative(6).is_nan() && two.0[1] == 0.1);
    }

    #[test]
    fn limits_act_by_the_value() {
        let (t, limit) = (time(0.5), Series::splat(0.75));
        assert_eq!(t.saturate(limit), t);
        assert_eq!(time(0.8).saturate(limit), limit);
        assert_eq!(time(-0.8).saturate(limit), -limit);
        assert_eq!(time(0.75).saturate(limit), time(0.75));
        assert!(Series::value(f64::NAN).saturate(limit).0[0].is_nan());
    }
}
