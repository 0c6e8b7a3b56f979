//! Fewer points for display that look the same: the least and greatest value of every bucket of rows, and break-points
//! at which a signal that jumps is drawn as a jump.

use std::ops::Range;

/// Where the points of a picture come from; shared by all signals of a recording, so that they share their times.
pub(crate) struct Grid {
    /// Rising; a break-point occurs twice.
    pub(crate) t_s: Vec<f64>,
    places: Vec<Place>,
    /// Rows were left out.
    pub(crate) decimated: bool,
}

enum Place {
    /// One row as it is.
    Row(usize),
    /// Two points: least and greatest of the rows, the earlier one first.
    Bucket(Range<usize>),
    /// Two points: before and after.
    Break(Break),
}

struct Break {
    t_s: f64,
    /// Rows before it, back to the break-point before.
    before: Range<usize>,
    /// Rows at this very time.
    on: Range<usize>,
    /// Rows after it, up to the next break-point.
    after: Range<usize>,
}

impl Grid {
    /// About `budget` points for rows at `rows_t_s`. Break-points are kept, unless they alone would take half of them.
    pub(crate) fn new(rows_t_s: &[f64], break_points: &[f64], budget: usize) -> Grid {
        let breaks = if break_points.len() * 4 > budget { &[] } else { break_points };
        let breaks = split(rows_t_s, breaks);
        let rows: usize = rows_t_s.len();
        let available = budget.saturating_sub(2 * breaks.len()).max(8);
        let rows_per_bucket = if rows <= available { 1 } else { rows.div_ceil(available / 2) };

        let mut grid = Grid { t_s: Vec::new(), places: Vec::new(), decimated: rows_per_bucket > 1 };
        let mut start = 0;
        for found in breaks {
            grid.fill(rows_t_s, start..found.before.end, rows_per_bucket);
            start = found.on.end;
            grid.t_s.extend([found.t_s, found.t_s]);
            grid.places.push(Place::Break(found));
        }
        grid.fill(rows_t_s, start..rows, rows_per_bucket);
        grid
    }

    /// First and last row of the recording stay as they are; the rest goes into buckets.
    fn fill(&mut self, rows_t_s: &[f64], mut rows: Range<usize>, rows_per_bucket: usize) {
        let last = (rows.end == rows_t_s.len()).then(|| rows.next_back()).flatten();
        if rows.start == 0 {
            self.row(rows_t_s, rows.next());
        }
        while !rows.is_empty() {
            let bucket = rows.start..(rows.start + rows_per_bucket).min(rows.end);
            rows.start = bucket.end;
            if bucket.len() <= 2 {
                bucket.for_each(|row| self.row(rows_t_s, Some(row)));
            } else {
                self.t_s.extend([rows_t_s[bucket.start], rows_t_s[bucket.end - 1]]);
                self.places.push(Place::Bucket(bucket));
            }
        }
        self.row(rows_t_s, last);
    }

    fn row(&mut self, rows_t_s: &[f64], row: Option<usize>) {
        if let Some(row) = row {
            self.t_s.push(rows_t_s[row]);
            self.places.push(Place::Row(row));
        }
    }

    /// The values of a signal at the grid's times; missing ones are NaN.
    pub(crate) fn sample(&self, rows_t_s: &[f64], values: &[f64], may_jump: bool) -> Vec<f32> {
        let value = |row: usize| values.get(row).copied().unwrap_or(f64::NAN);
        let mut points = Vec::with_capacity(self.t_s.len());
        for place in &self.places {
            match place {
                Place::Row(row) => points.push(value(*row) as f32),
                Place::Bucket(rows) => points.extend(least_and_greatest(rows.clone(), value)),
                Place::Break(at) => points.extend(at.sides(rows_t_s, value, may_jump).map(|v| v as f32)),
            }
        }
        points
    }
}

fn split(rows_t_s: &[f64], break_points: &[f64]) -> Vec<Break> {
    let mut breaks: Vec<Break> = Vec::new();
    for &t_s in break_points {
        let near = 1e-9 * (1.0 + t_s.abs());
        let on = rows_t_s.partition_point(|t| *t < t_s - near)..rows_t_s.partition_point(|t| *t <= t_s + near);
        let start = breaks.last().map_or(0, |last| last.on.end);
        // Between two rows there is room for one break-point only, and none outside of the recording.
        if on.start <= start || on.end >= rows_t_s.len() {
            continue;
        }
        if let Some(last) = breaks.last_mut() {
            last.after.end = on.start;
        }
        breaks.push(Break { t_s, before: start..on.start, after: on.end..rows_t_s.len(), on });
    }
    breaks
}

impl Break {
    /// Values just before and just after. A jump is told from a slope by continuing both sides to the break-point; what is
    /// drawn are recorded values, held up to the jump, or a line where there is none.
    fn sides(&self, rows_t_s: &[f64], value: impl Fn(usize) -> f64, may_jump: bool) -> [f64; 2] {
        let (left, right) = (self.before.end - 1, self.after.start);
        if self.on.len() > 1 {
            return [value(self.on.start), value(self.on.end - 1)];
        }
        let jump = may_jump && {
            let continued = |near: usize, far: usize| {
                let slope = (value(near) - value(far)) / (rows_t_s[near] - rows_t_s[far]);
                value(near) + slope * (self.t_s - rows_t_s[near])
            };
            let from_left = if self.before.len() > 1 { continued(left, left - 1) } else { value(left) };
            let from_right = if self.after.len() > 1 { continued(right, right + 1) } else { value(right) };
            let difference = (value(right) - value(left)).abs();
            difference > 0.0 && (from_right - from_left).abs() >= 0.5 * difference
        };
        match (self.on.clone().next(), jump) {
            (Some(on), false) => [value(on), value(on)],
            (Some(on), true) => {
                let to_left = (value(on) - value(left)).abs();
                let to_right = (value(on) - value(right)).abs();
                if to_right <= to_left { [value(left), value(on)] } else { [value(on), value(right)] }
            }
            (None, true) => [value(left), value(right)],
            (None, false) => {
                let part = (self.t_s - rows_t_s[left]) / (rows_t_s[right] - rows_t_s[left]);
                [value(left) + part * (value(right) - value(left)); 2]
            }
        }
    }
}

/// Both in the order in which they occur, leaving out what is not finite as long as anything is.
fn least_and_greatest(rows: Range<usize>, value: impl Fn(usize) -> f64) -> [f32; 2] {
    let finite = || rows.clone().filter(|row| value(*row).is_finite());
    let least = finite().reduce(|a, b| if value(b) < value(a) { b } else { a });
    let greatest = finite().reduce(|a, b| if value(b) > value(a) { b } else { a });
    match (least, greatest) {
        (Some(least), Some(greatest)) => [least.min(greatest), least.max(greatest)].map(|row| value(row) as f32),
        _ => [f32::NAN; 2],
    }
}
