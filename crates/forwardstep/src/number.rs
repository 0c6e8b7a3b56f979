//! Numbers as people read them.

use forwardstep::sim::quantity::with_power;

/// Three digits, with a power of ten where the number is very small or large.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if (0.01..1e5).contains(&size) {
        let places = (2.0 - size.log10().floor()).max(0.0) as usize;
        format!("{value:.places$}")
    } else {
        with_power(&format!("{value:.2e}"))
    }
}
