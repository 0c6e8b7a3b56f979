//! What is predicted before any robot is simulated, for `summary.json`, `check --json`, the terminal and the report.
//!
//! All of it is for s ≡ 0: robots that follow their references exactly. Beside it stands what was observed.

use forwardstep_check::NoIdeal;
use forwardstep_check::prediction::{
    Course, GuaranteedRate, NoCourse, NoGuaranteedRate, NoPeriodRate, NoRate, PeriodRate, Rate, Unfinished,
};
use forwardstep_sim::{Setup, ThrustLaw};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::decimate::between;
use super::guarantee::Guarantee;
use super::text::number as number_words;
use super::{names, number};
use crate::instant;

/// Points of the course that are kept.
const MOST_POINTS: usize = 400;

/// What is predicted for robots that follow their references exactly, s ≡ 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Predictions {
    /// The course of agreement.
    pub course: PredictedCourse,
    /// The rate of agreement.
    pub rate: PredictedRate,
    /// How much of the spread is left when, for certain; absent where an earlier version predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guarantee: Option<Guarantee>,
}

/// The course of agreement, or why it is not predicted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PredictedCourse {
    /// It, from the reference dynamics alone.
    Found(CourseFound),
    /// Why there is none.
    NoneSince(String),
}

/// The course of agreement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CourseFound {
    /// Some of its times, s.
    #[serde(deserialize_with = "number::all_or_nan")]
    pub t_s: Vec<f64>,
    /// max |q_i − q_j| at those times, rad or m.
    #[serde(deserialize_with = "number::all_or_nan")]
    pub disagreement: Vec<f64>,
    /// Whether the disagreement at the horizon is at most 1 % of the largest.
    pub reached: bool,
    /// When the disagreement exceeds 1 % of its start for the last time, s; null where that is not before the horizon.
    pub settled_s: Option<f64>,
    /// The mean of the positions at the horizon, one entry per axis.
    #[serde(deserialize_with = "number::all_or_nan")]
    pub value: Vec<f64>,
    /// Where the value agreed upon lies, lowest and highest for every axis; null where the cascaded variables bound nothing.
    pub within: Option<Vec<[f64; 2]>>,
    /// The largest torque of every axis of robots under the adaptive or the known law.
    pub peak_torques: Vec<PredictedTorque>,
    /// The largest |s(0)| of an axis, where z(0) is given beside the velocity: so far from s ≡ 0 a run begins; null where it begins there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_error: Option<f64>,
    /// V(0) of all robots under the adaptive or the known law, J; null where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_energy_j: Option<f64>,
    /// The largest relative error that an estimate starts with; null where all is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate_off: Option<f64>,
    /// Whether s can move the value, so that it is that of s ≡ 0 alone; absent where it cannot, and where an earlier version predicted.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub moved_by_s: bool,
}

/// The largest torque of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictedTorque {
    /// Index of the agent.
    pub agent: usize,
    /// Index of the axis.
    pub axis: usize,
    /// With its sign, N m or N.
    #[serde(deserialize_with = "number::or_nan")]
    pub value: f64,
    /// When, s.
    #[serde(deserialize_with = "number::or_nan")]
    pub t_s: f64,
    /// How far the estimate starts from the truth: the largest relative error of a parameter.
    #[serde(deserialize_with = "number::or_nan")]
    pub estimate_off: f64,
    /// What its size cannot exceed while V ≤ V(0) and the state stays near that of s ≡ 0, N m or N; null where V(0) is not known, V may
    /// grow, as with pushes and under digital control, or the run begins with an s(0).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
}

/// The rate of agreement, or why it is not predicted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PredictedRate {
    /// From the characteristic roots of a fixed graph with constant delays.
    Roots {
        /// Real and imaginary part of the rightmost root beside zero, 1/s.
        #[serde(deserialize_with = "number::pair_or_nan")]
        root_per_s: [f64; 2],
        /// How many roots stand there.
        multiplicity: usize,
        /// The size of the last correction of it, 1/s.
        #[serde(deserialize_with = "number::or_nan")]
        correction_per_s: f64,
        /// The relative change of the characteristic matrix that makes it exactly singular there.
        #[serde(deserialize_with = "number::or_nan")]
        backward_error: f64,
        /// The largest disagreement that the start makes by it, rad or m.
        #[serde(deserialize_with = "number::or_nan")]
        excited: f64,
        /// When the disagreement settles to 1 % by it and the next roots, s.
        settled_s: Option<f64>,
    },
    /// From what one period of a network that repeats itself leaves.
    Period {
        /// The common period of switching and delays, s.
        #[serde(deserialize_with = "number::or_nan")]
        period_s: f64,
        /// What one period leaves of a disagreement.
        #[serde(deserialize_with = "number::or_nan")]
        factor: f64,
        /// ln(factor) over the period, 1/s.
        #[serde(deserialize_with = "number::or_nan")]
        rate_per_s: f64,
        /// How far the factors of single periods are from it at most, relative.
        #[serde(deserialize_with = "number::or_nan")]
        wavers: f64,
        /// How many periods it is the mean of.
        periods: usize,
    },
    /// Why there is none.
    NoneSince(String),
}

impl Predictions {
    /// What was found, with the rate per period where one was looked for; `None` where agents follow targets or a leader, and nothing is agreed upon.
    pub fn of(
        setup: &Setup,
        course: &Result<Course, NoCourse>,
        rate: &Result<Rate, NoRate>,
        period: Option<&Result<PeriodRate, NoPeriodRate>>,
        guaranteed: &Result<GuaranteedRate, NoGuaranteedRate>,
    ) -> Option<Predictions> {
        let course = match course {
            Err(
                NoCourse::Ideal(NoIdeal::Leader | NoIdeal::Targets) | NoCourse::Unfinished(Unfinished::Interrupted),
            ) => return None,
            Err(error) => PredictedCourse::NoneSince(names::reason(setup, error)),
            Ok(course) => PredictedCourse::Found(CourseFound::of(course)),
        };
        let rate = match (rate, period) {
            (Err(_), Some(Ok(found))) => PredictedRate::Period {
                period_s: found.period_s,
                factor: found.factor,
                rate_per_s: found.rate_per_s,
                wavers: found.wavers,
                periods: found.periods,
            },
            (Err(error), Some(Err(other))) => PredictedRate::NoneSince(format!(
                "{}, and {}",
                names::reason(setup, error),
                names::reason(setup, other)
            )),
            (Err(error), None) => PredictedRate::NoneSince(names::reason(setup, error)),
            (Ok(rate), _) => PredictedRate::Roots {
                root_per_s: rate.root_per_s,
                multiplicity: rate.multiplicity,
                correction_per_s: rate.correction_per_s,
                backward_error: rate.backward_error,
                excited: rate.excited,
                settled_s: rate.settled.time_s(),
            },
        };
        Some(Predictions { course, rate, guarantee: Some(Guarantee::of(setup, guaranteed)) })
    }

    /// The course, if there is one.
    pub fn course(&self) -> Option<&CourseFound> {
        match &self.course {
            PredictedCourse::Found(course) => Some(course),
            PredictedCourse::NoneSince(_) => None,
        }
    }

    /// The course where there is something of it to draw: on a logarithmic axis there is no zero.
    pub(crate) fn drawn(&self) -> Option<&CourseFound> {
        self.course().filter(|course| !course.stays())
    }

    /// Whether it says no more than that one agent alone has none to agree with.
    pub fn is_of_one_alone(&self, setup: &Setup) -> bool {
        setup.agents.len() < 2 && self.course().is_none()
    }

    /// Sentences for people, without a full stop.
    pub fn sentences(&self, setup: &Setup) -> Vec<String> {
        let unit = names::gap_unit(setup);
        let mut sentences = Vec::new();
        match &self.course {
            PredictedCourse::NoneSince(reason) => sentences.push(format!("course of agreement: none, since {reason}")),
            PredictedCourse::Found(course) if course.stays() => {
                let moved = if is_pushed(setup) { "; what pushes make of it the run shows" } else { "" };
                sentences.push(format!("all agree at the start, and with s ≡ 0 they stay so{moved}"));
                sentences.extend(course.value_sentence(setup));
                sentences.extend(course.torque_sentence(setup));
            }
            PredictedCourse::Found(course) => {
                let reached = if course.reached { "agreement is reached" } else { "agreement is not reached" };
                let delayed = course.delay(setup);
                let settled = match course.settled_s {
                    Some(t_s) => format!(", settled to 1 % after {} s{delayed}", instant(t_s)),
                    // What never comes is not delayed.
                    None if delayed.is_empty() || course.reached => delayed,
                    None => " with s ≡ 0".to_owned(),
                };
                let last = course.disagreement.last().copied().unwrap_or(f64::NAN);
                let end_s = course.t_s.last().copied().unwrap_or(f64::NAN);
                let then = format!("disagreement then {} {unit}", number_words(last));
                sentences.push(format!("{reached} by {end_s} s{settled}; {}", then.trim_end()));
                sentences.extend(course.value_sentence(setup));
                sentences.extend(course.torque_sentence(setup));
            }
        }
        sentences.push(match &self.rate {
            PredictedRate::NoneSince(reason) => format!("rate: none, since {reason}"),
            PredictedRate::Period { period_s, factor, rate_per_s, wavers, periods } => {
                let changes = if *factor < 1.0 { "shrinks" } else { "grows" };
                let (factor, wavers) = (number_words(100.0 * factor), number_words(100.0 * wavers));
                format!(
                    "rate: {} 1/s; every {period_s} s the disagreement {changes} to {factor} % (over {periods} periods, of which single ones \
                     differ from that by up to {wavers} %)",
                    number_words(*rate_per_s)
                )
            }
            PredictedRate::Roots { root_per_s: [re, im], correction_per_s, excited, multiplicity, .. } => {
                let turning = if *im == 0.0 { String::new() } else { format!(" ± {} i", number_words(*im)) };
                let re = number_words(*re);
                let (correction, excited) = (number_words(*correction_per_s), number_words(*excited));
                let into = format!("{excited} {unit}").trim_end().to_owned();
                // Of k roots in one place grows a power of t beside the exponential.
                let several = match multiplicity {
                    0 | 1 => String::new(),
                    &count => {
                        format!(", {count} times, so that a polynomial in t of degree {} at most may stand before its exponential", count - 1)
                    }
                };
                format!("rate: rightmost characteristic root {re}{turning} 1/s (to {correction} 1/s){several}; its part of the disagreement starts from {into}")
            }
        });
        sentences.extend(
            self.guarantee
                .iter()
                .flat_map(|guarantee| guarantee.sentences(setup.time.end_s))
                .map(|sentence| format!("guaranteed: {sentence}")),
        );
        if setup.control.is_some() {
            sentences.push(
                "all of this is of continuous control; what samples change of it the practical verdicts say".into(),
            );
        }
        sentences
    }
}

impl CourseFound {
    fn of(course: &Course) -> CourseFound {
        let rows = course.t_s.len();
        let every = rows.div_ceil(MOST_POINTS).max(1);
        let kept = || (0..rows).filter(|row| row % every == 0 || row + 1 == rows);
        CourseFound {
            t_s: kept().map(|row| course.t_s[row]).collect(),
            disagreement: kept().map(|row| course.disagreement[row]).collect(),
            reached: course.is_reached(),
            settled_s: course.settled.time_s(),
            value: course.value.clone(),
            within: course.within.as_ref().ok().filter(|all| all.iter().flatten().all(|end| end.is_finite())).cloned(),
            peak_torques: (course.peak_torques.iter())
                .map(|peak| PredictedTorque {
                    agent: peak.agent,
                    axis: peak.axis,
                    value: peak.value,
                    t_s: peak.t_s,
                    estimate_off: peak.estimate_off,
                    at_most: peak.at_most,
                })
                .collect(),
            start_error: Some(course.start.s).filter(|s| *s > 0.0),
            start_energy_j: course.start.energy_j,
            estimate_off: Some(course.start.estimate_off).filter(|off| *off > 0.0 && off.is_finite()),
            moved_by_s: course.moved_by_s,
        }
    }

    /// Whether all agree from the start on as long as everybody follows.
    pub(crate) fn stays(&self) -> bool {
        self.disagreement.iter().all(|apart| *apart == 0.0)
    }

    /// What keeps a run from settling as s ≡ 0 does, to stand behind the time.
    fn delay(&self, setup: &Setup) -> String {
        let energy = match self.start_energy_j {
            Some(energy_j) if energy_j > 0.0 => format!(", V from {} J", number_words(energy_j)),
            Some(_) | None => String::new(),
        };
        let torques = self.peak_torques.iter().map(|peak| peak.estimate_off);
        let off = torques.chain(self.estimate_off).fold(0.0, f64::max);
        let begins = self.start_error.map(|s| {
            let unit = names::gap_unit(setup);
            let unit = if unit.is_empty() { "in its unit".to_owned() } else { format!("{unit}/s") };
            format!("s starts from {} {unit}", number_words(s))
        });
        let far = (off > 0.0).then(|| start_of_estimates(off));
        let pushed = is_pushed(setup).then(|| "pushes act".to_owned());
        let sampled = setup.control.is_some().then(|| "controllers sample".to_owned());
        let reasons: Vec<String> = begins.into_iter().chain(far).chain(pushed).chain(sampled).collect();
        if reasons.is_empty() {
            return String::new();
        }
        format!(" with s ≡ 0 (but {}{energy}, which can delay it)", reasons.join(" and "))
    }

    /// The disagreement at times that rise, by straight lines between those that are kept.
    pub(crate) fn at(&self, t_s: &[f64]) -> Vec<f64> {
        between(&self.t_s, &self.disagreement, t_s)
    }

    /// The largest torque of all.
    pub(crate) fn peak_torque(&self) -> Option<&PredictedTorque> {
        self.peak_torques.iter().reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a })
    }

    /// The middle of the interval that the value agreed upon lies in, if there is one.
    fn value_sentence(&self, setup: &Setup) -> Option<String> {
        let within = self.within.as_ref().filter(|_| self.reached)?;
        // About zero where that is inside.
        let away = |[low, high]: &[f64; 2]| f64::max(high - middle(*low, *high), middle(*low, *high) - low);
        let widest = within.iter().map(away).fold(0.0, f64::max);
        let shown = |[low, high]: &[f64; 2]| with_digits_of(middle(*low, *high), widest);
        let middles: Vec<String> = within.iter().take(MOST_AXES).map(shown).collect();
        let more = if within.len() > MOST_AXES { ", …" } else { "" };
        // (58) ends where ṡ is zero, not s.
        let leaves_some = |law: &ThrustLaw| law.design.estimate_start().is_some();
        let moved = setup.agents.iter().any(|agent| agent.law.downcast().is_some_and(leaves_some));
        let moved = match (moved, self.moved_by_s) {
            (true, _) => "; an s that stays, as adapted masses leave one, moves it",
            (false, true) => " with s ≡ 0; an s that is not zero moves it",
            (false, false) => "",
        };
        let what = names::value_words(setup).to_lowercase();
        let to = if widest > 0.0 { format!(", to ± {}", number_words(widest)) } else { String::new() };
        Some(format!("{what} agreed upon ({}{more}){to}{moved}", middles.join(", ")))
    }

    fn torque_sentence(&self, setup: &Setup) -> Option<String> {
        let peak = self.peak_torque()?;
        let unit = names::unit(setup, peak.agent, forwardstep_sim::Signal::Torque, peak.axis);
        let (agent, axis) = (names::agent_name(setup, peak.agent), names::torque_words(setup, peak.agent, peak.axis));
        let off = self.peak_torques.iter().map(|peak| peak.estimate_off).fold(0.0, f64::max);
        let near = match off {
            0.0 => String::new(),
            off if !is_far(off) => format!("; {}", start_of_estimates(off)),
            off => format!("; {}, where the torque can be another", start_of_estimates(off)),
        };
        let more = match (is_pushed(setup), setup.control.is_some()) {
            (true, true) => "; without what pushes and samples add to it",
            (true, false) => "; without what pushes add to it",
            (false, true) => "; without what samples add to it",
            (false, false) => "",
        };
        // Twice the prediction is too much to choose a motor by.
        let beside =
            if self.start_error.is_some() { "; without a bound, since s does not start from zero" } else { "" };
        let at_most = peak.at_most.map_or_else(
            || beside.to_owned(),
            |at_most| match at_most / peak.value.abs() {
                ratio if ratio <= 1.0 || at_most == 0.0 => String::new(),
                // Nothing is a share of no torque.
                ratio if ratio <= 2.0 || peak.value == 0.0 => {
                    format!("; while V ≤ V(0) at most {} {unit} near this course", three_places(at_most))
                }
                1000.0.. => {
                    "; the bound by V(0) near this course is more than 1000 times as large, and of no practical use"
                        .to_owned()
                }
                ratio => format!(
                    "; the bound by V(0) near this course is {ratio:.1} times as large, and of no practical use"
                ),
            },
        );
        let peak_torque = three_places(peak.value.abs());
        let clipped = self.clipped_words(setup);
        Some(format!(
            "peak {} {peak_torque} {unit}, {agent}, {axis} at {} s{near}{at_most}{more}{clipped}",
            names::input_words(setup).0,
            instant(peak.t_s)
        ))
    }

    /// That the limits of the controllers are below what is predicted, where they are.
    fn clipped_words(&self, setup: &Setup) -> String {
        let limits = setup.control.as_ref().and_then(|control| control.actuators.torque_limit.as_ref());
        let limit = |peak: &&PredictedTorque| limits.and_then(|limits| limits.get(peak.axis)).copied();
        let share = |peak: &PredictedTorque| limit(&peak).map_or(0.0, |limit| peak.value.abs() / limit);
        let worst = self.peak_torques.iter().reduce(|a, b| if share(b) > share(a) { b } else { a });
        let Some((peak, limit)) = worst.filter(|peak| share(peak) > 1.0).and_then(|peak| Some((peak, limit(&peak)?)))
        else {
            return String::new();
        };
        let (agent, axis) = (names::agent_name(setup, peak.agent), names::torque_words(setup, peak.agent, peak.axis));
        let unit = names::unit(setup, peak.agent, forwardstep_sim::Signal::Torque, peak.axis);
        let (needs, limit) = (three_places(peak.value.abs()), three_places(limit));
        format!(
            "; {agent}, {axis} needs {needs} {unit}, above its limit of {limit} {unit}; the run will differ from this"
        )
    }
}

pub(super) fn is_pushed(setup: &Setup) -> bool {
    setup.agents.iter().any(|agent| !agent.pushes.is_empty())
}

/// How far estimates start from the truth, as a part of it.
fn start_of_estimates(off: f64) -> String {
    if is_far(off) {
        return "estimates start far from the truth".to_owned();
    }
    // Five hundredths are five per cent, whatever is rounded.
    format!("estimates start within {:.0} % of the truth", (100.0 * off - 1e-9).ceil())
}

/// A number with three decimal places, where these are digits that say something and not too many.
fn three_places(x: f64) -> String {
    if x == 0.0 || (0.01..1e6).contains(&x) { format!("{x:.3}") } else { number_words(x) }
}

/// `value` with all digits down to the first of its error.
pub(super) fn with_digits_of(value: f64, error: f64) -> String {
    let places = -error.log10().floor();
    let written = format!("{value:.*}", places.clamp(0.0, 15.0) as usize);
    // What is rounded to nothing, or has an error of more than ten, has the digits of any other number.
    let says = (0.0..=15.0).contains(&places) && written.parse::<f64>().is_ok_and(|written| written != 0.0);
    if says { written.replace('-', "−") } else { number_words(value) }
}

/// The middle of an interval; what cannot be told from zero is zero.
fn middle(low: f64, high: f64) -> f64 {
    if low <= 0.0 && high >= 0.0 { 0.0 } else { low + 0.5 * (high - low) }
}

/// Axes whose value is said.
const MOST_AXES: usize = 8;
/// An estimate within this of the truth leaves the peak torque much as it is predicted.
const NEAR: f64 = 0.2;

/// Whether estimates start farther off than that, by more than rounding: four fifths are a fifth off.
pub(super) fn is_far(off: f64) -> bool {
    off > NEAR + 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four fifths of the truth were "farther off than 20 %".
    #[test]
    fn regress_a_fifth_is_not_farther_off_than_a_fifth() {
        assert_eq!([1.0 - 0.8, 0.8 - 1.0 + 0.4, 0.21].map(is_far), [false, false, true]);
    }

    #[test]
    fn torques_have_three_places_where_these_say_something() {
        let said = [0.0, 12.34567, 0.01, 359_608_699_164.0, 0.0042].map(three_places);
        assert_eq!(said, ["0.000", "12.346", "0.010", "3.596 × 10¹¹", "0.0042"]);
    }

    #[test]
    fn a_course_is_thinned_and_read_between_its_points() {
        let rows = 1000;
        let course = Course {
            t_s: (0..rows).map(f64::from).collect(),
            disagreement: (0..rows).map(|row| f64::from(row) * 2.0).collect(),
            value: vec![0.0],
            within: Ok(vec![[0.0, 0.0]]),
            settled: forwardstep_check::prediction::Settled::NotYet,
            peak_torques: Vec::new(),
            start: forwardstep_check::prediction::StartError::default(),
            moved_by_s: false,
        };
        let found = CourseFound::of(&course);
        assert!(found.t_s.len() <= MOST_POINTS + 1);
        assert_eq!((found.t_s[0], found.t_s[1], found.t_s.last()), (0.0, 3.0, Some(&999.0)));
        assert_eq!(found.at(&[0.0, 1.0, 3.0, 4.5, 999.0, 1000.0]), [0.0, 2.0, 6.0, 9.0, 1998.0, 1998.0]);
        assert!((found.settled_s, found.reached) == (None, false));
        let none = CourseFound { t_s: Vec::new(), disagreement: Vec::new(), ..found };
        assert!(none.at(&[1.0])[0].is_nan());
    }

    #[test]
    fn a_value_has_the_digits_that_its_error_leaves() {
        let cases = [
            (-0.256_862_184_7, 3.1e-11, "−0.25686218470"),
            (-0.468_357_09, 1.144e-6, "−0.468357"),
            (1234.5678, 0.02, "1234.57"),
            (12.34, 40.0, "12.34"),
            (1e-9, 1e-4, "1 × 10⁻⁹"),
            (0.0, 1e-6, "0"),
            (0.5, 0.0, "0.5"),
        ];
        for (value, error, wanted) in cases {
            assert_eq!(with_digits_of(value, error), wanted);
        }
    }
}
