//! The progress bar: simulated time, speed against real time, time left.

use std::time::{Duration, Instant};

use forwardstep::sim::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

const PARTS: u64 = 1000;
/// The bar is redrawn no more often.
const REDRAW: Duration = Duration::from_millis(100);

/// A bar on standard error; nothing at all when that is not a terminal.
pub(crate) struct Bar {
    bar: ProgressBar,
    /// What is simulated, where that is not the run itself.
    what: Option<&'static str>,
    started: Instant,
    drawn: Instant,
}

impl Bar {
    pub(crate) fn new() -> Self {
        Bar::of(None)
    }

    /// One that says what is simulated.
    pub(crate) fn named(what: &'static str) -> Self {
        Bar::of(Some(what))
    }

    fn of(what: Option<&'static str>) -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}") {
            bar.set_style(style);
        }
        let started = Instant::now();
        Bar { bar, what, started, drawn: started }
    }

    pub(crate) fn update(&mut self, progress: Progress) {
        let now = Instant::now();
        if self.bar.is_hidden() || now - self.drawn < REDRAW {
            return;
        }
        self.drawn = now;
        let Progress { t_s, end_s } = progress;
        let wall_s = (now - self.started).as_secs_f64();
        let left_s = if t_s > 0.0 { (end_s - t_s) / t_s * wall_s } else { f64::INFINITY };
        self.bar.set_position((t_s / end_s * PARTS as f64) as u64);
        let what = self.what.map_or_else(String::new, |what| format!("{what}: "));
        self.bar.set_message(format!(
            "{what}{t_s:.1} of {end_s} s, {} × real time, {} left",
            speed(t_s / wall_s),
            duration(left_s)
        ));
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
