//! Fewer points for display that look the same, and what is between them: of every bucket of rows the first as it is, of what a signal does until
//! the last row what shows, and break-points at which a signal that jumps is drawn as a jump.

use std::ops::Range;

use forwardstep_sim::busy::{Spent, progress};

/// Where the points of a picture come from; shared by all signals of a recording, so that they share their times.
pub(crate) struct Grid {
    /// Rising; a break-point occurs twice, or three times where there is a row at it.
    pub(crate) t_s: Vec<f64>,
    /// Of each point whether it is a row as it was recorded. The others are drawn where they are so that curves look as they do.
    pub(crate) exact: Vec<bool>,
    places: Vec<Place>,
    /// Rows were left out.
    pub(crate) decimated: bool,
}

enum Place {
    /// One row as it is.
    Row(usize),
    /// Three points: the first of the rows, then at their middle and at the last of them what [`course`] says.
    Bucket(Range<usize>),
    /// Two points, before and after, and between them the row at this very time, if there is one.
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
        Grid::busy(rows_t_s, break_points, budget, std::iter::empty())
    }

    /// The same with more points where these signals change more: half of all points are spread evenly over the rows, half over what they change
    /// by. A start that is over in a hundredth of the run would else be one bucket, whose extremes stand far from where they belong.
    pub(crate) fn busy<'a>(
        rows_t_s: &[f64],
        break_points: &[f64],
        budget: usize,
        signals: impl Iterator<Item = &'a [f64]>,
    ) -> Grid {
        let breaks = if break_points.len() * 4 > budget { &[] } else { break_points };
        let breaks = split(rows_t_s, breaks);
        let rows: usize = rows_t_s.len();
        let available = budget.saturating_sub(3 * breaks.len()).max(12);
        let decimated = rows > available;
        let progress = if decimated { progress(rows, signals, Spent::OnChanges) } else { Vec::new() };
        let share = 3.0 / available as f64;
        let bucket_end = |start: usize| match progress.get(start) {
            Some(from) => progress.partition_point(|share_so_far| *share_so_far < from + share).max(start + 1),
            None => start + 1,
        };

        let mut grid = Grid { t_s: Vec::new(), exact: Vec::new(), places: Vec::new(), decimated };
        let mut start = 0;
        for found in breaks {
            grid.fill(rows_t_s, start..found.before.end, &bucket_end);
            start = found.on.end;
            let exact: &[bool] = match found.on.len() {
                0 => &[false, false],
                1 => &[false, true, false],
                _ => &[true, true],
            };
            // A row at it may be a rounding off.
            let t_s = found.on.clone().next().map_or(found.t_s, |row| rows_t_s[row]);
            grid.t_s.extend(exact.iter().map(|_| t_s));
            grid.exact.extend(exact);
            grid.places.push(Place::Break(found));
        }
        grid.fill(rows_t_s, start..rows, &bucket_end);
        grid
    }

    /// First and last row of the recording stay as they are; the rest goes into buckets.
    fn fill(&mut self, rows_t_s: &[f64], mut rows: Range<usize>, bucket_end: &dyn Fn(usize) -> usize) {
        let last = (rows.end == rows_t_s.len()).then(|| rows.next_back()).flatten();
        if rows.start == 0 {
            self.row(rows_t_s, rows.next());
        }
        while !rows.is_empty() {
            let bucket = rows.start..bucket_end(rows.start).min(rows.end);
            rows.start = bucket.end;
            if bucket.len() <= 3 {
                bucket.for_each(|row| self.row(rows_t_s, Some(row)));
            } else {
                let (from_s, to_s) = (rows_t_s[bucket.start], rows_t_s[bucket.end - 1]);
                self.t_s.extend([0.0, 0.5, 1.0].map(|part| from_s + part * (to_s - from_s)));
                self.exact.extend([true, false, false]);
                self.places.push(Place::Bucket(bucket));
            }
        }
        self.row(rows_t_s, last);
    }

    fn row(&mut self, rows_t_s: &[f64], row: Option<usize>) {
        if let Some(row) = row {
            self.t_s.push(rows_t_s[row]);
            self.exact.push(true);
            self.places.push(Place::Row(row));
        }
    }

    /// The values of a signal at the grid's times; missing ones are NaN.
    pub(crate) fn sample(&self, rows_t_s: &[f64], values: &[f64], may_jump: bool) -> Vec<f64> {
        let value = |row: usize| values.get(row).copied().unwrap_or(f64::NAN);
        let mut points = Vec::with_capacity(self.t_s.len());
        for place in &self.places {
            match place {
                Place::Row(row) => points.push(value(*row)),
                Place::Bucket(rows) => {
                    points.push(value(rows.start));
                    points.extend(course(rows.clone(), rows_t_s, value));
                }
                Place::Break(at) => {
                    let [before, after] = at.sides(rows_t_s, value, may_jump);
                    let on = (at.on.len() == 1).then(|| value(at.on.start));
                    points.extend([Some(before), on, Some(after)].into_iter().flatten());
                }
            }
        }
        points
    }
}

/// Values at times that rise, on straight lines between those that were kept, of which the first and the last go on.
pub(crate) fn between(kept_s: &[f64], kept: &[f64], t_s: &[f64]) -> Vec<f64> {
    let mut next = 0;
    let value = |t_s: &f64| {
        while kept_s.get(next).is_some_and(|kept_s| kept_s < t_s) {
            next += 1;
        }
        let (to, before) = (next.min(kept_s.len().saturating_sub(1)), next.saturating_sub(1));
        match (kept_s.get(before).zip(kept_s.get(to)), kept.get(before).zip(kept.get(to))) {
            (Some((from_s, to_s)), Some((from, to))) if to_s > from_s => {
                from + (to - from) * ((t_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0)
            }
            (_, Some((_, to))) => *to,
            (_, None) => f64::NAN,
        }
    };
    t_s.iter().map(value).collect()
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
    /// Values just before and just after. A jump is told from a slope, and from a bend where rows suffice, by continuing both sides to
    /// the break-point; what is drawn are recorded values, held up to the jump, or a line where there is none.
    fn sides(&self, rows_t_s: &[f64], value: impl Fn(usize) -> f64, may_jump: bool) -> [f64; 2] {
        let (left, right) = (self.before.end - 1, self.after.start);
        if self.on.len() > 1 {
            return [value(self.on.start), value(self.on.end - 1)];
        }
        // Of one row alone there is no slope, so that nothing tells a jump from a bend.
        let jump = may_jump && self.before.len() > 1 && self.after.len() > 1 && {
            let slope = |near: usize, far: usize| (value(near) - value(far)) / (rows_t_s[near] - rows_t_s[far]);
            let line = |near: usize, far: usize| value(near) + slope(near, far) * (self.t_s - rows_t_s[near]);
            // What the slope changes by from one pair of rows to the next bends the line.
            let curve = |near: usize, next: usize, far: usize| {
                let bend = (slope(near, next) - slope(next, far)) / (rows_t_s[near] - rows_t_s[far]);
                line(near, next) + bend * (self.t_s - rows_t_s[near]) * (self.t_s - rows_t_s[next])
            };
            let difference = (value(right) - value(left)).abs();
            // Where a signal turns, both sides are alike and say nothing of how much it changes from row to row.
            let usual = (value(left) - value(left - 1)).abs().max((value(right) - value(right + 1)).abs());
            let apart = |left: f64, right: f64| (right - left).abs() >= 0.5 * difference.max(usual);
            let bends = self.before.len() > 2 && self.after.len() > 2;
            difference > 0.0
                && apart(line(left, left - 1), line(right, right + 1))
                && (!bends || apart(curve(left, left - 1, left - 2), curve(right, right + 1, right + 2)))
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

/// What stands at the middle and at the end of some rows: where nothing exceeds the first and the last of them, the signal as it is; where it turns
/// once, its extreme, and the last value; where it swings, least and greatest in the order in which they occur. What is not finite is left out
/// as long as anything is.
fn course(rows: Range<usize>, rows_t_s: &[f64], value: impl Fn(usize) -> f64) -> [f64; 2] {
    let finite = || rows.clone().filter(|row| value(*row).is_finite());
    let least = finite().reduce(|a, b| if value(b) < value(a) { b } else { a });
    let greatest = finite().reduce(|a, b| if value(b) > value(a) { b } else { a });
    let (Some(least), Some(greatest)) = (least, greatest) else { return [f64::NAN; 2] };
    let (first, last) = (value(rows.start), value(rows.end - 1));
    let ends_are_known = first.is_finite() && last.is_finite();
    match (value(least) < first.min(last), value(greatest) > first.max(last)) {
        (false, false) if ends_are_known => {
            let (from_s, to_s) = (rows_t_s[rows.start], rows_t_s[rows.end - 1]);
            let known: Vec<usize> = finite().collect();
            let of = |column: &dyn Fn(usize) -> f64| known.iter().map(|row| column(*row)).collect::<Vec<f64>>();
            let middle = between(&of(&|row| rows_t_s[row]), &of(&value), &[from_s + 0.5 * (to_s - from_s)]);
            [middle[0], last]
        }
        (true, false) if ends_are_known => [value(least), last],
        (false, true) if ends_are_known => [value(greatest), last],
        _ => [least.min(greatest), least.max(greatest)].map(value),
    }
}

#[cfg(test)]
mod tests {
    use forwardstep_sim::busy::busy_rows;

    use super::*;

    fn rows(count: usize, step: f64) -> Vec<f64> {
        (0..count).map(|k| k as f64 * step).collect()
    }

    #[test]
    fn between_two_that_were_kept_is_a_line_and_beyond_them_the_nearest() {
        let at = |t_s: &[f64]| between(&[0.0, 1.0, 3.0], &[2.0, 4.0, -2.0], t_s);
        assert_eq!(at(&[-1.0, 0.0, 0.25, 1.0, 2.0, 3.0, 5.0]), [2.0, 2.0, 2.5, 4.0, 1.0, -2.0, -2.0]);
        assert!(between(&[], &[], &[1.0])[0].is_nan() && between(&[0.0, 1.0], &[0.0, f64::NAN], &[0.5])[0].is_nan());
        assert_eq!(between(&[2.0], &[7.0], &[0.0, 2.0, 3.0]), [7.0; 3]);
    }

    /// What is over in a hundredth of a run was one row in eight of a path, and had corners.
    #[test]
    fn regress_rows_of_a_path_stand_where_it_moves() {
        let moves: Vec<f64> = (0..3001).map(|k| (-f64::from(k) / 20.0).exp()).collect();
        let picks = busy_rows(3001, 600, std::iter::once(&moves[..]));
        let early = picks.iter().filter(|row| **row <= 100).count();
        assert!(
            (500..=600).contains(&picks.len()) && early > 80 && picks.is_sorted_by(|a, b| a < b),
            "{early} of {}",
            picks.len()
        );
        assert_eq!((picks[0], picks.last()), (0, Some(&3000)));
        assert!(picks.windows(2).all(|pair| pair[1] - pair[0] <= 12), "no part of the run is left out");
        let even = busy_rows(3001, 4, std::iter::empty());
        assert!(even.len() == 4 && even.iter().zip([0, 1000, 2000, 3000]).all(|(row, near)| row.abs_diff(near) < 2));
        assert_eq!(
            (busy_rows(3, 40, std::iter::empty()), busy_rows(0, 40, std::iter::empty())),
            (vec![0, 1, 2], vec![])
        );
    }

    #[test]
    fn a_jump_between_rows_is_upright_and_a_slope_stays_a_slope() {
        let t_s = rows(11, 0.1);
        let grid = Grid::new(&t_s, &[0.25], 100);
        let jump: Vec<f64> = t_s.iter().map(|t| if *t < 0.25 { 1.0 + t } else { 5.0 + t }).collect();
        let at: Vec<usize> = (0..grid.t_s.len()).filter(|k| grid.t_s[*k] == 0.25).collect();
        assert_eq!(at.len(), 2);
        let drawn = grid.sample(&t_s, &jump, true);
        assert_eq!((drawn[at[0]], drawn[at[1]]), (1.2, 5.3));
        let smooth = grid.sample(&t_s, &t_s, true);
        assert_eq!((smooth[at[0]], smooth[at[1]]), (0.25, 0.25));
    }

    /// A torque between two switches that stand nearer than rows has no slope, and one that turns has a bend.
    #[test]
    fn regress_a_bend_between_few_rows_is_no_jump() {
        let t_s = rows(21, 0.05);
        let bent: Vec<f64> = t_s.iter().map(|t| (9.0 * t).sin()).collect();
        for breaks in [&[0.47, 0.52, 0.57][..], &[0.5], &[0.52]] {
            let grid = Grid::new(&t_s, breaks, 200);
            let drawn = grid.sample(&t_s, &bent, true);
            for k in (1..grid.t_s.len()).filter(|k| grid.t_s[*k] == grid.t_s[*k - 1]) {
                assert_eq!(drawn[k], drawn[k - 1], "{breaks:?} at {}", grid.t_s[k]);
            }
        }
    }

    #[test]
    fn a_row_on_a_jump_goes_to_the_side_it_belongs_to() {
        let t_s = rows(11, 0.1);
        let grid = Grid::new(&t_s, &[0.5], 100);
        let place = grid.t_s.iter().position(|t| *t == 0.5).unwrap();
        let drawn =
            |values: &[f64]| -> [f64; 3] { grid.sample(&t_s, values, true)[place..place + 3].try_into().unwrap() };
        let right: Vec<f64> = (0..11).map(|k| if k < 5 { 1.0 } else { 2.0 }).collect();
        let left: Vec<f64> = (0..11).map(|k| if k <= 5 { 1.0 } else { 2.0 }).collect();
        assert_eq!(drawn(&right), [1.0, 2.0, 2.0]);
        assert_eq!(drawn(&left), [1.0, 1.0, 2.0]);
        assert_eq!(grid.exact[place..place + 3], [false, true, false]);
    }

    #[test]
    fn two_rows_at_one_time_are_its_two_sides() {
        let t_s = [0.0, 1.0, 1.0, 2.0];
        let grid = Grid::new(&t_s, &[1.0], 100);
        assert_eq!(grid.t_s, [0.0, 1.0, 1.0, 2.0]);
        assert_eq!(grid.sample(&t_s, &[0.0, 1.0, 7.0, 8.0], true), [0.0, 1.0, 7.0, 8.0]);
    }

    #[test]
    fn decimation_keeps_extremes_ends_and_order() {
        let t_s = rows(100_000, 0.001);
        let mut values: Vec<f64> = t_s.iter().map(|t| t.sin()).collect();
        values[54_321] = 99.0;
        values[77_777] = -98.0;
        values[77_778] = f64::NAN;
        let breaks: Vec<f64> = (1..50).map(|k| k as f64 * 1.9).collect();
        let grid = Grid::new(&t_s, &breaks, 2000);
        assert!(grid.decimated && grid.t_s.len() <= 2200, "{}", grid.t_s.len());
        assert!(grid.t_s.windows(2).all(|w| w[0] <= w[1]));
        let drawn = grid.sample(&t_s, &values, false);
        assert_eq!(drawn.len(), grid.t_s.len());
        assert!(drawn.contains(&99.0) && drawn.contains(&-98.0) && !drawn.iter().any(|v| v.is_nan()));
        assert_eq!((drawn[0], drawn[drawn.len() - 1]), (values[0], values[99_999]));
    }

    /// A curve that was gathered had steps, as flat as a bucket is long, where the run has none.
    #[test]
    fn regress_what_rises_and_falls_is_drawn_where_it_is() {
        let t_s = rows(3001, 0.02);
        let course = |t: f64| (0.8 * t).sin() * (-0.05 * t).exp();
        let values: Vec<f64> = t_s.iter().map(|t| course(*t)).collect();
        let grid = Grid::new(&t_s, &[], 700);
        let drawn = grid.sample(&t_s, &values, true);
        // Where it turns, the extreme may stand half a bucket off, by which a curve without slope changes little.
        let half_s = 0.5 * 0.02 * 13.0;
        for (t, drawn) in grid.t_s.iter().zip(&drawn) {
            assert!((course(*t) - drawn).abs() < 0.5 * 0.65 * half_s * half_s * 4.0, "{t}: {drawn}");
        }
        // What swings within a bucket keeps its extremes.
        let ripple: Vec<f64> = (0..3001).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let drawn = grid.sample(&t_s, &ripple, true);
        assert!(drawn.windows(3).all(|three| three.contains(&1.0) && three.contains(&-1.0)));
    }

    /// Of 300 agents there is room for 64 points; evenly spread, the peak of the start stood a second late.
    #[test]
    fn regress_points_stand_where_signals_move() {
        let t_s = rows(3001, 0.02);
        let values: Vec<f64> = t_s.iter().map(|t| 30.0 * t * (-t / 0.36).exp()).collect();
        let still = vec![7.0; 3001];
        let grid = Grid::busy(&t_s, &[], 64, [&values[..], &still].into_iter());
        assert!(grid.t_s.len() < 80 && grid.exact.iter().filter(|exact| **exact).count() > 20, "{}", grid.t_s.len());
        let drawn = grid.sample(&t_s, &values, true);
        let peak = (0..drawn.len()).max_by(|a, b| drawn[*a].total_cmp(&drawn[*b])).unwrap();
        assert!((grid.t_s[peak] - 0.36).abs() < 0.1, "{}", grid.t_s[peak]);
        // What stands still and what is not finite moves no points.
        for odd in [&still[..], &[f64::NAN; 3001]] {
            let busy = Grid::busy(&t_s, &[], 64, std::iter::once(odd));
            assert_eq!(busy.t_s, Grid::new(&t_s, &[], 64).t_s);
        }
    }

    #[test]
    fn the_course_of_a_bucket_is_itself_its_extreme_or_both() {
        let t_s = rows(5, 1.0);
        let of = |values: [f64; 5]| course(0..5, &t_s, |row| values[row]);
        assert_eq!(of([0.0, 1.0, 3.0, 4.0, 9.0]), [3.0, 9.0]);
        assert_eq!(of([9.0, f64::NAN, f64::NAN, 5.0, 1.0]), [9.0 - 8.0 / 3.0, 1.0]);
        assert_eq!(of([0.0, 7.0, 3.0, 2.0, 1.0]), [7.0, 1.0]);
        assert_eq!(of([0.0, 1.0, 0.5, -7.0, -1.0]), [1.0, -7.0]);
        assert_eq!(of([0.0, -1.0, -0.5, -7.0, -1.0]), [-7.0, -1.0]);
        assert_eq!(of([0.0, -7.0, 8.0, 2.0, -1.0]), [-7.0, 8.0]);
        assert_eq!(of([f64::NAN, 1.0, 4.0, 2.0, 3.0]), [1.0, 4.0]);
        assert!(of([f64::NAN; 5]).iter().all(|value| value.is_nan()));
    }

    /// Extremes stand near the time at which they occurred; what is said to be a row has the values of one.
    #[test]
    fn regress_what_counts_as_a_row_is_one() {
        let t_s = rows(10_000, 0.01);
        let values: Vec<f64> = t_s.iter().map(|t| (7.0 * t).sin()).collect();
        for breaks in [&[][..], &[20.0, 33.333, 50.005]] {
            let grid = Grid::new(&t_s, breaks, 900);
            let drawn = grid.sample(&t_s, &values, true);
            assert_eq!((drawn.len(), grid.exact.len()), (grid.t_s.len(), grid.t_s.len()));
            let rows = (0..drawn.len()).filter(|k| grid.exact[*k]);
            assert!(rows.clone().count() > 290);
            for k in rows {
                let row = t_s.partition_point(|t| *t < grid.t_s[k]);
                assert_eq!((t_s[row], values[row]), (grid.t_s[k], drawn[k]), "{k}");
            }
        }
    }

    #[test]
    fn break_points_outside_of_or_crowding_the_rows_do_no_harm() {
        for breaks in [vec![-1.0, 0.0, 5.0, 9.9], vec![0.11, 0.12, 0.13, 0.19, 0.2, 0.21, 1.0]] {
            for count in [0, 1, 2, 3, 11] {
                let t_s = rows(count, 0.1);
                let grid = Grid::new(&t_s, &breaks, 64);
                assert!(grid.t_s.windows(2).all(|w| w[0] <= w[1]), "{:?}", grid.t_s);
                assert_eq!(grid.sample(&t_s, &t_s, true).len(), grid.t_s.len());
            }
        }
    }
}
