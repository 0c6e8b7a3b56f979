//! What surrounds a law: gains, pushes, limits, sampling.

use super::names;
use super::numbers::seconds;
use crate::hypothesis::{Inexact, Limited, LoopEvidence, Named};

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
        LoopEvidence::Pushes {
            pushed,
            fading,
            torques_for_ever,
            others_for_ever,
            springs_for_ever,
            unbounded,
            last_end_s,
        } => pushes([pushed, fading], [torques_for_ever, others_for_ever, springs_for_ever, unbounded], *last_end_s),
        LoopEvidence::Applied { limited, enforced } => {
            let mut reasons: Vec<String> = limited.iter().map(|limited| limit(*limited).to_owned()).collect();
            if !enforced.is_empty() {
                reasons.push(format!("limits are enforced on {}", names(enforced)));
            }
            if reasons.is_empty() { "limits are reported, not enforced".into() } else { reasons.join(", ") }
        }
        LoopEvidence::Sampling { sample_hz, computation_delay_s } => {
            let late = match computation_delay_s {
                late_s if *late_s > 0.0 => format!(", torques come {late_s} s late"),
                _ => String::new(),
            };
            format!(
                "they sample at {sample_hz} Hz{late}; what is heard is up to a period older; as h → 0 the loop tends to the \
                 one the theorem speaks of"
            )
        }
        LoopEvidence::Measurements(inexact) => {
            let words: Vec<&str> = inexact.iter().map(|inexact| noise(*inexact)).collect();
            words.join(", ")
        }
        LoopEvidence::Friction { dry, .. } if dry.is_empty() => {
            "it is F tanh(q̇/ε), and the law has F̂ tanh(z/ε): since tanh rises, what is left of it damps".into()
        }
        LoopEvidence::Friction { dry, most_w } => {
            format!(
                "it is set-valued for {}: V may grow at up to {most_w:.4} W, which keeps s small and not zero",
                names(dry)
            )
        }
    }
}

fn pushes(
    [pushed, fading]: [&[Named]; 2],
    [torques, others, springs, unbounded]: [&[Named]; 4],
    last_end_s: f64,
) -> String {
    let mut because = Vec::new();
    if !torques.is_empty() {
        because.push(format!(
            "{} pushed for ever: nothing says that s vanishes; where parameters are known and the push settles, s comes to \
             rest at K s = tau_ext",
            is_or_are(torques)
        ));
    }
    if !others.is_empty() {
        because.push(format!("{} pushed for ever: nothing says that the tracking error vanishes", is_or_are(others)));
    }
    if !springs.is_empty() {
        because.push(format!(
            "a virtual spring never lets go of {}: while its target stands still it takes energy out of the motion, but the proof counts \
             the power of torques with s and not with dq",
            names(springs)
        ));
    }
    if !unbounded.is_empty() {
        because.push(format!(
            "{} pushed by what could not be shown to have a bounded value until it ends, which is after the run",
            is_or_are(unbounded)
        ));
    }
    if because.is_empty() && !fading.is_empty() {
        because.push(format!(
            "{} pushed by what fades at least like 1/t, so that its square has a finite integral",
            is_or_are(fading)
        ));
        if last_end_s > 0.0 {
            because.push(format!("what does not fade has ended by t = {} s", seconds(last_end_s)));
        }
    } else if because.is_empty() {
        because.push(format!(
            "{} pushed, and the last push has ended by t = {} s",
            is_or_are(pushed),
            seconds(last_end_s)
        ));
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
        Limited::Thrust => "rotors give no more than their thrust, and no less",
    }
}

fn noise(inexact: Inexact) -> &'static str {
    match inexact {
        Inexact::Noise => "there is noise",
        Inexact::Quantum => "measurements are quantised",
        Inexact::Filter => "velocities come from filtered differences",
    }
}
