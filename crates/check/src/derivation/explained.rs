//! The explanation of one design.

use forwardstep_core::expression::Number;
use forwardstep_sim::leader::FollowingDesign;
use num_rational::BigRational;
use num_traits::{One, Zero};

use super::cascade::Upper;
use super::case::{Case, ChainStepKind, Led, Step, ThrustStep};
use super::composite::{self, Composite};
use super::dynamics::{Dynamics, Measured, Smooth, backstepping, consensus, declared, following, tracking};
use super::explanation::{Explained, Section, Subject};
use super::form::{Combination, Form, Letter, Links, Quantity, Vertex};
use super::formula::{At, Formula, Sign, Symbol};
use super::lower::{self, ChainError, Lower, Rubbing};
use super::notation::Notation;
use super::observer::{self, Observer};
use super::places::Places;
use super::polynomial::Polynomial;
use super::reduction::Reduced;
use super::words;
use super::{attitude, model_reference, task_space};

impl Case<'_> {
    /// Explains it.
    pub fn explained(&self) -> Explained {
        let mut explained = self.undisturbed();
        let last = explained.sections.pop().map(|section| match words::while_pushed(self) {
            Some(words) if section.subject == Subject::Convergence => section.words(words),
            _ => section,
        });
        explained.sections.extend(last);
        explained
    }

    /// The same, without what acts from outside.
    fn undisturbed(&self) -> Explained {
        match (&self.led, &self.step) {
            (Led::Outside(name, None), _) => self.silent(&format!(
                "{name} come from outside and do not say that they are linear, so nothing is derived from them."
            )),
            (Led::Refuted(name, found), _) => self.silent(&format!(
                "{name} come from outside, and they are not what they say: {}. Nothing is derived from them until what `linear` returns is z^(ℓ) \
                 of the dynamics; `forwardstep check` tries it too.",
                crate::hypothesis::counterexample(found)
            )),
            (_, Step::Outside(name)) => {
                self.silent(&format!("{name} comes from outside, so that nothing is known here of what it does to s."))
            }
            (_, Step::Attitude(gains)) => attitude::explained(self, gains),
            (_, Step::PassivityFilter(k)) => attitude::filtered(self, k),
            (_, Step::ModelReference(rate)) => model_reference::explained(self, rate),
            (_, Step::TaskSpace(gains)) => task_space::explained(self, gains),
            (_, Step::TipVelocity([kappa, alpha])) => task_space::by_velocity(self, kappa, alpha),
            (_, Step::Robot { .. } | Step::PositionOnly(_) | Step::Thrust(..) | Step::Chain(..)) => {
                if let Some(observer) = self.observer() {
                    return observer::explained(self, &observer);
                }
                if let Some(composite) = self.composite() {
                    return composite::explained(self, &composite);
                }
                let Some(dynamics) = self.dynamics() else {
                    return self.silent("Its reference dynamics have too few roots for its plant.");
                };
                self.linear(&dynamics)
            }
        }
    }

    fn silent(&self, words: &str) -> Explained {
        let sections = vec![Section::new(Subject::ReferenceDynamics).words(words)];
        Explained { agents: self.agents.clone(), order: None, degrees: None, sections }
    }

    /// What is measured of its plant.
    fn measured(&self) -> Measured {
        match &self.step {
            Step::PositionOnly(_) | Step::ModelReference(_) => Measured { plant: 2, below: 1 },
            Step::Robot { .. }
            | Step::Thrust(..)
            | Step::Attitude(_)
            | Step::PassivityFilter(_)
            | Step::TaskSpace(_)
            | Step::TipVelocity(_)
            | Step::Chain(..)
            | Step::Outside(_) => Measured::whole(self.step.plant()),
        }
    }

    /// Its reference dynamics; `None` where there are too few roots.
    pub fn dynamics(&self) -> Option<Dynamics> {
        match &self.led {
            Led::Consensus(heard) => consensus(&self.roots, *heard, &self.lambda, self.measured()),
            Led::PureIntegral(heard) => consensus(&self.roots, *heard, &self.lambda, Measured::WITH_ACCELERATION),
            Led::Backstepping => Some(backstepping()),
            Led::Leader(FollowingDesign::Continuous, [alpha, _, gamma]) => Some(following(alpha, gamma)),
            // Weights and delays that vary are not covered by the theorems; what is derived is for those that do not.
            Led::Leader(..) => self.smooth().and_then(|smooth| smooth.dynamics(Links::Constant).ok()),
            Led::Target => tracking(&self.roots, self.measured()),
            Led::Desired(desired) => super::desired::dynamics(desired, self.step.plant()),
            Led::Outside(_, linear) => linear.as_ref().map(declared),
            Led::Refuted(..) => None,
        }
    }

    /// An observer of the leader.
    pub(super) fn observer(&self) -> Option<Observer> {
        let Led::Leader(FollowingDesign::Observer { kappa }, [alpha, _, gamma]) = &self.led else { return None };
        Some(Observer { alpha: alpha.clone(), gamma: gamma.clone(), kappa: Number::written(*kappa) })
    }

    /// Agents that agree with their leader on one vector.
    pub(super) fn composite(&self) -> Option<Composite> {
        let Led::Leader(FollowingDesign::Composite, [alpha, beta, gamma]) = &self.led else { return None };
        let [alpha, beta, gamma] = [alpha, beta, gamma].map(Clone::clone);
        Some(Composite { alpha, beta, gamma })
    }

    /// (119), (122) or swarm tracking.
    pub fn smooth(&self) -> Option<Smooth> {
        let Led::Leader(design, [alpha, beta, gamma]) = &self.led else { return None };
        let (by_itself, coupling) = match design {
            FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. } => return None,
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration => (true, 1.0),
            FollowingDesign::Swarm { coupling } => (false, *coupling),
        };
        let [alpha, beta, gamma] = [alpha, beta, gamma].map(Clone::clone);
        Some(Smooth { alpha, beta, gamma, by_itself, coupling: Number::written(coupling) })
    }

    /// Its lower subsystem; `None` under continuous control of a vehicle, which leaves none, and under backstepping of a chain.
    pub fn lower(&self) -> Option<Lower> {
        Some(match &self.step {
            Step::Robot { known } => lower::robot(self.outside(), *known, None),
            Step::PositionOnly([k, _]) => lower::position_only(self.outside(), k),
            Step::Thrust(ThrustStep::Continuous, _) | Step::ModelReference(_) | Step::Outside(_) => return None,
            Step::Thrust(ThrustStep::Differentiable, [alpha, k]) => lower::thrust(self.outside(), alpha, Some(k)),
            Step::Thrust(ThrustStep::Adaptive | ThrustStep::ByAcceleration, [alpha, _]) => {
                lower::thrust(self.outside(), alpha, None)
            }
            Step::Attitude(_) => lower::attitude(self.outside()),
            Step::PassivityFilter(k) => lower::passivity_filter(self.outside(), k),
            Step::TaskSpace([kappa, _]) | Step::TipVelocity([kappa, _]) => {
                lower::robot(self.outside(), false, Some(kappa))
            }
            Step::Chain(order, kind, gain) => {
                let error = match kind {
                    ChainStepKind::Backstepping => return None,
                    ChainStepKind::Linearising => ChainError::None,
                    ChainStepKind::Adaptive => ChainError::Adapted,
                    ChainStepKind::Immersion => ChainError::Immersed,
                };
                lower::chain(self.outside(), *order, gain, error)
            }
        })
    }

    /// How its quantities are written.
    pub fn notation(&self) -> Notation {
        let position = match self.step {
            Step::Robot { .. } | Step::TaskSpace(_) | Step::TipVelocity(_) | Step::Outside(_) => "q",
            Step::PositionOnly(_) | Step::ModelReference(_) | Step::Thrust(..) | Step::Chain(..) => "x",
            Step::Attitude(_) | Step::PassivityFilter(_) => "ω",
        };
        let alone = self.setup.agents.len() == 1 || self.is_led_to_target();
        Notation {
            position,
            starred_error: matches!(self.step, Step::Thrust(..)),
            apart: if matches!(self.step, Step::PassivityFilter(_)) { "" } else { "∗" },
            own: if alone { "" } else { "i" },
            heard: self.heard(),
            weights: self.weights(),
            variables: Vec::new(),
        }
    }

    fn linear(&self, dynamics: &Dynamics) -> Explained {
        let (notation, places) = (self.notation(), Places::of(self, dynamics.order));
        if let Step::Thrust(ThrustStep::Continuous, _) = self.step {
            return self.without_reference(dynamics, &notation);
        }
        let lower_order = self.lower_order();
        let upper = self.upper(dynamics);
        let (reduction, reduced) = self.reduction(&upper, dynamics, (&notation, &places));
        let degrees = [dynamics.upper().degree(lower_order), reduced.as_ref().map_or(0, |r| r.degree(lower_order))];
        let left = reduced.as_ref().map_or(0, |reduced| reduced.derivatives);
        let plant = match self.step {
            Step::Chain(order, ChainStepKind::Backstepping, _) => order,
            _ => dynamics.plant,
        };
        let mut control = virtual_control(plant, dynamics, &notation, &places);
        if let Step::Thrust(ThrustStep::ByAcceleration, _) = self.step {
            control = control.words(words::BY_ACCELERATION);
        }
        let mut sections = vec![
            control,
            self.reference(dynamics, &notation, &places),
            self.controller(&notation, &places),
            self.cascade(dynamics, degrees[0], (&notation, &places)),
        ];
        sections.extend(reduction);
        sections.extend(self.laplacian(&upper, &notation, &places));
        let conclusion = Section::new(Subject::Convergence).words(words::of_s(self));
        sections.push(conclusion.words(words::of_all(self, left, upper.input)));
        let order = Some(dynamics.total_order());
        Explained { agents: self.agents.clone(), order, degrees: Some(degrees), sections }
    }

    /// Where the leader is, and where it was when what is heard was told.
    pub(super) fn leader(&self) -> [Quantity; 2] {
        let leader = Quantity::of_leader(Letter::Position);
        let then = if self.heard() == At::Now { Vertex::Leader } else { Vertex::LateLeader };
        [leader, Quantity { vertex: then, ..leader }]
    }

    /// The upper subsystem, relative to what is followed and behind the filter that stands in for s.
    pub fn upper(&self, dynamics: &Dynamics) -> Upper {
        let (mut upper, target) = (dynamics.upper(), Quantity::own(Letter::Target));
        if !self.alike {
            upper = upper.among_others();
        }
        match (&self.led, &self.step) {
            (Led::Leader(..), _) => upper.relative_to(self.leader()),
            (Led::Target, Step::PositionOnly([_, filter])) => upper.relative_to([target; 2]).filtered(&lag(filter)),
            _ if self.is_led_to_target() => upper.relative_to([target; 2]),
            (_, Step::PositionOnly([_, filter])) => upper.filtered(&lag(filter)),
            _ => upper,
        }
    }

    fn reference(&self, dynamics: &Dynamics, notation: &Notation, places: &Places) -> Section {
        let mut section = self.desired.map_or_else(
            || Section::new(Subject::ReferenceDynamics),
            |desired| super::desired::asked(desired, notation),
        );
        if self.roots.order() > 0 && !matches!(self.led, Led::Outside(..)) {
            let product = notation.polynomial(&self.roots.product());
            let equation = match self.roots.factors().count() {
                1 => product,
                _ => Formula::equal(notation.factors(&self.roots), product),
            };
            section = section
                .words("The roots of the scenario, without their sign, give a polynomial, with p for d/dt:")
                .formula(equation, "(25)");
        }
        if self.agents.iter().any(|agent| self.setup.agents[*agent].target.is_some()) && !self.is_led_to_target() {
            section = section.words(format!(
                "Agents keep an offset from where all agree. Here and in the cascade, {0} and z stand for what they are less that offset and its \
                 derivative; in the plant and in the law they are themselves, and the offset cancels in what s obeys.",
                notation.position
            ));
        }
        if let Led::Outside(name, _) = self.led {
            section = section
                .words(format!("{name}: from outside, and linear as its author says. c does not depend on the state."));
        }
        let z = Quantity::own(Letter::Reference);
        section = match self.smooth() {
            Some(smooth) if self.led_without_acceleration() => section
                .formula(notation.equation(z, 1, &smooth.realised().right), places.reference)
                .formula(notation.equation(Quantity::own(Letter::Integral), 1, &smooth.integral_rate()), "")
                .words("Its derivative, for constant weights and no delay, is")
                .formula(notation.equation(z, 2, &dynamics.right), ""),
            _ => section.formula(notation.equation(z, dynamics.order, &dynamics.right), places.reference),
        };
        section = self.signs(section, notation);
        if let Led::PureIntegral(_) = self.led {
            let integrated = dynamics.integrated();
            section = section
                .words(
                    "It is integrated once, so that no acceleration is measured and no delayed signal differentiated; the weights have to be \
                     constant for that.",
                )
                .formula(notation.equation(z, 1, &integrated.dz), "Remark 2")
                .formula(notation.equation(Quantity::own(Letter::Integral), 1, &integrated.d_eta), "");
        }
        if dynamics.has_network() {
            section = section.words(words::links(self.setup, self.heard()));
        }
        if dynamics.order == 0
            && let Err(refusal) = dynamics.right.differentiated(self.links())
        {
            section = section.words(format!(
                "z is no state here, so its derivative has to be found by differentiating: {refusal}. A filter stands in for it."
            ));
        }
        section
    }

    fn led_without_acceleration(&self) -> bool {
        matches!(self.led, Led::Leader(FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. }, _))
    }

    /// What a sign is taken of.
    pub(super) fn signs(&self, section: Section, notation: &Notation) -> Section {
        let Led::Leader(design, [alpha, beta, _]) = &self.led else { return section };
        let (q, z) = (Letter::Position, Letter::Reference);
        let (base, above, xi) = match design {
            FollowingDesign::Continuous => ("ξ", "", vec![(q, Polynomial::factor(alpha))]),
            FollowingDesign::Observer { .. } => ("ξ", "", vec![(Letter::Observed, Polynomial::factor(alpha))]),
            FollowingDesign::Composite => (
                "y",
                "",
                vec![
                    (z, &Polynomial::power(1) + &Polynomial::number(beta.clone())),
                    (q, Polynomial::number(alpha.clone())),
                ],
            ),
            FollowingDesign::Differentiable => ("ξ", "∗", vec![(q, &Polynomial::power(2) + &low(alpha, beta))]),
            FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. } => {
                ("ξ", "∗∗", vec![(z, Polynomial::power(1)), (q, low(alpha, beta))])
            }
        };
        let measured = *design == FollowingDesign::Continuous;
        let place = if measured { "(4)" } else { "" };
        let estimated = matches!(design, FollowingDesign::Observer { .. });
        let symbol = |index: &'static str| {
            let symbol = Symbol::new(base).above(above).below(index);
            Formula::from(if estimated { symbol.hat() } else { symbol })
        };
        let of = |all: Combination, (letter, a): (Letter, Polynomial)| all.plus(Quantity::own(letter), &a);
        let form = Form::own(xi.into_iter().fold(Combination::default(), of));
        let difference = Formula::sum([(Sign::Plus, symbol("i")), (Sign::Minus, symbol("j"))]);
        let weight = Formula::from(Symbol::new("w").below("ij"));
        let argument = Formula::product([Formula::NeighbourSum, weight, Formula::bracket(difference)]);
        let selection = Formula::Element(
            Box::new(Symbol::new("ς").below("i").into()),
            Box::new(Formula::Function(Symbol::new("Sgn"), vec![argument])),
        );
        section
            .words("ς is a value of the set-valued sign; vertex 0 is the leader.")
            .formula(selection, "")
            .formula(Formula::equal(symbol("i"), notation.form(&form)), place)
    }

    pub(super) fn controller(&self, notation: &Notation, places: &Places) -> Section {
        let section = Section::new(Subject::Controller);
        let Some(lower) = self.lower() else {
            return section.words(
                "The parameters of the chain are unknown and enter each of its equations, so z leads x₁ itself, and the steps of adaptive \
                 backstepping make s = x₁ − z vanish. All derivatives of z up to the order of the chain are states or follow from the \
                 reference dynamics, so nothing that was heard is differentiated.",
            );
        };
        let input = Quantity::own(Letter::Term(lower.input));
        let law = Formula::equal(notation.quantity(input, 0), notation.form(&lower.law));
        let motion = lower.motion(notation);
        let mut section = section.formula(motion, places.plant).formula(law, places.law);
        if self.outside().rubbing == Some(Rubbing::Dry) {
            section =
                section.words("τ_ext holds the dry friction −F σ, where σ is a value of the set-valued sign of q̇.");
        }
        super::adaptation::of(self, notation)
            .into_iter()
            .fold(section, |section, (formula, place)| section.formula(formula, place))
    }

    /// How many derivatives of s the state of the lower subsystem holds, and one.
    fn lower_order(&self) -> usize {
        match self.step {
            // ė_i = −c_i e_i − e_{i−1} + e_{i+1} + w_iᵀΔθ: with e₁ = s, the errors of all steps and Δθ give s and N − 1 derivatives of it.
            Step::Chain(order, ChainStepKind::Backstepping, _) => order,
            _ => self.lower().map_or(1, |lower| lower.order),
        }
    }

    fn cascade(&self, dynamics: &Dynamics, degree: usize, (notation, places): (&Notation, &Places)) -> Section {
        let upper =
            notation.equation(Quantity::own(Letter::Position), dynamics.total_order(), &dynamics.loop_with_reference());
        let mut section = Section::new(Subject::Cascade)
            .words("The upper subsystem is what the reference dynamics make of the plant, driven by s; the lower one is what the law makes of s.");
        let mut system = vec![upper];
        if let Some(lower) = self.lower() {
            system.push(Formula::equal(notation.form(&lower.left), notation.form(&lower.right)));
        }
        section = section.system(system, places.cascade);
        let derivatives = dynamics.upper().derivatives_of_input();
        let s = if notation.starred_error { "s*" } else { "s" };
        let state = match (self.lower_order(), &self.step) {
            (1, _) => String::new(),
            (n, Step::Chain(..)) => {
                let below = n - 1;
                format!(", of which the state of the lower subsystem, e₁ to e_{n} and Δθ with e₁ = s, holds {below}")
            }
            _ => format!(", of which the state of the lower subsystem, {s} and its derivative, holds one"),
        };
        let count = match derivatives {
            0 => format!("No derivative of {s} stands in the upper subsystem"),
            1 => format!("The upper subsystem holds {s} with one derivative"),
            n => format!("The upper subsystem holds {s} with {n} derivatives"),
        };
        if let Some(desired) = self.desired {
            section = super::desired::parts(desired, &dynamics.upper(), notation, section);
        }
        section.words(format!("{count}{state}: the cascade is of degree {degree}."))
    }

    /// The reduction, and the last system.
    fn reduction(
        &self,
        upper: &Upper,
        dynamics: &Dynamics,
        (notation, places): (&Notation, &Places),
    ) -> (Option<Section>, Option<Reduced>) {
        super::steps::reduction(self, upper, dynamics, (notation, places))
    }
}

/// 1 + p/λ_f.
fn lag(filter: &BigRational) -> Polynomial {
    let rate = if filter.is_zero() { filter.clone() } else { filter.recip() };
    Polynomial::new(vec![BigRational::one(), rate])
}

/// β p + α.
fn low(alpha: &BigRational, beta: &BigRational) -> Polynomial {
    Polynomial::new(vec![alpha.clone(), beta.clone()])
}

/// Of a plant of this order, of which z may stand for an entry below the highest derivative.
fn virtual_control(plant: usize, dynamics: &Dynamics, notation: &Notation, places: &Places) -> Section {
    let (n, order) = (dynamics.total_order(), dynamics.order);
    let position = notation.position;
    let followed = match dynamics.plant.saturating_sub(1) {
        0 => format!("{position} itself"),
        1 => format!("the derivative of {position}"),
        k => format!("the {} derivative of {position}", words::ordinal(k)),
    };
    let grows = match n.cmp(&plant) {
        core::cmp::Ordering::Less => "one less, as in backstepping",
        core::cmp::Ordering::Equal => "the same, which is order invariance",
        core::cmp::Ordering::Greater => "more, which is order increment",
    };
    let words = format!(
        "The plant is of order {plant} with respect to {position}, and the reference dynamics are of order {n}: {grows}. z is what {followed} should \
         be, and s is what is missing.",
    );
    let mut section = Section::new(Subject::VirtualControl).words(words);
    let q = Quantity::own(Letter::Position);
    let z = notation.quantity(Quantity::own(Letter::Reference), order);
    section = section
        .formula(Formula::equal(notation.quantity(Quantity::own(Letter::Error), 0), notation.definition_of_error(dynamics)), places.error)
        .words("The design starts from the identity")
        .formula(Formula::equal(notation.quantity(q, n), notation.quantity(q, n)), places.identity)
        .words("whose sides are taken as the virtual control. What that should be is the following, which the reference dynamics define:")
        .formula(z, "");
    section
}
