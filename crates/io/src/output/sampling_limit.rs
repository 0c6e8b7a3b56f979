//! The longest period with which a scenario still works, measured by its own runs, beside the one that rules allow.
//!
//! A run works where it completes, no |s| exceeds what is accepted, and what remains of the disagreement, or of the error, does not
//! either. What is accepted is stated, or taken from a run with a period far below the rule. The period is then bisected: where works and
//! does not alternate, one of the ends is found.

use std::ops::ControlFlow;

use forwardstep_check::{Hold, SamplingMargin, WholeLoop};
use forwardstep_sim::recording::{Ending, Progress, Signal};
use forwardstep_sim::{Control, Setup, SetupError, VelocitySensor, simulate};

use super::metrics::{Disagreement, Metrics};

/// The run that others are compared with has a period this much shorter than the rule.
const FINER: f64 = 8.0;
/// Where that one does not come closer, so many shorter ones by the same factor are tried.
const SHORTER: u32 = 3;
/// A run whose |s| is this much larger than in that one, and larger than its |z|, does not work. Where s is zero without sampling, sampling
/// alone makes it, as much as the period is long.
const LARGER: f64 = 2.0;
/// Nor one that leaves this much of the disagreement at the start, unless that one leaves half as much already.
const REMAINS: f64 = 0.1;
/// The period is found to this part.
const TOLERANCE: f64 = 0.004;
/// No period longer than this many times the first that works is tried.
const LONGEST: f64 = 1024.0;
/// Nor one with which a run has fewer samples: they would tell nothing.
const FEWEST_SAMPLES: f64 = 10.0;
/// Samples of a run by which the search for a rule begins, and the longest period with which it does, s.
const BEGIN_SAMPLES: f64 = 2000.0;
const LONGEST_BEGIN_S: f64 = 0.05;

/// How the controllers of a scenario shall sample, where that is not as it states; exact measurements where it states nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deployment {
    /// The computation delay as a part of the period.
    pub late: Option<f64>,
    /// The cut-off of the filter of velocities, Hz.
    pub filter_hz: Option<f64>,
}

/// The longest period by rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// It, s.
    pub period_s: f64,
    /// A mode of the loop as a whole grows from there on; else the sampling margin is 1.
    pub linearised: bool,
}

/// What a run must keep within to count as one that works.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accepted {
    /// The largest |s| of any axis, rad/s or m/s; by default twice that of a run with a short period, or as much as |z| comes to there.
    pub peak_error: Option<f64>,
    /// The final disagreement or error; by default a tenth of that at the start, or twice that of the same run.
    pub remains: Option<f64>,
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Its period, s.
    pub period_s: f64,
    /// Its largest |s|; not finite where the run did not complete.
    pub peak_error: f64,
    /// Its largest |z|; infinite where there is none.
    pub peak_reference: f64,
    /// Its final disagreement or error; likewise.
    pub remains: f64,
    /// That at its start.
    pub initial: f64,
}

/// What is seen of a measurement while it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measuring {
    /// A run made a step.
    Runs {
        /// Its period, s.
        period_s: f64,
        /// How far it is.
        progress: Progress,
    },
    /// A run ended.
    Ran(Trial),
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingLimit {
    /// What rules promise before the run; `None` where they say nothing.
    pub rule: Option<Rule>,
    /// The longest period that works, s; `None` where the shortest one does not, or nothing can be measured.
    pub measured_s: Option<f64>,
    /// What is to be known of it.
    pub remark: Option<LimitRemark>,
    /// What was accepted.
    pub peak_error: f64,
    /// Likewise.
    pub remains: f64,
    /// The runs that were made, in their order.
    pub trials: Vec<Trial>,
}

/// What is to be known of what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitRemark {
    /// No longer period was tried: with one a run would have fewer than ten samples.
    LongestTried,
    /// Agents start where they are to be, and stay, whatever the period is.
    NothingMoves,
}

impl LimitRemark {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            LimitRemark::LongestTried => {
                "longer ones were not tried: they would leave a run fewer than ten samples; let `time.end_s` be longer"
            }
            LimitRemark::NothingMoves => "nothing has to move, whatever the period is; let agents start elsewhere",
        }
    }
}

impl Deployment {
    /// `setup` sampled with this period.
    pub fn apply(self, setup: &Setup, period_s: f64) -> Setup {
        let mut sampled = setup.clone();
        if sampled.control.is_none() {
            sampled = sampled.sampled(1.0 / period_s);
        }
        if let Some(control) = &mut sampled.control {
            control.sample_hz = 1.0 / period_s;
            if let Some(late) = self.late {
                control.computation_delay_s = late * period_s;
            }
            if let Some(cut_off_hz) = self.filter_hz {
                control.sensors.velocity = VelocitySensor::Filtered { cut_off_hz };
            }
        }
        sampled
    }

    /// The period up to which rules promise that samples are fast enough, s.
    pub fn rule(self, setup: &Setup) -> Option<Rule> {
        // What is looked at takes as long as there are samples: where no period is stated, the search begins with few.
        let unstated_s = LONGEST_BEGIN_S.min(setup.time.end_s / BEGIN_SAMPLES);
        let period_s = setup.control.as_ref().map_or(unstated_s, |control| 1.0 / control.sample_hz);
        let hold = |period_s: f64| self.apply(setup, period_s).control.as_ref().map_or(Hold::IDEAL, Hold::of);
        let margin_s = SamplingMargin::longest_period_s(setup, period_s, hold);
        let linearised_s = if SamplingMargin::is_enough(&self.apply(setup, period_s)) {
            None
        } else {
            WholeLoop::longest_period_s(period_s, |period_s| self.apply(setup, period_s))
        };
        let margin = margin_s.map(|period_s| Rule { period_s, linearised: false });
        let linearised = linearised_s.map(|period_s| Rule { period_s, linearised: true });
        let both = margin.into_iter().chain(linearised).filter(|rule| rule.period_s.is_finite());
        both.reduce(|a, b| if b.period_s < a.period_s { b } else { a })
    }

    /// The computation delay at a period, s.
    fn delay_s(self, setup: &Setup, period_s: f64) -> f64 {
        let stated = |control: &Control| control.computation_delay_s;
        self.late.map_or_else(|| setup.control.as_ref().map_or(0.0, stated), |late| late * period_s)
    }
}

impl SamplingLimit {
    /// Measures it; `watch` is called after every step, and after every run.
    ///
    /// # Errors
    /// [`SetupError`] when the setup has no meaning.
    pub fn measure(
        setup: &Setup,
        deployment: Deployment,
        accepted: Accepted,
        watch: &mut dyn FnMut(Measuring),
    ) -> Result<SamplingLimit, SetupError> {
        let rule = deployment.rule(setup);
        let stated_s = setup.control.as_ref().map_or(1e-3, |control| 1.0 / control.sample_hz);
        let longest_s = setup.time.end_s / FEWEST_SAMPLES;
        let first_s = rule.map_or(stated_s, |rule| rule.period_s / FINER).min(longest_s);
        let first_s = first_s.max(1.001 * deployment.delay_s(setup, first_s));
        let mut trials = Vec::new();
        let mut run = |period_s: f64| {
            let trial = trial(&deployment.apply(setup, period_s), period_s, watch)?;
            trials.push(trial);
            watch(Measuring::Ran(trial));
            Ok::<Trial, SetupError>(trial)
        };
        // One that does not come closer is no measure for others: the rule knows s alone, and what is around it may need shorter periods.
        let settles = |trial: Trial| {
            let closer = trial.initial == 0.0 || trial.remains <= trial.initial;
            trial.remains.is_finite() && (closer || accepted.remains.is_some())
        };
        let (mut first_s, mut first) = (first_s, run(first_s)?);
        for _ in 0..SHORTER {
            let shorter_s = (first_s / FINER).max(1.001 * deployment.delay_s(setup, first_s / FINER));
            if settles(first) || shorter_s >= first_s {
                break;
            }
            (first_s, first) = (shorter_s, run(shorter_s)?);
        }
        let peak_error = accepted.peak_error.unwrap_or((LARGER * first.peak_error).max(first.peak_reference));
        let remains = accepted.remains.unwrap_or((LARGER * first.remains).max(REMAINS * first.initial));
        let works = |trial: Trial| trial.peak_error <= peak_error && trial.remains <= remains;
        let most_s = longest_s.min(LONGEST * first_s).max(first_s);
        // Of what is accepted by its user something may be measured all the same.
        let is_still = accepted == Accepted::default() && first.initial == 0.0 && remains == 0.0;
        let (measured_s, remark) = if is_still {
            (None, Some(LimitRemark::NothingMoves))
        } else if settles(first) && works(first) {
            let (found_s, is_longest) = bisect(first_s, most_s, |period_s| Ok(works(run(period_s)?)))?;
            (Some(found_s), is_longest.then_some(LimitRemark::LongestTried))
        } else {
            (None, None)
        };
        Ok(SamplingLimit { rule, measured_s, remark, peak_error, remains, trials })
    }
}

/// The longest period that works, where `low_s` does, and whether it is the longest that is tried, `most_s`.
fn bisect(
    mut low_s: f64,
    most_s: f64,
    mut works: impl FnMut(f64) -> Result<bool, SetupError>,
) -> Result<(f64, bool), SetupError> {
    let mut high_s = (4.0 * low_s).min(most_s);
    while low_s < most_s && works(high_s)? {
        low_s = high_s;
        high_s = (2.0 * high_s).min(most_s);
    }
    if low_s >= most_s {
        return Ok((low_s, true));
    }
    while high_s > (1.0 + TOLERANCE) * low_s {
        let middle_s = 0.5 * (low_s + high_s);
        if works(middle_s)? { low_s = middle_s } else { high_s = middle_s }
    }
    Ok((low_s, false))
}

/// Runs `setup` in full.
fn trial(setup: &Setup, period_s: f64, watch: &mut dyn FnMut(Measuring)) -> Result<Trial, SetupError> {
    let outcome = simulate(setup, &mut |progress| {
        watch(Measuring::Runs { period_s, progress });
        ControlFlow::Continue(())
    })?;
    let (initial, last) = match Metrics::of(setup, &outcome.recording, None, None).disagreement {
        Disagreement::Measured { initial, last, .. } => (initial, last),
        Disagreement::Absent(_) => (0.0, 0.0),
    };
    if outcome.ending != Ending::Completed {
        let lost = f64::INFINITY;
        return Ok(Trial { period_s, peak_error: lost, peak_reference: lost, remains: lost, initial });
    }
    let peak = |signal: Signal| {
        let columns = outcome.recording.columns.iter().filter(|column| column.signal == signal);
        columns.flat_map(|column| &column.values).fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let peak_error = peak(Signal::TrackingError);
    // Where there is no z, s alone tells nothing; nor does z without s.
    let has = |signal: Signal| outcome.recording.columns.iter().any(|column| column.signal == signal);
    let leads = has(Signal::Reference(0)) && has(Signal::TrackingError);
    let peak_reference = if leads { peak(Signal::Reference(0)) } else { f64::INFINITY };
    Ok(Trial { period_s, peak_error, peak_reference, remains: last, initial })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_period_that_works_is_found_and_not_looked_for_for_ever() {
        for edge in [1.01, 3.9, 4.0, 77.7] {
            let mut tries = 0;
            let found = bisect(1.0, 1024.0, |period_s| {
                tries += 1;
                Ok(period_s < edge)
            });
            let (found, is_longest) = found.expect("no run fails");
            assert!(
                !is_longest && found < edge && edge <= (1.0 + TOLERANCE) * found && tries < 20,
                "{edge}: {found} in {tries}"
            );
        }
        assert_eq!(bisect(1.0, 1000.0, |_| Ok(true)).expect("no run fails"), (1000.0, true));
    }
}
