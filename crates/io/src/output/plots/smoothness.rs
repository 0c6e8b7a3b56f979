//! Figures of `forwardstep smoothness`: several orders beside each other, and the jump of the baseline over its filter.

use forwardstep_check::smoothness::{Filters, OfOrder, Trace};

use super::super::error::EncodeError;
use super::super::palette::{self, Ground};
use super::super::text;
use super::figure::{Across, Figure, Line, Panel};

/// What is beside the measured line.
const SOFT: [u8; 3] = [0x9a, 0xa0, 0xa9];

/// Points of a line: more than a panel has pixels show nothing.
const POINTS: usize = 400;

/// The torque of one axis around an instant at which it would jump, less what it is just before, and the disagreement over time, for several
/// orders, as SVG. `unit` is that of the torque.
///
/// # Errors
/// [`EncodeError`] when the drawing library fails.
pub fn plot_orders(orders: &[OfOrder], traces: &[Trace], at_s: f64, unit: &str) -> Result<String, EncodeError> {
    let colour = |order: usize| {
        let index = orders.iter().position(|of| of.order == order).unwrap_or(0);
        palette::ramp(index, orders.len(), Ground::Light)
    };
    let trace = |trace: &Trace| {
        let before = trace.t_s.iter().zip(&trace.torque).take_while(|(t_s, _)| **t_s < at_s);
        let from = before.last().map_or(0.0, |(_, torque)| *torque);
        let points = thinned(trace.t_s.iter().zip(&trace.torque).map(|(t_s, torque)| (*t_s, torque - from)).collect());
        Line { colour: colour(trace.order), width: 2, points }
    };
    let course = |of: &OfOrder| Line {
        colour: colour(of.order),
        width: 1,
        points: thinned(of.t_s.iter().copied().zip(of.disagreement.iter().copied()).collect()),
    };
    Figure {
        title: "Higher order is smoother and slower".into(),
        legend: orders.iter().map(|of| (format!("order {}", of.order), colour(of.order))).collect(),
        panels: vec![
            Panel {
                title: "The torque around a jump of what is heard".into(),
                x: Across::Stretch,
                y: format!("change of τ{}", text::in_unit(unit)),
                log: false,
                lines: traces.iter().map(trace).collect(),
                guide: None,
            },
            Panel {
                title: "Disagreement".into(),
                x: Across::Time,
                y: "largest difference of positions".into(),
                log: true,
                lines: orders.iter().map(course).collect(),
                guide: None,
            },
        ],
        columns: 2,
        panel: (460, 320),
        empty: "No order was tried.",
    }
    .svg()
}

/// Every so many points, as many as can be seen.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let step = points.len().div_ceil(POINTS).max(1);
    points.into_iter().step_by(step).collect()
}

/// The largest jump of the torque under the baseline over the time constant of its filter, in a log-log plot beside a line of slope −1,
/// as SVG. `unit` is that of the torque.
///
/// # Errors
/// [`EncodeError`] when the drawing library fails.
pub fn plot_filters(filters: &Filters, unit: &str) -> Result<String, EncodeError> {
    let measured = palette::ramp(0, 2, Ground::Light);
    let mut points: Vec<(f64, f64)> = filters.jumps.iter().map(|of| (of.filter_s, of.jump.size)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Through the narrowest filter.
    let inverse = points.first().map_or_else(Vec::new, |(least, size)| {
        points.iter().map(|(filter_s, _)| (*filter_s, size * least / filter_s)).collect()
    });
    Figure {
        title: "Backstepping: the jump of the torque and the filter".into(),
        legend: vec![
            (format!("largest jump, slope {:.3}", filters.slope).replace('-', "−"), measured),
            ("slope −1".into(), SOFT),
        ],
        panels: vec![Panel {
            title: String::new(),
            x: Across::Log("ε in s"),
            y: format!("largest jump of τ{}", text::in_unit(unit)),
            log: true,
            lines: vec![Line { colour: SOFT, width: 1, points: inverse }, Line { colour: measured, width: 2, points }],
            guide: None,
        }],
        columns: 1,
        panel: (520, 380),
        empty: "No filter was tried.",
    }
    .svg()
}
