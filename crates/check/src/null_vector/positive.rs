//! Numbers that are never negative, added, multiplied and divided, but never subtracted.
//!
//! Each operation then keeps the relative error of what it is given and adds its own, at most u = 2⁻⁵³. That is lost where a
//! result leaves the range of `f64`; [`Wide`] has an exponent of its own and never does.

/// The arithmetic of an elimination without subtraction.
pub(crate) trait Positive: Copy {
    const ZERO: Self;

    /// A number that is not negative.
    fn of(value: f64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// `other` is not zero.
    fn over(self, other: Self) -> Self;
    fn is_zero(self) -> bool;
    fn exceeds(self, other: Self) -> bool;
    /// Whether what cannot be zero left the range in which its digits count.
    fn is_lost(self) -> bool;
    /// The nearest `f64`.
    fn value(self) -> f64;

    /// The sum of all, with a relative error of at most ⌈log₂ n⌉ u.
    fn sum(terms: &[Self]) -> Self {
        match terms {
            [] => Self::ZERO,
            [one] => *one,
            _ => {
                let (left, right) = terms.split_at(terms.len() / 2);
                Self::sum(left).plus(Self::sum(right))
            }
        }
    }
}

/// How many additions lie on the longest way to the sum of so many terms.
pub(crate) fn sum_depth(terms: usize) -> f64 {
    f64::from(terms.next_power_of_two().trailing_zeros())
}

impl Positive for f64 {
    const ZERO: f64 = 0.0;

    fn of(value: f64) -> f64 {
        value
    }

    fn plus(self, other: f64) -> f64 {
        self + other
    }

    fn times(self, other: f64) -> f64 {
        self * other
    }

    fn over(self, other: f64) -> f64 {
        self / other
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    fn exceeds(self, other: f64) -> bool {
        self > other
    }

    fn is_lost(self) -> bool {
        !self.is_normal()
    }

    fn value(self) -> f64 {
        self
    }
}

/// m · 2^e with m = 0 or 1 ≤ m < 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wide {
    m: f64,
    e: i64,
}

const FRACTION: u64 = (1 << 52) - 1;
const ONE: u64 = 1023 << 52;

/// Exponents further apart than this make the smaller term less than a rounding error.
const FAR: i64 = 64;

/// 2^e for −1022 ≤ e ≤ 1023.
fn power(e: i64) -> f64 {
    f64::from_bits(((1023 + e) as u64) << 52)
}

impl Wide {
    fn normalised(m: f64, e: i64) -> Wide {
        if m == 0.0 {
            return Wide::ZERO;
        }
        if m < f64::MIN_POSITIVE {
            return Wide::normalised(m * power(FAR), e - FAR);
        }
        let bits = m.to_bits();
        Wide { m: f64::from_bits(bits & FRACTION | ONE), e: e + (bits >> 52) as i64 - 1023 }
    }
}

impl Positive for Wide {
    const ZERO: Wide = Wide { m: 0.0, e: 0 };

    fn of(value: f64) -> Wide {
        Wide::normalised(value, 0)
    }

    fn plus(self, other: Wide) -> Wide {
        if self.is_zero() {
            return other;
        }
        let (large, small) = if other.exceeds(self) { (other, self) } else { (self, other) };
        match large.e - small.e {
            _ if small.is_zero() => large,
            apart if apart > FAR => large,
            apart => Wide::normalised(large.m + small.m * power(-apart), large.e),
        }
    }

    fn times(self, other: Wide) -> Wide {
        Wide::normalised(self.m * other.m, self.e + other.e)
    }

    fn over(self, other: Wide) -> Wide {
        Wide::normalised(self.m / other.m, self.e - other.e)
    }

    fn is_zero(self) -> bool {
        self.m == 0.0
    }

    fn exceeds(self, other: Wide) -> bool {
        match (self.is_zero(), other.is_zero()) {
            (true, _) => false,
            (false, true) => true,
            (false, false) => (self.e, self.m) > (other.e, other.m),
        }
    }

    fn is_lost(self) -> bool {
        false
    }

    fn value(self) -> f64 {
        match self.e {
            1024.. => f64::INFINITY,
            -1022..=1023 => self.m * power(self.e),
            // Two steps, so that what is below the range of normal numbers is rounded once.
            -1086..=-1023 => self.m * power(-1022) * power(self.e + 1022),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_wide_numbers_are_those_of_f64_within_its_range() {
        let numbers = [0.0, 1.0, 1.5, 3.0, 0.1, 1e-17, 7e22, 1e300, 3e-310, f64::MIN_POSITIVE, f64::MAX];
        for a in numbers {
            assert_eq!(Wide::of(a).value(), a);
            for b in numbers {
                let (x, y) = (Wide::of(a), Wide::of(b));
                assert_eq!(x.exceeds(y), a > b, "{a} {b}");
                let near = |wide: Wide, exact: f64| {
                    let normal = exact.is_normal() || exact == 0.0;
                    assert!(!normal || wide.value() == exact, "{a} {b}: {wide:?} {exact}");
                };
                near(x.plus(y), a + b);
                near(x.times(y), if (a * b).is_normal() { a * b } else { f64::NAN });
                if b > 0.0 {
                    near(x.over(y), if (a / b).is_normal() { a / b } else { f64::NAN });
                }
            }
        }
    }

    #[test]
    fn wide_numbers_leave_the_range_of_f64_and_come_back() {
        let tiny = Wide::of(1e-300);
        let there = (0..50).fold(Wide::of(0.75), |number, _| number.times(tiny));
        assert_eq!([there.value(), Wide::of(1.0).over(there).value()], [0.0, f64::INFINITY]);
        let back = (0..50).fold(there, |number, _| number.over(tiny));
        assert!((back.value() - 0.75).abs() < 1e-13);
        assert!(tiny.exceeds(there) && !there.exceeds(tiny));
        assert_eq!(Wide::of(2.0).times(Wide::ZERO), Wide::ZERO);
    }

    #[test]
    fn sums_are_as_deep_as_is_said() {
        assert_eq!([0, 1, 2, 3, 4, 5, 1025].map(sum_depth), [0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 11.0]);
        assert_eq!(f64::sum(&[1.0; 1000]), 1000.0);
        // One after the other, 1e-16 would be lost ten thousand times.
        let mut terms = vec![1e-16; 10_001];
        terms[0] = 1.0;
        assert!((f64::sum(&terms) - (1.0 + 1e-12)).abs() < 1e-15);
        assert_eq!(f64::sum(&[]), 0.0);
    }
}
