//! Targets, offsets and leaders.

use forwardstep_sim::formula::Witness;

use super::numbers::{rounded, rounded_down, rounded_up};
use super::ordinal;
use crate::hypothesis::{Bounded, MotionEvidence};

pub(super) fn words(evidence: &MotionEvidence) -> String {
    match evidence {
        MotionEvidence::Derivatives(bounded) => match bounded {
            Bounded::ForEver => "they are bounded for all time".into(),
            Bounded::NotShown => "they could not be shown to be bounded for all time".into(),
            Bounded::Jumps => {
                "where a curve through points starts and ends its third derivative jumps, so that the fourth has no bound"
                    .into()
            }
            Bounded::Unbounded { derivative, witness } => unbounded(*derivative, *witness),
        },
        MotionEvidence::OfAgent => "it is an agent, which moves as its own law and its target make it".into(),
        MotionEvidence::EntryAway { least } => {
            format!("one of its entries is never below {} in magnitude", rounded_down(*least))
        }
        MotionEvidence::NormAbove { least } => {
            format!("its norm is never below {}", rounded_down(*least))
        }
        MotionEvidence::NormFades { witness } => {
            let at = witness.map_or(String::new(), |Witness { t_s, value }| {
                format!("; at t = {} s it is {}", rounded(t_s), rounded_up(value))
            });
            format!("its norm comes as close to zero as one likes{at}")
        }
        MotionEvidence::NormSeen { t_s, norm } => {
            format!("at {} s its norm is {}, and no bound above zero could be shown", rounded(*t_s), rounded(*norm))
        }
        MotionEvidence::NormVanishes { t_s } => format!("its entries are zero together at {} s", rounded(*t_s)),
    }
}

fn unbounded(derivative: usize, witness: Option<Witness>) -> String {
    let what = match derivative {
        0 => "the position",
        1 => "the velocity",
        2 => "the acceleration",
        3 => "the jerk",
        _ => &format!("the {} derivative", ordinal(derivative)),
    };
    let at = witness.map_or(String::new(), |Witness { t_s, value }| {
        let value = if value < 0.0 { rounded_up(value) } else { rounded_down(value) };
        format!("; at t = {} s it is {value}", rounded(t_s))
    });
    format!("{what} exceeds every bound{at}")
}
