//! What changed V along a run under digital control, in `summary.json` and in the report.

use std::collections::BTreeMap;

use forwardstep_check::{Injection, InjectionBalance, InjectionCourse, NAMED_SHARE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::decimate::between;
use super::number;

/// V of one agent from its first sample to the end, and what each cause put in, in J or the unit of its V: the terms add up to the change of V, but
/// for the residual. Not from the paper, derived for this software.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Injected {
    /// Index of the agent.
    pub agent: usize,
    /// V after the first sample.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub start_j: f64,
    /// V at the end.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub end_j: f64,
    /// What the proof leaves: −∫ sᵀ(K + D)s under (6)–(7).
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub dissipated_j: f64,
    /// By commands and references that are held between samples, and by commands that come late.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub held_j: f64,
    /// By velocities that are filtered differences of positions.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub reconstructed_j: f64,
    /// By noise and rounding of measurements.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub measured_j: f64,
    /// By limits and rounding of torques.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub limited_j: f64,
    /// By friction that is dry where the law takes it for smooth; of agents by themselves that counts as pushed.
    #[serde(default, deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub rubbed_j: f64,
    /// By external torques.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub pushed_j: f64,
    /// By estimates that are stepped at samples; of agents by themselves that counts as held.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub adaptation_j: f64,
    /// The change of V less all of these.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub residual_j: f64,
    /// The first cause that the proof does not allow and that had put in more than 1 % of the largest V until then; null for none.
    pub first: Option<FirstInjection>,
}

/// V of all agents together over time, and what changed it, in J or the unit of V.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InjectedCourse {
    /// Times, s, rising.
    pub t_s: Vec<f64>,
    /// V then; a number that is not finite is `null`.
    pub v: Vec<Option<f64>>,
    /// What each cause has put in by then, by its name; causes that never put anything in are left out.
    pub by: BTreeMap<String, Vec<Option<f64>>>,
}

impl InjectedCourse {
    /// Of a run; `None` where none was taken.
    pub fn of(course: &InjectionCourse) -> Option<InjectedCourse> {
        let finite = |all: &[f64]| all.iter().map(|value| value.is_finite().then_some(*value)).collect();
        let by = Injection::ALL.into_iter().zip(&course.terms_j).filter(|(_, all)| all.iter().any(|term| *term != 0.0));
        (course.t_s.len() > 1).then(|| InjectedCourse {
            t_s: course.t_s.clone(),
            v: finite(&course.v_j),
            by: by.map(|(cause, all)| (cause.name().to_owned(), finite(all))).collect(),
        })
    }

    /// A series of it at times that rise, by straight lines between those that are kept; not a number where it is not known.
    pub(crate) fn at(&self, series: &[Option<f64>], t_s: &[f64]) -> Vec<f64> {
        let known: Vec<f64> = series.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
        between(&self.t_s, &known, t_s)
    }
}

/// What put energy in first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FirstInjection {
    /// `held`, `reconstructed`, `measured`, `limited`, `rubbed`, `pushed` or `adaptation`.
    pub cause: String,
    /// When, s.
    pub t_s: f64,
}

impl From<&InjectionBalance> for Injected {
    fn from(balance: &InjectionBalance) -> Self {
        Injected {
            agent: balance.agent,
            start_j: balance.start_j,
            end_j: balance.end_j,
            dissipated_j: balance.term_j(Injection::Dissipated),
            held_j: balance.term_j(Injection::Held),
            reconstructed_j: balance.term_j(Injection::Reconstructed),
            measured_j: balance.term_j(Injection::Measured),
            limited_j: balance.term_j(Injection::Limited),
            rubbed_j: balance.term_j(Injection::Rubbed),
            pushed_j: balance.term_j(Injection::Pushed),
            adaptation_j: balance.term_j(Injection::Adaptation),
            residual_j: balance.residual_j(),
            first: balance.first.map(|(injection, t_s)| FirstInjection { cause: injection.name().to_owned(), t_s }),
        }
    }
}

impl Injected {
    /// What one cause put in, J.
    pub fn term_j(&self, injection: Injection) -> f64 {
        match injection {
            Injection::Dissipated => self.dissipated_j,
            Injection::Held => self.held_j,
            Injection::Reconstructed => self.reconstructed_j,
            Injection::Measured => self.measured_j,
            Injection::Limited => self.limited_j,
            Injection::Rubbed => self.rubbed_j,
            Injection::Pushed => self.pushed_j,
            Injection::Adaptation => self.adaptation_j,
        }
    }

    /// The agent that was fed first, with the cause and the time: of those whose cause put in more than [`NAMED_SHARE`] of what V was of all
    /// agents together, if there are such. One whose V begins at zero is fed by the first rounding.
    pub fn earliest(all: &[Injected]) -> Option<(&Injected, &FirstInjection)> {
        let start_j: f64 = all.iter().map(|own| own.start_j).sum();
        let counts = |own: &Injected, first: &FirstInjection| {
            let cause = Injection::ALL.into_iter().find(|cause| cause.name() == first.cause);
            cause.is_some_and(|cause| own.term_j(cause).abs() > NAMED_SHARE * start_j)
        };
        let named = || all.iter().filter_map(|own| Some((own, own.first.as_ref()?)));
        let sooner = |a: &(&Injected, &FirstInjection), b: &(&Injected, &FirstInjection)| a.1.t_s.total_cmp(&b.1.t_s);
        named().filter(|(own, first)| counts(own, first)).min_by(sooner).or_else(|| named().min_by(sooner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_an_agent_whose_v_begins_at_zero_is_not_the_first_that_is_fed() {
        let fed = |agent, start_j, held_j, limited_j, cause: Injection, t_s| Injected {
            agent,
            start_j,
            end_j: start_j + held_j + limited_j,
            dissipated_j: 0.0,
            held_j,
            reconstructed_j: 0.0,
            measured_j: 0.0,
            limited_j,
            rubbed_j: 0.0,
            pushed_j: 0.0,
            adaptation_j: 0.0,
            residual_j: 0.0,
            first: Some(FirstInjection { cause: cause.name().to_owned(), t_s }),
        };
        let (still, moved) =
            (fed(0, 0.0, 2e-5, 0.0, Injection::Held, 0.01), fed(1, 90.0, 0.5, 400.0, Injection::Limited, 0.36));
        let first = |all: &[Injected]| Injected::earliest(all).map(|(own, first)| (own.agent, first.t_s));
        assert_eq!(first(&[still.clone(), moved]), Some((1, 0.36)));
        // Where nothing is large, the first is.
        let small = fed(2, 90.0, 1e-3, 0.0, Injection::Held, 0.02);
        assert_eq!(first(&[small, still]), Some((0, 0.01)));
    }
}
