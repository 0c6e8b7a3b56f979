//! Degree reduction, step by step, in words and formulas.

use forwardstep_sim::leader::FollowingDesign;

use super::cascade::Upper;
use super::case::{Case, Led, Step, ThrustStep};
use super::dynamics::{Dynamics, Heard};
use super::explanation::{Section, Subject};
use super::form::{Form, Letter, Quantity, Vertex};
use super::formula::Formula;
use super::laplacian::RootsOfAll;
use super::notation::Notation;
use super::places::Places;
use super::polynomial::Polynomial;
use super::reduction::{Name, Reduced, Variable};
use super::stacked;

/// The section and the last system; nothing where z is no state, so that no derivative of s enters.
pub(super) fn reduction(
    case: &Case<'_>,
    upper: &Upper,
    dynamics: &Dynamics,
    (notation, places): (&Notation, &Places),
) -> (Option<Section>, Option<Reduced>) {
    if dynamics.order == 0 {
        return (None, upper.reduced(upper.derivatives(0)));
    }
    let mut section = Section::new(Subject::DegreeReduction);
    if upper.input == Letter::Filter {
        section = section
            .words("s is y and a part of its derivative, so that y stands in the place of s with one derivative more.");
    }
    if let Some(variables) = case.followed_variables(upper) {
        return followed(case, upper, dynamics, variables, (notation, places), section);
    }
    let steps = upper.steps(case.aim());
    section = intermediate(upper, &steps, notation, section);
    let Some(last) = steps.last() else { return (None, None) };
    let mut found = last.clone();
    if !case.has_xi(dynamics) || dynamics.order > 2 {
        section = section.words("The upper subsystem is then").system(notation.system(last), places.reduced);
    }
    if let Some(shifted) = upper.shifted() {
        section = section
            .words("The derivative of y that is left is absorbed by x less a part of y, so that y alone remains.")
            .system(notation.system(&shifted), places.reduced);
        found = shifted;
    }
    if case.has_xi(dynamics)
        && let Some(in_xi) = upper.reduced(case.xi_variables(dynamics))
    {
        section = in_paper_variables(case, upper, dynamics, &in_xi, (notation, places), section);
        found = in_xi;
    }
    (Some(section), Some(found))
}

/// Each new variable, and what is left of s.
fn intermediate(upper: &Upper, steps: &[Reduced], notation: &Notation, mut section: Section) -> Section {
    let letter = super::words::letter(upper.input, notation.starred_error);
    let Some((first, others)) = steps.split_first() else { return section };
    let mut before = first;
    for step in others {
        let changed = step.variables.iter().zip(&before.variables).find(|(new, old)| new != old);
        if let Some((variable, _)) = changed {
            let name = notation.name(variable.name, Vertex::Own, 0);
            let definition = notation.definition(upper, &variable.state, &variable.input);
            section = section
                .words(super::words::absorbed(letter, before.derivatives, step.derivatives))
                .formula(Formula::equal(name, definition), "");
        }
        before = step;
    }
    section
}

impl Case<'_> {
    /// How high a derivative of s the proof leaves.
    pub fn aim(&self) -> usize {
        match (&self.led, &self.step) {
            (Led::Target, _) | (_, Step::Chain(..)) | (_, Step::Thrust(ThrustStep::Differentiable, _)) => 0,
            (_, Step::PositionOnly(_)) => 1,
            (
                Led::Consensus(_)
                | Led::PureIntegral(_)
                | Led::Backstepping
                | Led::Leader(..)
                | Led::Desired(_)
                | Led::Outside(..)
                | Led::Refuted(..),
                Step::Robot { .. }
                | Step::Thrust(ThrustStep::Continuous | ThrustStep::Adaptive | ThrustStep::ByAcceleration, _)
                | Step::Attitude(_)
                | Step::PassivityFilter(_)
                | Step::ModelReference(_)
                | Step::TaskSpace(_)
                | Step::TipVelocity(_)
                | Step::Outside(_),
            ) => 1,
        }
    }

    /// Whether p + κ₀ divides everything, so that ξ = q̇ + κ₀ q and what follows from it are enough.
    pub fn has_xi(&self, dynamics: &Dynamics) -> bool {
        let velocities = matches!(self.led, Led::Consensus(Heard::Velocities) | Led::PureIntegral(Heard::Velocities));
        velocities && dynamics.order <= self.roots.order()
    }

    /// ξ and y = ξ̇ − ṡ for order two; for others what the chain of ψ holds besides s.
    pub fn xi_variables(&self, dynamics: &Dynamics) -> Vec<Variable> {
        let kept = 2;
        let each = |r: usize| {
            let state = self.roots.first(r);
            let (name, state) = match (dynamics.order, r) {
                (_, 1) => (Name::Xi, state),
                (2, _) => (Name::Y, &self.roots.first(1) * &Polynomial::power(1)),
                (_, r) => (Name::Reduced(r), state),
            };
            let common = self.alike && r == 1 && self.roots_of_all != RootsOfAll::Own;
            Variable::constructed(name, state, [kept, dynamics.plant], common)
        };
        (1..=dynamics.order.min(self.roots.order())).map(each).collect()
    }

    /// The variables of those that follow a leader.
    pub fn followed_variables(&self, upper: &Upper) -> Option<Vec<Variable>> {
        let Led::Leader(design, [alpha, beta, _]) = &self.led else { return None };
        let xi = Polynomial::factor(alpha);
        let one = Polynomial::one();
        let star = || Variable {
            name: Name::RelativeXiStar,
            state: &Polynomial::power(2) + &Polynomial::new(vec![alpha.clone(), beta.clone()]),
            input: Polynomial::power(1),
            common: true,
        };
        Some(match design {
            FollowingDesign::Continuous => {
                vec![Variable { name: Name::RelativeXi, state: xi, input: one, common: true }]
            }
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration => vec![star()],
            // No robot enters them.
            FollowingDesign::Composite | FollowingDesign::Observer { .. } => return None,
            FollowingDesign::Swarm { .. } => {
                vec![Variable::derivative(upper.state, 0), Variable::derivative(upper.state, 1), star()]
            }
        })
    }
}

/// (114), (115), (118), and their counterparts for (119), (122) and swarms.
fn followed(
    case: &Case<'_>,
    upper: &Upper,
    dynamics: &Dynamics,
    variables: Vec<Variable>,
    (notation, places): (&Notation, &Places),
    mut section: Section,
) -> (Option<Section>, Option<Reduced>) {
    let continuous = matches!(case.led, Led::Leader(FollowingDesign::Continuous, _));
    let place = |place| if continuous { place } else { "" };
    let whole = |v: &Variable| Variable { name: Name::DeltaXi, input: Polynomial::default(), ..v.clone() };
    let relative: Vec<Variable> = variables.iter().map(whole).collect();
    if continuous && let Some(before) = upper.reduced(relative) {
        section = section
            .words("Relative to the leader, vertex 0, with Δξ_i = ξ_i − ξ_0, the upper subsystem is")
            .system(notation.system(&before), "(114)");
    }
    let Some(reduced) = upper.reduced(variables) else { return (None, None) };
    let Some(last) = reduced.variables.last() else { return (None, None) };
    let name = notation.name(last.name, Vertex::Own, 0);
    section = section
        .words("The variable below absorbs a derivative of s; vertex 0 is the leader, for which it and s are zero.")
        .formula(Formula::equal(name, notation.definition(upper, &last.state, &last.input)), "")
        .system(notation.system(&reduced), place("(115)"));
    let gone: Vec<Form> = reduced.rates.iter().map(|rate| rate.without(upper.input)).collect();
    let gone = Reduced { rates: gone, ..reduced.clone() };
    section = section.words("Once s has vanished this is").system(notation.system(&gone), place("(118)"));
    // Swarm tracking leaves nothing of z on the right.
    let z = Quantity::own(Letter::Reference);
    if let Some(filter) = dynamics.filter().filter(|filter| !filter.own.polynomial(z).is_zero()) {
        section = section
            .words("z is the output of a stable filter:")
            .formula(notation.equation(z, dynamics.order, &filter), places.filter);
    }
    (Some(section), Some(reduced))
}

/// (11), (a2), (12), (a3), (14), (19).
fn in_paper_variables(
    case: &Case<'_>,
    upper: &Upper,
    dynamics: &Dynamics,
    in_xi: &Reduced,
    (notation, places): (&Notation, &Places),
    section: Section,
) -> Section {
    let named = notation.naming(in_xi);
    let mut section = section.words(format!(
        "p + κ₀ divides what the upper subsystem does to q, so that it closes in these variables, and is of degree {}:",
        in_xi.degree(1)
    ));
    for variable in &in_xi.variables {
        let definition = notation.definition(upper, &variable.state, &variable.input);
        let place = if variable.name == Name::Xi { "(4)" } else { "" };
        section = section.formula(Formula::equal(named.name(variable.name, Vertex::Own, 0), definition), place);
    }
    section = section.system(notation.system(in_xi), places.in_xi);
    if !places.stacked.is_empty()
        && case.roots_of_all == RootsOfAll::Same
        && let Some(rows) = in_xi.stacked(upper.input)
    {
        let last = rows.len().saturating_sub(1);
        section = section
            .words("All agents stacked, each matrix times I_m:")
            .system(stacked::system(in_xi, &rows, notation, true), places.stacked)
            .formula(stacked::column(&rows[last], in_xi, notation), "")
            .words("and without s:")
            .system(stacked::system(in_xi, &rows, notation, false), places.undisturbed);
    }
    let z = Quantity::own(Letter::Reference);
    let network = upper.expressed(&Form::network(upper.right.network.clone()), &in_xi.variables);
    if let (Some(filter), Some(network)) = (dynamics.filter(), network) {
        let filter = Form { own: filter.own, network: network.network };
        section = section
            .words(
                "z is the output of a stable filter that these variables and s drive, so it is bounded when they are:",
            )
            .formula(named.equation(z, case.roots.order().min(dynamics.order), &filter), places.filter);
    }
    section
}
