//! The progress bar: simulated time, speed against real time, time left.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use forwardstep::sim::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::console::remark;

const PARTS: u64 = 1000;
/// The bar is redrawn no more often.
const REDRAW: Duration = Duration::from_millis(100);
/// Shorter work is not logged.
const FIRST_LINE: Duration = Duration::from_secs(30);

/// A bar on standard error; a line now and then when that is not a terminal.
pub(crate) struct Bar {
    bar: ProgressBar,
    /// What is simulated, where that is not the run itself.
    what: Option<Cow<'static, str>>,
    started: Instant,
    /// When that began which is simulated now, and how far it was last.
    began: Instant,
    t_s: f64,
    drawn: Instant,
    /// When the next line is due, after the start.
    next_line: Duration,
}

impl Bar {
    pub(crate) fn new() -> Self {
        Bar::of(None)
    }

    /// One that says what is simulated.
    pub(crate) fn named(what: impl Into<Cow<'static, str>>) -> Self {
        Bar::of(Some(what.into()))
    }

    fn of(what: Option<Cow<'static, str>>) -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}") {
            bar.set_style(style);
        }
        let started = Instant::now();
        Bar { bar, what, started, began: started, t_s: 0.0, drawn: started, next_line: FIRST_LINE }
    }

    pub(crate) fn update(&mut self, progress: Progress) {
        let now = Instant::now();
        // A prediction simulates its dynamics several times.
        if progress.t_s < self.t_s {
            self.began = now;
        }
        self.t_s = progress.t_s;
        if self.bar.is_hidden() {
            self.line_at(now, progress).into_iter().for_each(remark);
        } else if now - self.drawn >= REDRAW {
            self.drawn = now;
            self.bar.set_position((progress.t_s / progress.end_s * PARTS as f64) as u64);
            self.bar.set_message(self.words(now, progress));
        }
    }

    /// What a log is told, at intervals that double.
    fn line_at(&mut self, now: Instant, progress: Progress) -> Option<String> {
        let taken = now - self.started;
        if taken < self.next_line {
            return None;
        }
        self.next_line = 2 * taken;
        Some(format!("After {}: {}", duration(taken.as_secs_f64()), self.words(now, progress)))
    }

    fn words(&self, now: Instant, Progress { t_s, end_s }: Progress) -> String {
        let wall_s = (now - self.began).as_secs_f64();
        let left_s = if t_s > 0.0 { (end_s - t_s) / t_s * wall_s } else { f64::INFINITY };
        let what = self.what.as_ref().map_or_else(String::new, |what| format!("{what}: "));
        format!("{what}{t_s:.1} of {end_s} s, {} × real time, {} left", speed(t_s / wall_s), duration(left_s))
    }

    /// The bar of what is simulated next, as a part of the same work.
    pub(crate) fn next(self, what: impl Into<Cow<'static, str>>) -> Self {
        let (started, next_line) = (self.started, self.next_line);
        self.hide();
        Bar { started, next_line, ..Bar::named(what) }
    }

    /// Makes room for a line beside it.
    pub(crate) fn hide(&self) {
        self.bar.finish_and_clear();
    }

    /// Makes room for what follows.
    pub(crate) fn clear(self) {
        self.bar.finish_and_clear();
    }
}

/// A factor to about two digits.
pub(crate) fn speed(factor: f64) -> String {
    if factor < 10.0 { format!("{factor:.1}") } else { format!("{factor:.0}") }
}

/// A time in words of the clock.
pub(crate) fn duration(s: f64) -> String {
    let whole = s.ceil();
    if !(0.0..3.6e7).contains(&whole) {
        return "very long".into();
    }
    let whole = whole as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, min, s) => format!("{min} min {s:02} s"),
        (h, min, _) => format!("{h} h {min:02} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run that crawled said nothing for hours where its words went to a file.
    #[test]
    fn regress_a_log_is_told_how_far_a_long_run_is() {
        let mut bar = Bar::named("the same in continuous time");
        let mut line = |after_s: u64, t_s: f64| {
            let now = bar.started + Duration::from_secs(after_s);
            bar.line_at(now, Progress { t_s, end_s: 100.0 })
        };
        assert_eq!(line(29, 1.0), None);
        let said = line(40, 10.0).unwrap();
        assert_eq!(said, "After 40 s: the same in continuous time: 10.0 of 100 s, 0.2 × real time, 6 min 00 s left");
        assert_eq!(line(79, 20.0), None);
        assert!(line(80, 20.0).unwrap().starts_with("After 1 min 20 s: "));
        assert_eq!(line(159, 20.0), None);
        // What begins anew has its own pace.
        let mut again = Bar::new();
        again.update(Progress { t_s: 5.0, end_s: 10.0 });
        let began = again.began;
        again.update(Progress { t_s: 6.0, end_s: 10.0 });
        assert_eq!(again.began, began);
        again.update(Progress { t_s: 1.0, end_s: 20.0 });
        assert!(again.began > began);
        // Its parts are one work.
        let bar = Bar { next_line: Duration::from_secs(160), ..bar }.next("what follows");
        assert_eq!(bar.next_line, Duration::from_secs(160));
    }
}
