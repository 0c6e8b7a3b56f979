//! What is predicted, in sentences for the terminal.

use forwardstep_sim::{Setup, ThrustLaw};

use super::{CourseFound, PredictedCourse, PredictedRate, PredictedTorque, Predictions};
use crate::instant;
use crate::output::names;
use crate::output::text::number as number_words;

/// Axes whose value is said.
const MOST_AXES: usize = 8;
/// An estimate within this of the truth leaves the peak torque much as it is predicted.
const NEAR: f64 = 0.2;

impl Predictions {
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

pub(in crate::output) fn is_pushed(setup: &Setup) -> bool {
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
pub(in crate::output) fn with_digits_of(value: f64, error: f64) -> String {
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

/// Whether estimates start farther off than that, by more than rounding: four fifths are a fifth off.
pub(in crate::output) fn is_far(off: f64) -> bool {
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
