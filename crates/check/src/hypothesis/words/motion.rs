//! Targets, offsets and leaders.

use super::numbers::rounded;
use crate::hypothesis::{Bounded, MotionEvidence};

pub(super) fn words(evidence: &MotionEvidence) -> String {
    match evidence {
        MotionEvidence::Derivatives(bounded) => match bounded {
            Bounded::ForEver => "interval arithmetic bounds them for all time",
            Bounded::OnRun => "interval arithmetic bounds them on the run, not for all time",
            Bounded::NotShown => "they could not be shown to be bounded, not even on the run",
        }
        .into(),
        MotionEvidence::OfAgent => "it is an agent, which moves as its own law and its target make it".into(),
        MotionEvidence::EntryAway { least } => {
            format!("one of its entries is never below {} in magnitude", rounded(*least))
        }
        MotionEvidence::NormAbove { least } => {
            format!("its norm stays above {} until the end of the run", rounded(*least))
        }
        MotionEvidence::NormSeen { t_s, norm } => {
            format!("at {} s its norm is {}, and no bound above zero could be shown", rounded(*t_s), rounded(*norm))
        }
        MotionEvidence::NormVanishes { t_s, norm } => format!("at {} s its norm is {norm}", rounded(*t_s)),
    }
}
