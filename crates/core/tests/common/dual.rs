//! First derivatives without differences: a scalar that carries its derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

use forwardstep_core::Scalar;

/// value + ε · slope with ε² = 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

/// A column of values and their slopes.
pub(crate) fn duals(values: &[f64], slopes: &[f64]) -> Vec<Dual> {
    values.iter().zip(slopes).map(|(value, slope)| Dual { value: *value, slope: *slope }).collect()
}

/// A column of constants.
pub(crate) fn constants(values: &[f64]) -> Vec<Dual> {
    values.iter().map(|value| Dual { value: *value, slope: 0.0 }).collect()
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Dual { value: self.value + b.value, slope: self.slope + b.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Dual { value: self.value - b.value, slope: self.slope - b.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Dual { value: self.value * b.value, slope: self.slope * b.value + self.value * b.slope }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Dual { value, slope: (self.slope - value * b.slope) / b.value }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: -self.slope }
    }
}

impl Scalar for Dual {
    const ZERO: Self = Dual { value: 0.0, slope: 0.0 };

    fn splat(value: f64) -> Self {
        Dual { value, slope: 0.0 }
    }

    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    fn saturate(self, limit: Self) -> Self {
        if self.value > limit.value {
            limit
        } else if self.value < -limit.value {
            -limit
        } else {
            self
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (Dual { value: sin, slope: cos * self.slope }, Dual { value: cos, slope: -sin * self.slope })
    }

    fn positive(self) -> Self {
        if self.value < 0.0 { Self::ZERO } else { self }
    }

    fn tanh(self) -> Self {
        let value = self.value.tanh();
        Dual { value, slope: (1.0 - value * value) * self.slope }
    }
}
