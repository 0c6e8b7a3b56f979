//! How a figure of panels is laid out and drawn.

use std::ops::Range;

use forwardstep_core::signal::superscript;
use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, TextStyle};

use super::super::error::EncodeError;

const INK: RGBColor = RGBColor(0x16, 0x19, 0x1f);
const SOFT: RGBColor = RGBColor(0x50, 0x57, 0x63);
const GRID: RGBColor = RGBColor(0xe9, 0xeb, 0xee);
const FRAME: RGBColor = RGBColor(0xb4, 0xb9, 0xc1);
const FONT: &str = "Helvetica, Arial, sans-serif";

/// A figure: a title, a legend beside no data, panels in rows.
pub(super) struct Figure {
    pub(super) title: String,
    pub(super) legend: Vec<(String, [u8; 3])>,
    pub(super) panels: Vec<Panel>,
    pub(super) columns: usize,
    /// Width and height of a panel in pixels.
    pub(super) panel: (u32, u32),
    /// Instead of panels, when there are none.
    pub(super) empty: &'static str,
}

/// One set of axes.
pub(super) struct Panel {
    pub(super) title: String,
    /// What the horizontal axis is.
    pub(super) x: Across,
    /// Name and unit of the vertical axis.
    pub(super) y: String,
    pub(super) log: bool,
    pub(super) lines: Vec<Line>,
    /// Dashed, with a word; it does not widen the axis.
    pub(super) guide: Option<(f64, String)>,
}

/// What a horizontal axis is.
pub(super) enum Across {
    /// Time from zero, in s.
    Time,
    /// Time between the first point and the last, in s.
    Stretch,
    /// A quantity over whole decades, with its name and unit.
    Log(&'static str),
}

/// Pixels for the labels of the vertical axis.
const LABELS: u32 = 52;
/// Pixels to the right of the axes, for half a label.
const RIGHT: u32 = 20;

/// One signal; gaps where values are not finite.
pub(super) struct Line {
    pub(super) colour: [u8; 3],
    pub(super) width: u32,
    pub(super) points: Vec<(f64, f64)>,
}

/// The drawing library knows whole pixels only, so it draws this much larger, and the picture is scaled down.
const FINE: u32 = 4;
const MARGIN: u32 = 18;
const TITLE: u32 = 40;
const LEGEND_ROW: u32 = 20;

fn style(size: u32, colour: RGBColor) -> TextStyle<'static> {
    (FONT, size * FINE).into_font().color(&colour)
}

fn failed(error: impl std::fmt::Display) -> EncodeError {
    EncodeError::Plot(error.to_string())
}

impl Figure {
    /// The figure as SVG.
    pub(super) fn svg(&self) -> Result<String, EncodeError> {
        let columns = self.columns.clamp(1, self.panels.len().max(1)) as u32;
        let rows = (self.panels.len() as u32).div_ceil(columns).max(1);
        let (width, height) = self.panel;
        let full_width = columns * width + 2 * MARGIN;
        let places = self.legend_places(full_width - 2 * MARGIN);
        let legend_rows = places.last().map_or(0, |(_, row)| row + 1);
        let top = TITLE + legend_rows * LEGEND_ROW + if legend_rows > 0 { 10 } else { 0 };
        let full_height = top + rows * height + MARGIN;
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, (full_width * FINE, full_height * FINE)).into_drawing_area();
            root.fill(&RGBColor(255, 255, 255)).map_err(failed)?;
            let write = |text: &str, x: u32, y: u32, style: &TextStyle<'_>| {
                root.draw(&Text::new(text.to_owned(), ((x * FINE) as i32, (y * FINE) as i32), style.clone()))
                    .map_err(failed)
            };
            let left = style(17, INK).pos(Pos::new(HPos::Left, VPos::Center));
            write(&self.title, MARGIN, 24, &left)?;
            let small = style(12, SOFT).pos(Pos::new(HPos::Left, VPos::Center));
            for ((name, [r, g, b]), (x, row)) in self.legend.iter().zip(&places) {
                let (x, y) = (MARGIN + x, TITLE + row * LEGEND_ROW + 8);
                let corner = |x: u32, y: u32| ((x * FINE) as i32, (y * FINE) as i32);
                let swatch = [corner(x, y - 2), corner(x + 16, y + 1)];
                root.draw(&Rectangle::new(swatch, RGBColor(*r, *g, *b).filled())).map_err(failed)?;
                write(name, x + 22, y, &small)?;
            }
            if self.panels.is_empty() {
                write(self.empty, MARGIN, top + 30, &small)?;
            }
            for (k, panel) in self.panels.iter().enumerate() {
                let (column, row) = (k as u32 % columns, k as u32 / columns);
                let (x, y) = (MARGIN + column * width, top + row * height);
                panel.draw(root.clone().shrink((x * FINE, y * FINE), (width * FINE, height * FINE)))?;
            }
            root.present().map_err(failed)?;
        }
        let (width, height) = (full_width * FINE, full_height * FINE);
        let drawn = format!("<svg width=\"{width}\" height=\"{height}\"");
        Ok(svg.replacen(&drawn, &format!("<svg width=\"{full_width}\" height=\"{full_height}\""), 1))
    }

    /// Where legend entries go: pixels from the left and row.
    fn legend_places(&self, width: u32) -> Vec<(u32, u32)> {
        let (mut x, mut row) = (0, 0);
        let mut places = Vec::new();
        for (name, _) in &self.legend {
            let wide = 22 + name.chars().count() as u32 * 7 + 18;
            if x > 0 && x + wide > width {
                (x, row) = (0, row + 1);
            }
            places.push((x, row));
            x += wide;
        }
        places
    }
}

impl Panel {
    fn draw(&self, area: DrawingArea<SVGBackend<'_>, plotters::coord::Shift>) -> Result<(), EncodeError> {
        let (width, height) = area.dim_in_pixel();
        let (width, height) = (width / FINE, height / FINE);
        let place = |x: u32, y: u32| ((x * FINE) as i32, (y * FINE) as i32);
        let title = style(13, INK).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(self.title.clone(), place(LABELS, 12), title)).map_err(failed)?;
        let unit = style(12, SOFT);
        let (x, side) = if self.title.is_empty() { (LABELS, HPos::Left) } else { (width - RIGHT, HPos::Right) };
        let unit = unit.pos(Pos::new(side, VPos::Center));
        area.draw(&Text::new(self.y.clone(), place(x, 12), unit)).map_err(failed)?;

        let on_axis = |v: f64| on_axis(v, self.log);
        let (t0, t1) = self.across();
        let Some((low, high)) = range(&self.lines, self.log) else {
            let style = style(12, SOFT).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new("no value can be drawn", place(LABELS, 40), style)).map_err(failed)?;
            return Ok(());
        };
        let (x_name, x_log) = match self.x {
            Across::Time | Across::Stretch => ("t in s", false),
            Across::Log(name) => (name, true),
        };
        let x_ticks = if x_log { decades(t0, t1) } else { ticks(t0, t1, (width as usize / 80).max(2)) };
        let y_ticks = if self.log { decades(low, high) } else { ticks(low, high, (height as usize / 36).max(2)) };
        let x_step = x_ticks.windows(2).map(|w| w[1] - w[0]).next().unwrap_or(1.0);
        let y_step = y_ticks.windows(2).map(|w| w[1] - w[0]).next().unwrap_or(1.0);
        let mut chart = ChartBuilder::on(&area)
            .margin_top(24 * FINE)
            .margin_right(RIGHT * FINE)
            .margin_bottom(6 * FINE)
            .x_label_area_size(34 * FINE)
            .y_label_area_size(LABELS * FINE)
            .build_cartesian_2d(Ticked { range: t0..t1, ticks: x_ticks }, Ticked { range: low..high, ticks: y_ticks })
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(GRID.mix(0.0))
            .bold_line_style(GRID.stroke_width(FINE))
            .axis_style(FRAME.stroke_width(FINE))
            .label_style(style(11, SOFT))
            .axis_desc_style(style(12, SOFT))
            .x_desc(x_name)
            .set_all_tick_mark_size(3 * FINE)
            .x_label_formatter(&|t| if x_log { power(*t) } else { tick(*t, x_step) })
            .y_label_formatter(&|v| if self.log { power(*v) } else { tick(*v, y_step) })
            .draw()
            .map_err(failed)?;
        if let Some((value, word)) =
            self.guide.as_ref().map(|(v, word)| (on_axis(*v), word)).filter(|(v, _)| *v > low && *v < high)
        {
            let dash = (t1 - t0) / f64::from(width) * 6.0;
            let mut t = t0;
            while t < t1 {
                let piece = vec![(t, value), ((t + dash).min(t1), value)];
                chart.plotting_area().draw(&PathElement::new(piece, SOFT.stroke_width(FINE))).map_err(failed)?;
                t += dash * 1.8;
            }
            let style = style(11, SOFT).pos(Pos::new(HPos::Right, VPos::Bottom));
            let place = (t1 - dash, value + (high - low) * 0.02);
            chart.plotting_area().draw(&Text::new(word.clone(), place, style)).map_err(failed)?;
        }
        for line in &self.lines {
            let [r, g, b] = line.colour;
            let colour = RGBColor(r, g, b).stroke_width(line.width * FINE * 5 / 4);
            let inside = |&(t, v): &(f64, f64)| (self::on_axis(t, x_log), on_axis(v).clamp(low, high));
            for piece in line.points.split(|p| !on_axis(p.1).is_finite()).filter(|piece| !piece.is_empty()) {
                let path: Vec<_> = piece.iter().map(inside).collect();
                chart.plotting_area().draw(&PathElement::new(path, colour)).map_err(failed)?;
            }
        }
        Ok(())
    }

    /// Where the horizontal axis begins and ends.
    fn across(&self) -> (f64, f64) {
        let times = || self.lines.iter().flat_map(|line| line.points.iter().map(|p| p.0));
        let (low, high) = match self.x {
            Across::Time => (0.0, times().fold(0.0, f64::max)),
            Across::Stretch => (times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)),
            Across::Log(_) => {
                let decades = || times().map(|t| on_axis(t, true)).filter(|t| t.is_finite());
                let least = decades().fold(f64::INFINITY, f64::min);
                (((least + 1e-9).floor()), (decades().fold(f64::NEG_INFINITY, f64::max) - 1e-9).ceil())
            }
        };
        match (low.is_finite(), high > low) {
            (true, true) => (low, high),
            (true, false) => (low, low + 1.0),
            (false, _) => (0.0, 1.0),
        }
    }
}

/// An axis with labels where we want them.
struct Ticked {
    range: Range<f64>,
    ticks: Vec<f64>,
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.range.clone()).map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

/// What the vertical axis covers: whole decades, or a little more than the values. A run that blew up at its end does not
/// flatten everything before: then it is what the signals kept to until then.
fn range(lines: &[Line], log: bool) -> Option<(f64, f64)> {
    let finite = |points: &[(f64, f64)]| {
        let values: Vec<f64> = points.iter().map(|p| on_axis(p.1, log)).filter(|v| v.is_finite()).collect();
        let least = values.iter().copied().reduce(f64::min)?;
        Some((least, values.iter().copied().fold(least, f64::max)))
    };
    let join = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
    let (least, greatest) = lines.iter().filter_map(|line| finite(&line.points)).reduce(join)?;
    if log {
        let high = (greatest + 1e-9).ceil();
        let low = (least - 1e-9).floor().max(high.min(0.0) - 18.0);
        return Some((low.min(high - 1.0), high));
    }
    let early = |line: &Line| finite(&line.points[..(line.points.len() * 95).div_ceil(100)]);
    let usual = lines.iter().filter_map(early).reduce(join).map_or(0.0, |(low, high)| low.abs().max(high.abs()));
    let largest = least.abs().max(greatest.abs());
    let most = if usual > 0.0 && largest > 100.0 * usual { usual } else { largest };
    let (low, high) = (least.max(-most), greatest.min(most));
    // Half of the greatest double and its opposite are still apart by a double.
    let (low, high) = (low.clamp(-f64::MAX / 4.0, f64::MAX / 4.0), high.clamp(-f64::MAX / 4.0, f64::MAX / 4.0));
    let pad = if high > low { 0.06 * (high - low) } else { (0.1 * high.abs()).max(1e-3) };
    Some((low - pad, high + pad))
}

/// A value where it stands on the axis: its logarithm, or itself.
fn on_axis(v: f64, log: bool) -> f64 {
    match log {
        false => v,
        true if v > 0.0 => v.log10(),
        true => f64::NAN,
    }
}

/// At most about `count` round numbers from `low` to `high`.
fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let rough = (high - low) / count as f64;
    let size = 10_f64.powi(rough.log10().floor() as i32);
    let step = [1.0, 2.0, 2.5, 5.0].map(|m| m * size).into_iter().find(|step| *step >= rough).unwrap_or(10.0 * size);
    // A power of ten may be below all numbers, or above.
    if !(step > 0.0 && step.is_finite()) {
        return Vec::new();
    }
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last.min(first.saturating_add(100))).map(|k| k as f64 * step).collect()
}

fn decades(low: f64, high: f64) -> Vec<f64> {
    let step = ((high - low) / 7.0).ceil().max(1.0);
    let count = ((high - low) / step).floor() as i64;
    (0..=count).rev().map(|k| high - k as f64 * step).collect()
}

fn tick(v: f64, step: f64) -> String {
    let largest = v.abs().max(step);
    if !(1e-3..1e5).contains(&largest) {
        return if v.abs() < step * 1e-6 { "0".into() } else { super::super::text::number(v) };
    }
    let mut places = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    let scaled = step * 10_f64.powi(places as i32);
    places += usize::from((scaled - scaled.round()).abs() > 1e-6);
    let v = if v.abs() < step * 1e-6 { 0.0 } else { v };
    format!("{v:.places$}").replace('-', "−")
}

fn power(exponent: f64) -> String {
    match exponent.round() as i32 {
        0 => "1".into(),
        1 => "10".into(),
        exponent => format!("10{}", superscript(exponent)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_lie_on_the_axis() {
        assert_eq!(ticks(0.0, 1.0, 5), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0].map(|v: f64| 0.2 * (v / 0.2).round()));
        assert_eq!(ticks(-3.0, 12.0, 4), [0.0, 5.0, 10.0]);
    }

    /// The step of subnormal numbers was zero, and counting ticks overflowed.
    #[test]
    fn regress_an_axis_of_the_least_and_largest_numbers_has_ticks_or_none() {
        for (low, high) in
            [(5e-324, 1e-323), (0.0, 4e-322), (-1e-310, 1e-310), (f64::MIN, f64::MAX), (1e300, 1e300 * (1.0 + 1e-15))]
        {
            let found = ticks(low, high, 4);
            assert!(found.len() <= 101 && found.iter().all(|v| v.is_finite()), "{low:e} {high:e}: {found:?}");
        }
    }
}
