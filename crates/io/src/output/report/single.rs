//! Series in single precision. What stays far from zero, as positions on a map, is stored less where it is, or its last digits would be lost.

use std::collections::BTreeMap;

use serde::Serialize;

/// A series keeps its own origin where its middle is so many times as large as half of what it varies by: what rounding to single precision then
/// moves it by, at most 6·10⁻⁸ of its size, would show beside how it moves.
const FAR: f64 = 100.0;
/// Or where it is so far from zero that rounding would show beside others, even if it varies much.
const FAR_BESIDE_OTHERS: f64 = 1000.0;
/// But never where it comes near to zero: what falls by decades has its digits there, and they are what a logarithmic axis shows.
const WELL_AWAY: f64 = 3.0;

/// Series of one grid, one after the other.
#[derive(Default)]
pub(super) struct Singles {
    pub(super) values: Vec<f32>,
    pub(super) count: usize,
    pub(super) origins: Origins,
}

/// What is to be added to the series that have an entry.
#[derive(Default, Serialize, PartialEq, Debug)]
#[serde(transparent)]
pub(super) struct Origins(BTreeMap<usize, f64>);

impl Singles {
    /// The number of the series.
    pub(super) fn add(&mut self, values: &[f64]) -> usize {
        let origin = origin(values);
        self.values.extend(values.iter().map(|value| (value - origin) as f32));
        if origin != 0.0 {
            self.origins.0.insert(self.count, origin);
        }
        self.count += 1;
        self.count - 1
    }
}

/// The middle of what is far from zero for how much it varies, and else zero.
fn origin(values: &[f64]) -> f64 {
    // What no single can hold is shown as that.
    let held = values.iter().copied().filter(|value| value.abs() < f64::from(f32::MAX));
    let (low, high) = held.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    let exact = half == 0.0 && f64::from(middle as f32) == middle;
    let far = middle.abs() > FAR * half || middle.abs() > FAR_BESIDE_OTHERS && middle.abs() > WELL_AWAY * half;
    if middle.is_finite() && far && !exact { middle } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the page makes of a series.
    fn shown(values: &[f64]) -> Vec<f64> {
        let mut singles = Singles::default();
        let series = singles.add(values);
        let origin = singles.origins.0.get(&series).copied().unwrap_or(0.0);
        singles.values.iter().map(|value| origin + f64::from(*value)).collect()
    }

    #[test]
    fn regress_what_moves_far_from_zero_keeps_the_digits_of_how_it_moves() {
        for (middle, size) in
            [(4e6, 5.0), (-4e6, 5.0), (1.0, 1e-6), (1e9, 1e-3), (0.0, 1.0), (2000.0, 900.0), (3.0, 1.0)]
        {
            let values: Vec<f64> = (0..50).map(|k| middle + size * f64::from(k).sin()).collect();
            for (value, shown) in values.iter().zip(shown(&values)) {
                assert!((value - shown).abs() <= 1e-5 * size.max(1e-9 * middle.abs()), "{middle} {value} {shown}");
            }
        }
    }

    /// What fell from 5000 to 10⁻¹⁰ was stored less its middle, and had spikes and a floor on a logarithmic axis.
    #[test]
    fn regress_what_falls_by_decades_keeps_its_digits() {
        for size in [1.0, 5000.0, -5000.0, 3e9] {
            let values: Vec<f64> = (0..200).map(|k| size * (-0.15 * f64::from(k)).exp()).collect();
            for (value, shown) in values.iter().zip(shown(&values)) {
                assert!((value - shown).abs() <= 1e-7 * value.abs(), "{value} {shown}");
            }
        }
    }

    #[test]
    fn what_is_missing_or_too_large_stays_so_and_constants_keep_their_place() {
        let values = [4e6 + 0.125, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 4e6 + 0.25];
        let shown = shown(&values);
        assert!(shown[1].is_nan() && shown[2] == f64::INFINITY && shown[3] == f64::NEG_INFINITY);
        assert!(shown[4] == f64::INFINITY && (shown[0], shown[5]) == (values[0], values[5]), "{shown:?}");
        assert_eq!(super::origin(&[0.1; 4]), 0.1);
        assert_eq!([super::origin(&[1.5; 4]), super::origin(&[]), super::origin(&[f64::NAN])], [0.0; 3]);
    }
}
