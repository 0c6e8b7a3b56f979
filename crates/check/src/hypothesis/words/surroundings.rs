//! What surrounds a law: gains, pushes, limits, sampling.

use super::names;
use super::numbers::{rounded_up, seconds, short};
use crate::hypothesis::{Inexact, Limited, LoopEvidence, Named};
use crate::sampled::{SampledAdaptation, SampledDamping};

pub(super) fn words(evidence: &LoopEvidence) -> String {
    match evidence {
        LoopEvidence::Gains { known, agents } => {
            let parameters = match *known {
                0 => "parameters are adapted".to_owned(),
                known if known == *agents => "parameters are known".to_owned(),
                known => format!("parameters are known to {known} of {agents} agents and adapted by the others"),
            };
            format!("checked exactly when the gains were read; {parameters}")
        }
        LoopEvidence::Pushes { pushed, torques_for_ever, others_for_ever, hands_for_ever, last_end_s } => {
            pushes(pushed, [torques_for_ever, others_for_ever, hands_for_ever], *last_end_s)
        }
        LoopEvidence::Applied { limited, enforced } => {
            let mut reasons: Vec<String> = limited.iter().map(|limited| limit(*limited).to_owned()).collect();
            if !enforced.is_empty() {
                reasons.push(format!("limits are enforced on {}", names(enforced)));
            }
            if reasons.is_empty() { "limits are reported, not enforced".into() } else { reasons.join(", ") }
        }
        LoopEvidence::Sampling { sample_hz, computation_delay_s, filtered, damping, adaptation } => {
            let late = match computation_delay_s {
                late_s if *late_s > 0.0 => format!(", torques come {late_s} s late"),
                _ => String::new(),
            };
            let held = damping.as_ref().map_or_else(String::new, |(agent, damping)| held(agent, damping, *filtered));
            // What the damping alone does is said already.
            let steady = damping.as_ref().is_none_or(|(_, damping)| damping.value < damping.unstable_above);
            let learning = adaptation.as_ref().filter(|(_, found)| steady && found.value > 2.0);
            let learning = learning.map_or_else(String::new, |(agent, found)| learning_too_fast(agent, found));
            format!(
                "they sample at {sample_hz} Hz{late}; what is heard is up to a period older; as h → 0 the loop tends to the \
                 one the theorem speaks of{held}{learning}"
            )
        }
        LoopEvidence::Measurements(inexact) => {
            let words: Vec<&str> = inexact.iter().map(|inexact| noise(*inexact)).collect();
            words.join(", ")
        }
    }
}

fn pushes(pushed: &[Named], [torques, others, hands]: [&[Named]; 3], last_end_s: f64) -> String {
    let mut because = Vec::new();
    if !torques.is_empty() {
        because.push(format!(
            "{} pushed for ever: s does not vanish but, where parameters are known and the push settles, comes to rest at \
             K s = tau_ext",
            is_or_are(torques)
        ));
    }
    if !others.is_empty() {
        because.push(format!("{} pushed for ever: the tracking error does not vanish", is_or_are(others)));
    }
    if !hands.is_empty() {
        because.push(format!(
            "a hand never lets go of {}: while its target stands still it takes energy out of the motion, but the proof counts \
             the power of torques with s and not with dq",
            names(hands)
        ));
    }
    if because.is_empty() {
        because.push(format!("{} pushed, and the last push ends at t = {} s", is_or_are(pushed), seconds(last_end_s)));
    }
    because.join("; ")
}

/// "a is", "a, b are".
fn is_or_are(agents: &[Named]) -> String {
    format!("{} {}", names(agents), if agents.len() == 1 { "is" } else { "are" })
}

fn limit(limited: Limited) -> &'static str {
    match limited {
        Limited::Torque => "torques are limited",
        Limited::TorqueRate => "the rate of torques is limited",
        Limited::TorqueQuantum => "torques are quantised",
    }
}

fn noise(inexact: Inexact) -> &'static str {
    match inexact {
        Inexact::Noise => "there is noise",
        Inexact::Quantum => "measurements are quantised",
        Inexact::Filter => "velocities come from filtered differences",
    }
}

fn held(agent: &Named, damping: &SampledDamping, filtered: bool) -> String {
    let (value, overshoots) = (short(damping.value), short(damping.overshoots_above));
    let meaning = if damping.value > damping.overshoots_above {
        let unstable = short(damping.unstable_above);
        format!(
            "above {overshoots} the held damping overshoots, above {unstable} it is unstable: sample faster or let K be smaller"
        )
    } else if filtered {
        format!("up to {overshoots} the held damping would not overshoot, if the filter of the velocities did not lag")
    } else {
        format!("up to {overshoots} the held damping does not overshoot")
    };
    let limit = damping.unstable_above;
    let anywhere = damping.anywhere.filter(|anywhere| *anywhere < limit).map_or_else(String::new, |anywhere| {
        format!("; at any q it is at most {}, and {} is where it is unstable", rounded_up(anywhere), short(limit))
    });
    format!("; h · λ_max(M⁻¹K) is {value} at the start ({}): {meaning}{anywhere}", agent.name)
}

fn learning_too_fast(agent: &Named, found: &SampledAdaptation) -> String {
    format!(
        "; h · λ_max(M⁻¹(K + ½ h Y Γ Yᵀ)) is {} at the start ({}): above 2 damping and adaptation together are unstable: \
         sample faster or let Γ be smaller",
        short(found.value),
        agent.name
    )
}
