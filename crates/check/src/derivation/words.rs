//! Sentences of explanations.

use forwardstep_core::robot::SMOOTHING_LOSS;
use forwardstep_sim::Setup;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::reference::Desired;
use num_traits::Zero;

use crate::hypothesis::numbers::rounded_up;

use super::case::{Case, Led, Step, ThrustStep};
use super::form::Letter;
use super::formula::At;
use super::lower::Rubbing;

/// `1st`, `2nd`, ….
pub(super) fn ordinal(n: usize) -> String {
    let ending = match (n % 10, n % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{n}{ending}")
}

/// What stands for s.
pub(super) fn letter(input: Letter, starred: bool) -> &'static str {
    match (input, starred) {
        (Letter::Filter, _) => "y",
        (_, true) => "s*",
        (_, false) => "s",
    }
}

/// s with so many derivatives.
fn derivative(letter: &str, order: usize) -> String {
    match order {
        0 => format!("{letter} itself"),
        1 => format!("the derivative of {letter}"),
        n => format!("the {} derivative of {letter}", ordinal(n)),
    }
}

/// What a new variable does.
pub(super) fn absorbed(letter: &str, before: usize, after: usize) -> String {
    format!("A new variable absorbs {}; {} is left.", derivative(letter, before), derivative(letter, after))
}

/// What the weights and the delays are.
pub(super) fn links(setup: &Setup, heard: At) -> String {
    let edges = || setup.network.schedule.graphs.iter().flatten();
    let constants: Vec<f64> = edges().filter_map(|edge| edge.weight.constant()).collect();
    let range = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if low == high { format!("{low}") } else { format!("{low} to {high}") }
    };
    let formulas = edges().any(|edge| matches!(edge.weight, Weight::Formula(_)));
    let size = match (constants.is_empty(), formulas) {
        (true, false) => return "There are no links.".into(),
        (true, true) => "w_ij(t) follows a formula".to_owned(),
        (false, true) => format!("w_ij(t) is {}, or follows a formula", range(&constants)),
        (false, false) => format!("w_ij is {}", range(&constants)),
    };
    let fixed = setup.network.schedule.constant_graph().is_some();
    let graph = if fixed { " on a fixed graph" } else { ", and zero while the graph in force lacks the link" };
    let delays = || edges().filter_map(|edge| setup.network.delays.get(edge.delay));
    let longest = delays().map(|delay| delay.max_s()).fold(0.0, f64::max);
    let late = match heard {
        At::Now | At::Time => "no message is late".to_owned(),
        At::Late => format!("T_ij is {} s", range(&delays().map(|delay| delay.max_s()).collect::<Vec<_>>())),
        At::VaryingLate => format!("T_ij(t) is at most {} s", rounded_up(longest)),
    };
    format!("{size}{graph}; {late}.")
}

/// Whose a law by a measured acceleration is, and why it needs one.
pub(super) const BY_ACCELERATION: &str = "Not from the paper, but in the manner of the literature with which Remark 8 compares Theorem 5: the acceleration is \
     measured. With reference dynamics of one order more (58) can be integrated by parts, and no acceleration is needed.";

/// What the law makes of s.
pub(super) fn of_s(case: &Case<'_>) -> String {
    match &case.step {
        Step::Robot { known } => return robot(case, *known),
        Step::TaskSpace(_) | Step::TipVelocity(_) => return robot(case, false),
        Step::PositionOnly(_) if case.is_bounded() => return clamped("V = ½ m sᵀs + (k/2λ_f) yᵀy", "V̇ ≤ −k yᵀy", "So s and y are bounded, and y is square-integrable."),
        Step::PositionOnly(_) => {
            "V = ½ m sᵀs + (k/2λ_f) yᵀy + Δm²/(2γ*) has V̇ = −k yᵀy whatever z does. So s, y and m̂ are bounded, and y is \
             square-integrable."
        }
        Step::ModelReference(_) => {
            "Not from the paper, but in the manner of the literature with which Remark 7 compares (a8). V = ½ m (eᵀe + c rᵀr) + ½ h δᵀδ + Δm²/(2γ*) has \
             V̇ = −m b eᵀe − m c p rᵀr − c α₁ rᵀδ − h λ_f δᵀδ, with c = 1/(α₀ − p b), h = α₁² c/(2 m p λ_f) and b = α₁ − p: the last three are \
             together not positive. So e, r, δ and m̂ are bounded and the errors square-integrable; x, y and φ are bounded, and with them ė: e → 0, then \
             r → 0 and ė → 0. m̂' φ = −γ* (eᵀφ) φ is a gain on e that grows with the square of φ."
        }
        Step::Thrust(ThrustStep::Continuous, _) => "",
        Step::Thrust(ThrustStep::Differentiable, _) => {
            "The lower subsystem is linear and exponentially stable, and no reference drives it: s* → 0 with its derivatives."
        }
        Step::Thrust(ThrustStep::ByAcceleration, _) if case.is_biased() => {
            "V = ½ m ṡ*ᵀṡ* + Δm²/(2γ*) has V̇ = −α* m ṡ*ᵀṡ* − Δm wᵀe, where e is the bias of an accelerometer. The last term has no sign, and \
             nothing of what follows is shown: ṡ* need not vanish."
        }
        Step::Thrust(step, _) if step.adapts() && case.is_bounded() => {
            return clamped(
                "V = ½ m ṡ*ᵀṡ*",
                "V̇ ≤ −α* m ṡ*ᵀṡ*",
                "So ṡ* is bounded and square-integrable; s* itself need not vanish.",
            );
        }
        Step::Thrust(ThrustStep::Adaptive | ThrustStep::ByAcceleration, _) => {
            "V = ½ m ṡ*ᵀṡ* + Δm²/(2γ*) has V̇ = −α* m ṡ*ᵀṡ* whatever z does. So ṡ* is bounded and square-integrable, and m̂ is \
             bounded; s* itself need not vanish."
        }
        Step::Attitude(_) => {
            "V = ½ (ω − z)ᵀM(ω − z) + ½ ẏᵀẏ has V̇ = −ẏᵀΛ_f ẏ whatever z does, since S(h) is skew-symmetric. So ω − z is bounded, and \
             ẏ is square-integrable; then ÿ → 0, and with it ω − z → 0."
        }
        Step::PassivityFilter(_) => {
            "V = ½ ΔωᵀM Δω + 2k (1 − Δq_o) + ½ ẏᵀẏ, with k the gain of Δq_v, has V̇ = −ẏᵀΛ_f ẏ + ΔωᵀM S(Δω) ω_d, since S(h) is \
             skew-symmetric. The last term is zero where the target keeps still, or where M is a multiple of the identity: ẏ is then \
             square-integrable, ÿ → 0, and with it Δω → 0 and Δq_v → 0. Elsewhere it has no sign, and nothing is shown."
        }
        Step::Chain(_, kind, _) => {
            let bounds = if case.is_bounded() { kept(*kind) } else { "" };
            return chain(*kind) + bounds;
        }
        Step::Outside(_) => "",
    }
    .into()
}

/// What (6)–(7), or known parameters, make of V, and what it loses or gains beside the terms of the paper.
fn robot(case: &Case<'_>, known: bool) -> String {
    let outside = case.outside();
    let v = if known { "½ sᵀM s" } else { "½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ" };
    let lost = if outside.damped { "sᵀ(K + D)s" } else { "sᵀK s" };
    let skew = "since Ṁ − 2C is skew-symmetric";
    let vanishing = "So s is bounded and square-integrable";
    let (balance, because, so) = match outside.rubbing {
        None => (format!("V̇ = −{lost}"), String::new(), vanishing),
        Some(Rubbing::Smooth) => {
            (format!("V̇ = −{lost} − sᵀF[tanh(ε⁻¹q̇) − tanh(ε⁻¹z)] ≤ −{lost}"), " and tanh rises".to_owned(), vanishing)
        }
        Some(Rubbing::Dry) => (
            format!("V̇ ≤ −{lost} + {SMOOTHING_LOSS:.4} Σ ε F"),
            format!(
                ", and s (σ − tanh(ε⁻¹z)) ≥ −{SMOOTHING_LOSS:.4} ε for every σ of Sgn(q̇), whether a joint slides or sticks"
            ),
            "So s is small in the mean over a long time, and need not vanish",
        ),
    };
    let estimates = match (known, outside.rubbing) {
        (true, _) => "",
        (false, Some(Rubbing::Dry)) if case.is_bounded() => ", and ϑ̂ stays within its bounds",
        (false, Some(Rubbing::Dry)) => ", and nothing keeps ϑ̂ from drifting",
        (false, _) => ", and ϑ̂ is bounded",
    };
    if let Led::Backstepping = case.led {
        return format!(
            "V = {v} has {balance} + sᵀM(ζ − ż), {skew}{because}, with ζ for the output of the filter, which stands for ż in the law and in what is \
             said of ṡ. The last term has no sign, and where z jumps V does: nothing of what follows is shown there."
        );
    }
    format!("V = {v} has {balance} whatever z does, {skew}{because}. {so}{estimates}.")
}

/// What becomes of all that is said of V where something acts from outside.
pub(super) fn while_pushed(case: &Case<'_>) -> Option<String> {
    use super::case::ChainStepKind::Backstepping;
    let beside = match &case.step {
        Step::Robot { .. } | Step::TaskSpace(_) | Step::TipVelocity(_) | Step::PositionOnly(_) => {
            "its power sᵀτ_ext comes beside that"
        }
        Step::Thrust(ThrustStep::Continuous | ThrustStep::Differentiable, _) => "it drives what is said to vanish",
        Step::Thrust(ThrustStep::Adaptive | ThrustStep::ByAcceleration, _) => {
            "the power of ṡ* times τ̇_ext + α* τ_ext comes beside that"
        }
        Step::Attitude(_) => "its power (ω − z)ᵀτ_ext comes beside that",
        Step::PassivityFilter(_) => "its power Δωᵀτ_ext comes beside that",
        Step::ModelReference(_) => "what e, r and δ make of f comes beside that",
        Step::Chain(_, Backstepping, _) => {
            "Σ eₖ vₖ comes beside that, where vₖ is what acts on the k-th equation less what the virtual control α_(k−1) makes of what acts on \
             those before"
        }
        Step::Chain(..) => "the power s w comes beside that",
        Step::Outside(_) => return None,
    };
    let words =
        || format!("While something acts from outside, {beside}; what is said to vanish then need not, until it ends.");
    case.is_pushed().then(words)
}

/// What V has of a mass that is used no farther than its bounds.
fn clamped(rest: &str, balance: &str, so: &str) -> String {
    format!(
        "{rest} + W/γ*, with W = ∫ (Π(σ) − m) dσ from m to μ, has {balance} whatever z does: μ is what is found of the mass, m̂ = Π(μ) what is \
         used of it within the bounds, and W ≥ ½ Δm². {so}"
    )
}

/// What bounds of θ̂ change of that.
fn kept(kind: super::case::ChainStepKind) -> &'static str {
    use super::case::ChainStepKind::{Adaptive, Backstepping, Immersion, Linearising};
    match kind {
        Linearising => "",
        Adaptive => " At the bounds of θ̂ its rate is slowed, which only takes more from V.",
        Immersion => {
            " θ̂ + β is used no farther than its bounds, so that ζ = Π(θ̂ + β) − θ; V has ∫ ζᵀΓ⁻¹ d(θ̂ + β)/c for its last term, and falls no \
             slower."
        }
        Backstepping => {
            " θ̂ stays strictly between its bounds, where Γ(θ̂) vanishes: V has ∫ ΔθᵀΓ(θ̂)⁻¹ dθ̂ for its last term, and loses the same."
        }
    }
}

fn chain(kind: super::case::ChainStepKind) -> String {
    use super::case::ChainStepKind::{Adaptive, Backstepping, Immersion, Linearising};
    match kind {
        Linearising => "s falls exponentially, whatever the plant is and whatever z does.",
        Adaptive => {
            "V = ½ s² + ½ ΔθᵀΓ⁻¹Δθ loses the square of s times the gain, whatever z does. So s is bounded and square-integrable, and θ̂ is \
             bounded."
        }
        Immersion => {
            "V = ½ s² + ζᵀΓ⁻¹ζ/(2c), with c the gain, loses squares of s and of φᵀζ, whatever z does. So both are square-integrable, and \
             s → 0."
        }
        Backstepping => {
            "V = ½ Σ eᵢ² + ½ ΔθᵀΓ⁻¹Δθ with e₁ = s loses Σ cᵢ eᵢ², whatever z does. So s is bounded and square-integrable, and θ̂ is \
             bounded."
        }
    }
    .into()
}

/// What follows for the upper subsystem: `left` is the highest derivative of s that the reduction leaves.
pub(super) fn of_all(case: &Case<'_>, left: usize, input: Letter) -> String {
    let s = letter(input, matches!(case.step, Step::Thrust(..)));
    let q = case.notation().position;
    let enters = match (&case.step, left) {
        (Step::Thrust(step, _), _) if step.adapts() => {
            "The upper subsystem is then driven by ṡ* alone, which is square-integrable.".to_owned()
        }
        (_, 0) => format!("The upper subsystem is then driven by {s} alone, without any derivative."),
        (_, 1) => format!(
            "The upper subsystem is then driven by {s} and its derivative, whose integral is {s} − {s}(0) and so is bounded."
        ),
        (_, n) => format!("The upper subsystem is then driven by {s} and {n} derivatives of it."),
    };
    let bounded = match &case.step {
        Step::Robot { .. } => {
            "So the variables of the upper subsystem are bounded; then q̇ and ṡ are, s is uniformly continuous and vanishes, ṡ vanishes"
        }
        Step::Thrust(..) => "So the variables of the upper subsystem are bounded, and ṡ* vanishes",
        Step::PositionOnly(_) => "So the variables of the upper subsystem are bounded, and y and s vanish",
        Step::Attitude(_)
        | Step::PassivityFilter(_)
        | Step::ModelReference(_)
        | Step::TaskSpace(_)
        | Step::TipVelocity(_)
        | Step::Chain(..)
        | Step::Outside(_) => "So the variables of the upper subsystem are bounded, and s vanishes",
    };
    let bounded = match case.outside().rubbing {
        Some(Rubbing::Dry) => return format!("{enters} {}", with_dry_friction(case)),
        Some(Rubbing::Smooth) | None => bounded,
    };
    let then = match &case.led {
        Led::Consensus(_) | Led::PureIntegral(_) if case.roots.all_real().is_none() => format!(
            "With {s} = 0, what is left is linear, but no chain of averages, since not all roots are real: the theorem does not say that agents \
             agree, and over graphs that switch they may not."
        ),
        Led::Consensus(_) | Led::PureIntegral(_) => format!(
            "With {s} = 0, each ψ moves towards an average of what is its own and what is heard, whatever the bounded delays are; as long as the \
             graph is connected as the theorem asks, all ψ come together. {bounded}, and what is left is the undisturbed system: \
             {q}ᵢ − {q}ⱼ → 0, and all derivatives of {q}ᵢ vanish."
        ),
        Led::Leader(FollowingDesign::Swarm { .. }, _) => format!(
            "With {s} = 0, the differences to the leader fall as long as the coupling and γ are as large as `forwardstep check` asks. {bounded}, and \
             {q}ᵢ − {q}₀ → 0 with its derivative."
        ),
        Led::Leader(..) if case.heard() != At::Now => format!(
            "With {s} = 0, the largest difference to the leader falls at a rate of γ less the largest size of what drives the leader, until it is as \
             small as the delays let it be: what the leader does meanwhile has not been heard yet. {bounded}, and {q}ᵢ − {q}₀ stays within what \
             `forwardstep check` says."
        ),
        Led::Leader(..) => format!(
            "With {s} = 0, the largest difference to the leader falls at a rate of γ less the largest size of what drives the leader, and \
             vanishes in finite time. {bounded}, and {q}ᵢ − {q}₀ → 0 with its derivative."
        ),
        Led::Target => format!(
            "With {s} = 0, what is left is a linear system with the given roots, which is exponentially stable. {bounded}, and so does the distance \
             from the target."
        ),
        Led::Desired(Desired { protocol: Some(protocol), .. }) => match protocol.stable_because {
            Some(_) => format!("With {s} = 0, what is left is what the scenario states, of which its author says where it leads."),
            None => format!("With {s} = 0, what is left is what the scenario states, and nothing says where that leads."),
        },
        Led::Desired(desired) if desired.follows_target => format!(
            "With {s} = 0, what is left is a linear system with the given polynomial, which is exponentially stable where that is Hurwitz, as \
             `forwardstep check` says. {bounded}, and so does the distance from the target."
        ),
        Led::Desired(_) => "With s = 0 the desired dynamics as stated are left, and no theorem of the paper covers their convergence.".into(),
        Led::Backstepping => "Where the graph switches or a delay jumps the derivative of what is heard is infinite, and the paper promises \
                              nothing there."
            .into(),
        Led::Outside(..) | Led::Refuted(..) => "With s = 0 the reference dynamics do what their author declares.".into(),
    };
    let moved = if case.lambda.is_zero() {
        ""
    } else {
        " λ s is square-integrable, but its integral need not be bounded: it moves where the agents agree, which is what makes them give way to a \
         hand."
    };
    format!("{enters} {then}{moved}")
}

/// What is left where s need not vanish.
fn with_dry_friction(case: &Case<'_>) -> String {
    let undisturbed = match &case.led {
        Led::Consensus(_) | Led::PureIntegral(_) => "all agents would come together",
        Led::Leader(..) => "all agents would reach the leader",
        Led::Target => "the distance from the target would vanish",
        Led::Backstepping | Led::Desired(_) | Led::Outside(..) | Led::Refuted(..) => {
            "the reference dynamics would do what is said of them"
        }
    };
    format!(
        "With s = 0, {undisturbed}. Since s need not vanish, differences in proportion to it stay: the theorem does not cover this, and \
         `forwardstep check` says how large s stays."
    )
}
