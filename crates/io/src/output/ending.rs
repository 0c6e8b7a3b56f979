//! How a run ended, in words.

use forwardstep_sim::recording::{Breakdown, BreakdownCause, Ending, GainRates, Signal, Stiffness};
use forwardstep_sim::setup::{AgentSetup, Method, Setup};
use forwardstep_sim::{ChainLaw, ChainStep};

use super::{names, text};
use crate::wording::{about, number, rounded};

/// A gain is to blame for a rate that is at most this many times higher or lower than its own.
const BLAMED_WITHIN: f64 = 5.0;

/// How a run ended, as one sentence that names the agent and the signal that broke it.
pub fn ending_sentence(setup: &Setup, ending: &Ending) -> String {
    match ending {
        Ending::Completed => format!("Reached the horizon of {} s.", setup.time.end_s),
        Ending::Interrupted { t_s } => {
            let t_s = number(rounded(*t_s));
            format!("Interrupted at t = {t_s} s of {} s; everything until then is kept.", setup.time.end_s)
        }
        Ending::CutOff { t_s } => {
            let t_s = number(rounded(*t_s));
            format!("Was cut off at t = {t_s} s of {} s, where its rows end.", setup.time.end_s)
        }
        Ending::BrokeDown(breakdown) => {
            let column = names::column_name(setup, breakdown.agent, breakdown.signal, breakdown.axis);
            let cause = cause(setup, breakdown);
            let t_s = number(rounded(breakdown.t_s));
            format!("Broke down at t = {t_s} s of {} s: {column} {cause}.", setup.time.end_s)
        }
    }
}

/// How fast the closed loop is and because of what, of a run that broke down since it asks for short steps and is stiff.
pub fn stiff_words(setup: &Setup, ending: &Ending) -> Option<String> {
    let Ending::BrokeDown(breakdown) = ending else { return None };
    let BreakdownCause::StepUnderFloor { step_s, stiffness: Some(stiffness) } = &breakdown.cause else { return None };
    let is_stiff = stiffness.explains(*step_s) || stiffness.forbids(setup.solver.min_step_s);
    is_stiff.then(|| because(setup, breakdown, true, stiffness, ""))
}

/// That roots of the reference dynamics ask for the short steps: what is that fast is there from the start, before the closed loop is.
fn fast_roots(setup: &Setup, agent: usize, loop_per_s: f64) -> Option<String> {
    /// What vanishes within a millionth of the run is not what the run is about.
    const SHARE: f64 = 1e-6;
    let roots = &setup.agents.get(agent)?.roots_per_s;
    let pairs = roots.pairs.iter().map(|pair| pair.real.hypot(pair.imaginary));
    let fastest_per_s = roots.real.iter().copied().chain(pairs).fold(0.0, f64::max);
    let is_fast = fastest_per_s > loop_per_s && SHARE * setup.time.end_s * fastest_per_s > 1.0;
    is_fast.then(|| format!("a root of the reference dynamics is at {} 1/s; lower `roots_per_s`", about(fastest_per_s)))
}

/// What happened to the signal that broke a run.
fn cause(setup: &Setup, breakdown: &Breakdown) -> String {
    match &breakdown.cause {
        BreakdownCause::NotFinite => match steps_of_backstepping(setup, breakdown) {
            Some(order) => format!(
                "is no finite number where it starts: each of the {order} steps of backstepping multiplies slopes of the regressors that the \
                 step before has multiplied already, so that what they grow to is beyond every number; take smaller regressors, in other \
                 units or for smaller states, or a lower order"
            ),
            None => "is no longer a finite number".to_owned(),
        },
        BreakdownCause::StepUnderFloor { step_s, stiffness } => {
            let floor_s = setup.solver.min_step_s;
            let why = stiffness.as_ref().map_or_else(String::new, |stiffness| {
                // While a transient is seen steps are shorter than the rate asks for.
                let is_stiff = stiffness.explains(*step_s) || stiffness.forbids(floor_s);
                let advice = fast_roots(setup, breakdown.agent, stiffness.rate_per_s)
                    .unwrap_or_else(|| "loosen the tolerances, or look at where it starts".to_owned());
                format!("; {}", because(setup, breakdown, is_stiff, stiffness, &advice))
            });
            format!("asks for a step of {step_s:e} s, under the floor of {floor_s:e} s{why}")
        }
        BreakdownCause::MemoryFull { step_s, need_bytes, stiffness } => {
            let blamed = match setup.solver.method {
                Method::Adaptive { .. } => "has the largest error",
                Method::Fixed { .. } => "moves fastest",
            };
            let advice = format!("{}, or raise the budget", longer(setup));
            let why = stiffness.as_ref().map_or_else(
                || advice.clone(),
                |stiffness| because(setup, breakdown, stiffness.explains(*step_s), stiffness, &advice),
            );
            let budget_bytes = setup.solver.memory_budget_bytes;
            // The length of steps is the mean of those that are kept.
            let more = if *need_bytes <= budget_bytes as f64 { ", and more as steps become shorter," } else { "" };
            format!(
                "{blamed} in steps of {} s, in which all that is sent within the longest delay, {} s, takes {} bytes{more} where \
                 `memory_budget_bytes` is {budget_bytes}; {why}",
                about(*step_s),
                number(setup.network.max_delay_s()),
                about(*need_bytes),
            )
        }
        BreakdownCause::Delay { delay, at_s } => {
            let words = setup.network.delays.get(*delay).map_or("a delay", |delay| delay.words());
            format!("hears through {words} that, at t = {} s, leaves the bounds that its author declared", about(*at_s))
        }
        BreakdownCause::RanAway { value, steps } => format!(
            "ran away: it is {}, and {steps} steps did not reach the next sample; sample faster, or let K or the \
             delay of the torque be smaller",
            text::number(*value)
        ),
        // Adding zero leaves no sign at a zero.
        BreakdownCause::Vanished { value, .. } if breakdown.t_s <= 0.0 => {
            format!("is {} where it starts, and the law divides by it; start elsewhere", about(value + 0.0))
        }
        BreakdownCause::Vanished { value, floor } => {
            let (what, unit) = match breakdown.signal {
                Signal::Thrust => ("the thrust, which", " N"),
                _ => ("it, and it", ""),
            };
            // A period that is too long brings everything out of step, and is looked at first.
            let faster = if setup.control.is_some() { "sample faster, " } else { "" };
            let has_target = setup.agents.get(breakdown.agent).is_some_and(|agent| agent.target.is_some());
            let target = if has_target { "choose a target that stays away from there, " } else { "" };
            format!(
                "is {}{unit}: the law divides by {what} must stay away from zero by {}{unit}; {faster}{target}start elsewhere, or choose \
                 slower gains",
                text::number(*value),
                text::number(floor.abs())
            )
        }
        BreakdownCause::PositionLimit { value, limits: [low, high] } => {
            format!("left its limits [{low}, {high}]: it is {value}")
        }
    }
}

/// The order of backstepping that gives no finite number at the start.
fn steps_of_backstepping(setup: &Setup, breakdown: &Breakdown) -> Option<usize> {
    let law = setup.agents.get(breakdown.agent).filter(|_| breakdown.t_s <= 0.0)?.law.downcast()?;
    match law {
        ChainLaw { step: ChainStep::Backstepping { gains_per_s, .. }, .. } => Some(gains_per_s.len()),
        ChainLaw { .. } => None,
    }
}

/// What lets steps be longer that are not short because of the closed loop.
fn longer(setup: &Setup) -> &'static str {
    match setup.solver.method {
        Method::Fixed { .. } => "raise `step_s`",
        Method::Adaptive { .. } if setup.solver.max_step_s.is_some() => "raise `max_step_s`, loosen the tolerances",
        Method::Adaptive { .. } => "loosen the tolerances",
    }
}

/// How fast the closed loop is and, where that is why steps are short, because of what; otherwise `advice`.
fn because(setup: &Setup, breakdown: &Breakdown, is_stiff: bool, stiffness: &Stiffness, advice: &str) -> String {
    let fastest = format!("its fastest rate is about {} 1/s", about(stiffness.rate_per_s));
    if !is_stiff {
        return format!("the closed loop is not stiff, {fastest}: {advice}");
    }
    match setup.agents.get(breakdown.agent).zip(stiffness.gains) {
        Some((agent, gains)) => {
            format!("the closed loop is stiff, {fastest}; {}", blamed(agent, stiffness.rate_per_s, gains))
        }
        None => format!("the closed loop is stiff, {fastest}"),
    }
}

/// The rates of the gains of an agent under (6)–(7), and which of them to lower.
fn blamed(agent: &AgentSetup, fastest_per_s: f64, gains: GainRates) -> String {
    let law = if agent.estimates() { "adaptive" } else { "known" };
    let damping = (gains.damping_per_s, "K/λ_min(M)", format!("lower `law.{law}.damping`"));
    // Gears turn with their rotors, whose inertia a URDF leaves out.
    let viscous = || {
        let advice =
            "that is the robot's own damping: state the `armature` of its joints, or lock those that are so light";
        (gains.viscous_per_s, "D/λ_min(M)", advice.to_owned())
    };
    let adaptation = |rate| {
        let advice = "lower `law.adaptive.adaptation_gain`, or let it start nearer and slower: Y grows with the motion";
        (rate, "√(Γ‖Y‖²/λ_min(M))", advice.to_owned())
    };
    let viscous = (gains.viscous_per_s > 0.0).then(viscous);
    let rates = [Some(damping), viscous, gains.adaptation_per_s.map(adaptation)];
    let rates: Vec<_> = rates.into_iter().flatten().collect();
    let told: Vec<String> =
        rates.iter().map(|(rate, symbol, _)| format!("{symbol} is about {} 1/s", about(*rate))).collect();
    let apart = |rate: f64| (rate / fastest_per_s).max(fastest_per_s / rate);
    let nearest = rates.iter().min_by(|a, b| apart(a.0).total_cmp(&apart(b.0)));
    let advice = nearest.filter(|(rate, _, _)| apart(*rate) < BLAMED_WITHIN).map_or(
        "no gain of its law explains it: look at where it starts, at the reference dynamics and at the weights",
        |(_, _, advice)| advice,
    );
    format!("at {} {}: {advice}", agent.name, told.join(" and "))
}
