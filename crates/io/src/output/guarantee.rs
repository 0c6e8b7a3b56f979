//! The guaranteed rate of agreement, for `summary.json`, `check --json`, the terminal and the report. Numbers are rounded so that what is said
//! stays true.

use forwardstep_check::prediction::{ClassBound, Fall, GuaranteedRate, NoGuaranteedRate, Repeat};
use forwardstep_core::signal::superscript;
use forwardstep_sim::Setup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{names, number};

/// How much of the spread of all cascaded variables, and of all messages on their way, is left when, for certain and whatever the
/// start, for s ≡ 0; or why that is not shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Guarantee {
    /// It.
    Found(GuaranteeFound),
    /// Why there is none.
    NoneSince(String),
}

/// How much of the spread is left when, for certain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GuaranteeFound {
    /// What is left at most, later and later.
    pub falls: Vec<GuaranteedFall>,
    /// From when on no more than 1 % is left, s; null where that is not shown.
    pub settled_s: Option<f64>,
    /// What is left again and again, where graphs and delays repeat themselves.
    pub repeat: Option<GuaranteedRepeat>,
    /// Whether it is about the one course of graphs and delays that was drawn, logged or declared for this run.
    pub drawn: bool,
    /// The same for any delays up to the longest one; null where no closed form is known.
    pub any_delay: Option<GuaranteedClass>,
}

/// No more than a part is left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GuaranteedFall {
    /// From this time on, s.
    #[serde(deserialize_with = "number::or_nan")]
    pub t_s: f64,
    /// As a part of what there was at the start.
    #[serde(deserialize_with = "number::or_nan")]
    pub left: f64,
}

/// No more than a part is left, again and again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GuaranteedRepeat {
    /// After so long, s.
    #[serde(deserialize_with = "number::or_nan")]
    pub over_s: f64,
    /// How many windows of the graphs that is; null where windows may be as short as one likes.
    pub windows: Option<u64>,
    /// As a part of what there was so long ago.
    #[serde(deserialize_with = "number::or_nan")]
    pub left: f64,
}

/// What any delays up to the longest one leave, by a closed form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GuaranteedClass {
    /// The delays do not exceed this, s.
    #[serde(deserialize_with = "number::or_nan")]
    pub delay_s: f64,
    /// After so long, s, again and again,
    #[serde(deserialize_with = "number::or_nan")]
    pub over_s: f64,
    /// log₁₀ of the part by which the spread falls.
    #[serde(deserialize_with = "number::or_nan")]
    pub log10_part: f64,
    /// log₁₀ of the time, s, after which no more than 1 % is left.
    #[serde(deserialize_with = "number::or_nan")]
    pub log10_settled_s: f64,
    /// Whether that is at most 100 times the horizon.
    pub practical: bool,
}

impl Guarantee {
    pub(super) fn of(setup: &Setup, found: &Result<GuaranteedRate, NoGuaranteedRate>) -> Guarantee {
        match found {
            Ok(rate) => Guarantee::Found(GuaranteeFound::of(rate, setup.time.end_s)),
            Err(error) => Guarantee::NoneSince(names::reason(setup, error)),
        }
    }

    /// Sentences for people, to stand behind "guaranteed:", without a full stop.
    pub(crate) fn sentences(&self, end_s: f64) -> Vec<String> {
        match self {
            Guarantee::NoneSince(reason) => vec![format!("no rate, since {reason}")],
            Guarantee::Found(found) => found.sentences(end_s),
        }
    }
}

/// Parts that are said.
const SAID: [f64; 2] = [0.5, 0.1];

impl GuaranteeFound {
    fn of(rate: &GuaranteedRate, end_s: f64) -> GuaranteeFound {
        let repeat = |Repeat { over_s, left }| {
            let windows = rate.window_s.map(|window_s| (over_s / window_s) as u64);
            GuaranteedRepeat { over_s, windows, left }
        };
        let class = |class: ClassBound| GuaranteedClass {
            delay_s: class.delay_s,
            over_s: class.over_s,
            log10_part: class.log10_part,
            log10_settled_s: class.log10_settled_s,
            practical: class.is_practical(end_s),
        };
        GuaranteeFound {
            falls: rate.falls.iter().map(|Fall { t_s, left }| GuaranteedFall { t_s: *t_s, left: *left }).collect(),
            settled_s: rate.settled_s,
            repeat: rate.repeat.map(repeat),
            drawn: rate.drawn,
            any_delay: rate.class.map(class),
        }
    }

    fn sentences(&self, end_s: f64) -> Vec<String> {
        let percent = |left: f64| format!("{} %", above(100.0 * left));
        let first = |part: f64| self.falls.iter().find(|fall| fall.left <= part);
        let mut parts: Vec<[String; 2]> = SAID
            .iter()
            .filter_map(|part| Some([percent(*part), format!("after {} s", above(first(*part)?.t_s))]))
            .collect();
        match self.settled_s {
            Some(t_s) => parts.push([percent(0.01), format!("after {} s", above(t_s))]),
            None => {
                let last = self.falls.iter().rev().find(|fall| fall.t_s <= end_s);
                parts.extend(last.map(|last| [percent(last.left), format!("by {} s", above(last.t_s))]));
            }
        }
        let say = |(index, [part, when]): (usize, &[String; 2])| match index {
            0 => format!("at most {part} of the spread of all cascaded variables is left {when}"),
            _ => format!("{part} {when}"),
        };
        let mut sentence = parts.iter().enumerate().map(say).collect::<Vec<_>>().join(", ");
        sentence += if self.drawn {
            ", whatever the start, over the graphs and delays of this run"
        } else {
            ", whatever the start"
        };
        if let Some(GuaranteedRepeat { over_s, windows, left }) = self.repeat {
            let windows = windows.filter(|windows| *windows > 1).map(|windows| format!(" ({windows} windows)"));
            let windows = windows.unwrap_or_default();
            sentence +=
                &format!("; and every further {} s{windows} the bound shrinks to {}", above(over_s), percent(left));
        }
        let mut sentences = vec![sentence];
        sentences.extend(self.any_delay.as_ref().map(GuaranteedClass::sentence));
        sentences
    }
}

impl GuaranteedClass {
    fn sentence(&self) -> String {
        let size = self.log10_settled_s;
        let time =
            if size < 6.0 { above(10.0_f64.powf(size)) } else { format!("10{}", superscript(size.ceil() as i32)) };
        let practical = if self.practical { "" } else { ", which is of no practical use" };
        match self.delay_s {
            0.0 => format!("in closed form 1 % after {time} s{practical}"),
            delay_s => format!("for any delays up to {} s 1 % after {time} s{practical}", above(delay_s)),
        }
    }
}

/// Three digits, none of them too small; with a power of ten where decimals would be long.
fn above(value: f64) -> String {
    if value > 0.0 && value < 1e-3 {
        let power = value.log10().floor().max(-307.0);
        // A decimal that rounding has put just above itself stays what it is.
        let digits = (100.0 * (value / 10.0_f64.powf(power)) * (1.0 - 16.0 * f64::EPSILON)).ceil() / 100.0;
        return format!("{digits} × 10{}", superscript(power as i32));
    }
    let places = (2 - value.log10().floor().clamp(-12.0, 2.0) as i32).max(0) as usize;
    let scale = 10.0_f64.powi(places as i32);
    // A decimal that rounding has put just above itself stays what it is.
    let rounded = (value * scale * (1.0 - 4.0 * f64::EPSILON)).ceil() / scale;
    let text = format!("{rounded:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_guaranteed_is_rounded_upwards() {
        let said = [0.0012341, 0.5, 12.301, 12.3, 100.2, 1234.5, 0.0].map(above);
        assert_eq!(said, ["0.00124", "0.5", "12.4", "12.3", "101", "1235", "0"]);
        assert_eq!([1e-300, 2.345e-9].map(above), ["1 × 10⁻³⁰⁰", "2.35 × 10⁻⁹"]);
    }

    #[test]
    fn what_is_guaranteed_is_said_in_one_sentence_for_the_network_and_one_for_any_delays() {
        let fall = |t_s, left| GuaranteedFall { t_s, left };
        let any_delay =
            GuaranteedClass { delay_s: 0.4, over_s: 2.0, log10_part: -9.0, log10_settled_s: 28.2, practical: false };
        let mut found = GuaranteeFound {
            falls: vec![fall(1.0, 0.8), fall(2.0, 0.4), fall(5.0, 0.09), fall(7.0, 0.004)],
            settled_s: Some(6.5),
            repeat: Some(GuaranteedRepeat { over_s: 4.0, windows: Some(3), left: 0.2 }),
            drawn: false,
            any_delay: Some(any_delay),
        };
        let whole = "at most 50 % of the spread of all cascaded variables is left after 2 s, 10 % after 5 s, 1 % after 6.5 s, whatever the \
                     start; and every further 4 s (3 windows) the bound shrinks to 20 %";
        let any = "for any delays up to 0.4 s 1 % after 10²⁹ s, which is of no practical use";
        assert_eq!(found.sentences(10.0), [whole, any]);
        // What is not settled ends with what is left on the horizon.
        (found.settled_s, found.repeat, found.any_delay, found.drawn) = (None, None, None, true);
        found.falls.truncate(2);
        let on_run = "at most 50 % of the spread of all cascaded variables is left after 2 s, 40 % by 2 s, whatever the start, over the \
                      graphs and delays of this run";
        assert_eq!(found.sentences(10.0), [on_run]);
        found.falls.truncate(1);
        assert!(
            found.sentences(10.0)[0]
                .starts_with("at most 80 % of the spread of all cascaded variables is left by 1 s, ")
        );
        let none = Guarantee::NoneSince("there is no link".into());
        assert_eq!(none.sentences(10.0), ["no rate, since there is no link"]);
    }
}
