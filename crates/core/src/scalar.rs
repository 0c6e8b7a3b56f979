//! The number that kernels compute with.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Kernel, Vectors, dispatch, trig};

/// A number, or several side by side, that robot kernels and laws compute with.
///
/// Implemented for `f64`, `f32` and [`Lanes`], for [`Interval`](crate::expression::Interval), which encloses what the others
/// round, and for [`Taylor`](crate::Taylor), which carries derivatives. Time, history and events stay `f64`.
///
/// Every operation is correctly rounded or, for [`Scalar::sin_cos`], this crate's own code, and for [`Scalar::tanh`] one implementation everywhere, so that a lane of a vector
/// carries the same bits as the scalar computation.
pub trait Scalar:
    Copy
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero in every lane.
    const ZERO: Self;

    /// The same value in every lane.
    fn splat(value: f64) -> Self;

    /// `self · a + b`, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;

    /// `b − self · a`, rounded once.
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        (-self).mul_add(a, b)
    }

    /// The number itself, or ±`limit` where it is beyond; not-a-number stays.
    fn saturate(self, limit: Self) -> Self;

    /// The number itself where it is positive, zero elsewhere; not-a-number stays.
    fn positive(self) -> Self;

    /// Sine and cosine of an angle in radians, within 2.2 units in the last place for |angle| < 10⁵ and to full
    /// accuracy, slowly, beyond.
    fn sin_cos(self) -> (Self, Self);

    /// Hyperbolic tangent, within a unit in the last place or two.
    fn tanh(self) -> Self;

    /// [`Scalar::sin_cos`] of every angle, as far as the shortest of the three slices goes. The same bits, but several
    /// angles at once where the scalar is a single number.
    #[inline(always)]
    fn sin_cos_each(angles: &[Self], sin: &mut [Self], cos: &mut [Self]) {
        let n = angles.len().min(sin.len()).min(cos.len());
        let mut i = 0;
        while i < n {
            (sin[i], cos[i]) = angles[i].sin_cos();
            i += 1;
        }
    }
}

/// A scalar that holds the same quantity of [`Packed::WIDTH`] agents, read from and written to columns.
pub trait Packed: Scalar {
    /// How many agents.
    const WIDTH: usize;

    /// What a processor must have for kernels of such scalars.
    type Processor: Copy + Send + Sync + 'static;

    /// Runs a kernel of such scalars.
    fn run<K: Kernel>(processor: Self::Processor, kernel: K) -> K::Output;

    /// Makes one from the value of every lane, numbered from zero.
    fn from_lanes(lane: impl FnMut(usize) -> f64) -> Self;

    /// The value of one lane; not-a-number for a lane that does not exist.
    fn lane(self, lane: usize) -> f64;

    /// Reads the first entries of `column`; lanes beyond its end repeat the last entry, zero if there is none.
    fn load(column: &[f64]) -> Self;

    /// Writes the first entries of `column`, as many as there are.
    fn store(self, column: &mut [f64]);
}

impl Packed for f64 {
    const WIDTH: usize = 1;

    /// Every processor will do.
    type Processor = ();

    fn run<K: Kernel>((): (), kernel: K) -> K::Output {
        dispatch(kernel)
    }

    #[inline(always)]
    fn from_lanes(mut lane: impl FnMut(usize) -> f64) -> f64 {
        lane(0)
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        if lane == 0 { self } else { f64::NAN }
    }

    #[inline(always)]
    fn load(column: &[f64]) -> f64 {
        match column.first() {
            Some(value) => *value,
            None => 0.0,
        }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64]) {
        if let Some(value) = column.first_mut() {
            *value = self;
        }
    }
}

impl<const N: usize> Packed for Lanes<N> {
    const WIDTH: usize = N;

    type Processor = Vectors;

    fn run<K: Kernel>(vectors: Vectors, kernel: K) -> K::Output {
        vectors.run(kernel)
    }

    #[inline(always)]
    fn from_lanes(lane: impl FnMut(usize) -> f64) -> Self {
        Lanes(core::array::from_fn(lane))
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        match self.0.get(lane) {
            Some(value) => *value,
            None => f64::NAN,
        }
    }

    #[inline(always)]
    fn load(column: &[f64]) -> Self {
        match column.first_chunk() {
            Some(full) => Lanes(*full),
            None => {
                let mut lanes = [f64::load(column); N];
                let mut i = 1;
                while i < N {
                    lanes[i] = match column.get(i) {
                        Some(value) => *value,
                        None => lanes[i - 1],
                    };
                    i += 1;
                }
                Lanes(lanes)
            }
        }
    }

    #[inline(always)]
    fn store(self, column: &mut [f64]) {
        match column.first_chunk_mut() {
            Some(full) => *full = self.0,
            None => {
                for (value, lane) in column.iter_mut().zip(self.0) {
                    *value = lane;
                }
            }
        }
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        #[cfg(feature = "std")]
        {
            f64::mul_add(self, a, b)
        }
        #[cfg(not(feature = "std"))]
        {
            libm::fma(self, a, b)
        }
    }

    #[inline(always)]
    fn saturate(self, limit: Self) -> Self {
        if self > limit {
            limit
        } else if self < -limit {
            -limit
        } else {
            self
        }
    }

    #[inline(always)]
    fn positive(self) -> Self {
        if self < 0.0 { 0.0 } else { self }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        trig::sin_cos(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        libm::tanh(self)
    }

    #[inline(always)]
    fn sin_cos_each(angles: &[Self], sin: &mut [Self], cos: &mut [Self]) {
        let n = angles.len().min(sin.len()).min(cos.len());
        let mut i = 0;
        while i < n {
            let count = (n - i).min(8);
            let mut chunk = Lanes([0.0; 8]);
            chunk.0[..count].copy_from_slice(&angles[i..i + count]);
            let (s, c) = trig::sin_cos_lanes(chunk);
            sin[i..i + count].copy_from_slice(&s.0[..count]);
            cos[i..i + count].copy_from_slice(&c.0[..count]);
            i += count;
        }
    }
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        #[cfg(feature = "std")]
        {
            f32::mul_add(self, a, b)
        }
        #[cfg(not(feature = "std"))]
        {
            libm::fmaf(self, a, b)
        }
    }

    #[inline(always)]
    fn saturate(self, limit: Self) -> Self {
        if self > limit {
            limit
        } else if self < -limit {
            -limit
        } else {
            self
        }
    }

    #[inline(always)]
    fn positive(self) -> Self {
        if self < 0.0 { 0.0 } else { self }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        // Through double precision: correctly rounded but for ties, and one reduction to keep right.
        let (sin, cos) = trig::sin_cos(self as f64);
        (sin as f32, cos as f32)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        libm::tanhf(self)
    }
}

/// `N` numbers side by side: the same quantity of `N` robots of one model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Lanes<const N: usize>(pub [f64; N]);

macro_rules! lanewise {
    ($($operator:ident :: $method:ident),+) => {$(
        impl<const N: usize> $operator for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                let mut i = 0;
                while i < N {
                    self.0[i] = $operator::$method(self.0[i], other.0[i]);
                    i += 1;
                }
                self
            }
        }
    )+};
}
lanewise!(Add::add, Sub::sub, Mul::mul, Div::div);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        let mut i = 0;
        while i < N {
            self.0[i] = -self.0[i];
            i += 1;
        }
        self
    }
}

impl<const N: usize> Scalar for Lanes<N> {
    const ZERO: Self = Lanes([0.0; N]);

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Lanes([value; N])
    }

    #[inline(always)]
    fn mul_add(mut self, a: Self, b: Self) -> Self {
        let mut i = 0;
        while i < N {
            self.0[i] = Scalar::mul_add(self.0[i], a.0[i], b.0[i]);
            i += 1;
        }
        self
    }

    #[inline(always)]
    fn saturate(mut self, limit: Self) -> Self {
        let mut i = 0;
        while i < N {
            self.0[i] = self.0[i].saturate(limit.0[i]);
            i += 1;
        }
        self
    }

    #[inline(always)]
    fn positive(self) -> Self {
        Lanes(self.0.map(Scalar::positive))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        trig::sin_cos_lanes(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        Lanes(self.0.map(libm::tanh))
    }
}
