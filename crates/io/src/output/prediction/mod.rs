//! What is predicted before any robot is simulated, for `summary.json`, `check --json`, the terminal and the report.
//!
//! All of it is for s ≡ 0: robots that follow their references exactly. Beside it stands what was observed.

use forwardstep_check::NoIdeal;
use forwardstep_check::prediction::{
    Course, GuaranteedRate, NoCourse, NoGuaranteedRate, NoPeriodRate, NoRate, PeriodRate, Rate, Unfinished,
};
use forwardstep_sim::Setup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::decimate::between;
use super::guarantee::Guarantee;
use super::{names, number};

mod words;

pub(super) use words::{is_far, is_pushed, with_digits_of};

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

    /// The disagreement at times that rise, by straight lines between those that are kept.
    pub(crate) fn at(&self, t_s: &[f64]) -> Vec<f64> {
        between(&self.t_s, &self.disagreement, t_s)
    }

    /// Whether agents whose positions have these means, and are so far apart, are beside the predicted value by more than that.
    pub fn is_beside(&self, means: &[f64], apart: f64) -> bool {
        let Some(within) = &self.within else { return false };
        within.iter().zip(means).any(|([low, high], mean)| *mean < low - apart || *mean > high + apart)
    }

    /// The largest torque of all.
    pub(crate) fn peak_torque(&self) -> Option<&PredictedTorque> {
        self.peak_torques.iter().reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
