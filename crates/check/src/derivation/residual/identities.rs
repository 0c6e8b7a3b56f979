//! The equations of a case, each as a form that is to be zero.

use super::super::attitude;
use super::super::cascade::Upper;
use super::super::case::{Case, Led, Step, ThrustStep};
use super::super::composite::{self, Composite};
use super::super::dynamics::Dynamics;
use super::super::explanation::Subject;
use super::super::form::{Combination, Form, Letter, Links, Quantity, Term, Vertex};
use super::super::formula::At as AtTime;
use super::super::formula::{Formula, Sign};
use super::super::laplacian::chain;
use super::super::lower::Lower;
use super::super::notation::Notation;
use super::super::observer::Observer;
use super::super::places::Places;
use super::super::polynomial::Polynomial;
use super::super::reduction::{Reduced, Variable};
use super::super::{adaptation, task_space};
use super::Missing;
use super::moment::At;

/// An equation.
pub(super) struct Identity {
    pub(super) subject: Subject,
    pub(super) formula: Formula,
    pub(super) place: &'static str,
    rest: Rest,
}

/// One side less the other.
enum Rest {
    /// In letters that have values.
    Form(Form),
    /// The rate of an estimate, which has entries of its own.
    Estimate,
    /// The same of lengths, (82).
    Kinematic,
    /// Known from the start not to be evaluated.
    Missing(Missing),
}

impl Identity {
    /// One side less the other, entry by entry, each with the size of its terms.
    pub(super) fn residual(&self, at: &mut At<'_, '_>) -> Result<Vec<[f64; 2]>, Missing> {
        match &self.rest {
            Rest::Form(form) => at.form(form),
            Rest::Estimate => at.estimate(),
            Rest::Kinematic => at.kinematic_estimate(),
            Rest::Missing(missing) => Err(*missing),
        }
    }
}

/// How letters that have no values of their own are replaced.
struct Frame {
    /// k.
    plant: usize,
    /// s, or a(p) y where a filter stands in for it.
    error: Combination,
    /// What a deviation is relative to, now and where it is heard.
    followed: Option<[Quantity; 2]>,
    /// The letters in which variables are made.
    letters: [Letter; 2],
    /// z̈ as the derivative of a ż that holds an integrated variable, where weights are constant.
    integrated: Option<Form>,
}

impl Frame {
    fn of(upper: &Upper, case: &Case<'_>) -> Frame {
        let followed = match (&case.led, upper.state) {
            (Led::Leader(..), Letter::Deviation) => Some(case.leader()),
            (_, Letter::Deviation) => Some([Quantity::own(Letter::Target); 2]),
            _ => None,
        };
        let error = Combination::of(Quantity::own(upper.input), upper.filter.clone());
        let constant = matches!(case.led, Led::PureIntegral(_)) && case.weights() == AtTime::Now;
        // Nothing that is heard stands in ż itself.
        let dz = case.dynamics().filter(|_| constant).map(|dynamics| dynamics.integrated().dz);
        // Theorems 8 and 9 take links as constant, and what is heard of the motion of others is then known with all of its derivatives.
        let dz = dz.or_else(|| Some(case.smooth().filter(|_| case.weights() == AtTime::Now)?.realised().right));
        let integrated = dz.and_then(|dz| dz.differentiated(Links::Constant).ok());
        Frame { plant: upper.plant, error, followed, letters: [upper.state, upper.input], integrated }
    }

    /// A form in letters that have values: variables by what they are, deviations by q, and p^(k+1) q by p²(z + s).
    fn plain(&self, form: &Form, variables: &[Variable]) -> Form {
        let one = Polynomial::one();
        let [state, input] = self.letters;
        let form = form.replaced(&one, |quantity| {
            let Letter::Variable(number) = quantity.letter else { return None };
            let variable = variables.get(number)?;
            let of = |letter| Quantity { letter, ..quantity };
            Some(Combination::of(of(state), variable.state.clone()).plus(of(input), &-&variable.input))
        });
        let form = form.replaced(&one, |quantity| {
            let [now, then] = self.followed.filter(|_| quantity.letter == Letter::Deviation)?;
            let followed = if quantity.vertex == Vertex::Neighbour { then } else { now };
            let own = Quantity { letter: Letter::Position, ..quantity };
            Some(Combination::of(own, one.clone()).plus(followed, &-&one))
        });
        let p = Polynomial::power(1);
        let form = form.replaced(&Polynomial::power(self.plant), |quantity| {
            let high = quantity == Quantity::own(Letter::Position);
            let z = Combination::of(Quantity::own(Letter::Reference), one.clone());
            high.then(|| z.sum(&self.error).times(&p))
        });
        let form =
            form.replaced(&p, |quantity| (quantity == Quantity::own(Letter::Error)).then(|| self.error.times(&p)));
        self.integrated.as_ref().map_or(form.clone(), |rate| with_rate(&form, rate))
    }
}

/// A form with p² z of an agent replaced, which may hold the network itself.
fn with_rate(form: &Form, rate: &Form) -> Form {
    let z = Quantity::own(Letter::Reference);
    let (a, twice) = (form.own.polynomial(z), Polynomial::power(2));
    let Some((quotient, rest)) = a.divided_by(&twice) else { return form.clone() };
    let low = Form::own(Combination::of(z, &rest - &a));
    let high = Form { own: rate.own.times(&quotient), network: rate.network.times(&quotient) };
    form.sum(&low).sum(&high)
}

/// The equations of one design, in the order in which they are explained.
pub(super) fn identities(case: &Case<'_>) -> Vec<Identity> {
    let notation = case.notation();
    match (&case.led, &case.step) {
        (_, Step::Attitude(gains)) => spacecraft(case, gains, &notation),
        (_, Step::PassivityFilter(k)) => filtered_spacecraft(case, k, notation),
        (_, Step::TaskSpace([kappa, alpha])) => {
            let dynamics = task_space::reference(alpha);
            let mut list = List::new(notation, Frame::of(&dynamics.upper(), case));
            let z = Quantity::own(Letter::Reference);
            list.equation(Subject::ReferenceDynamics, (z, 1), &dynamics.right, "(76)");
            list.lower(
                case,
                &super::super::lower::robot(case.outside(), false, Some(kappa)),
                ["(73)", "(80)", "(a10)"],
            );
            list.adaptation(case);
            in_order(list.found)
        }
        (_, Step::TipVelocity([kappa, _])) => {
            let dynamics = task_space::function();
            let mut list = List::new(notation, Frame::of(&dynamics.upper(), case));
            let z = Quantity::own(Letter::Reference);
            list.equation(Subject::ReferenceDynamics, (z, 0), &dynamics.right, "");
            list.equation(Subject::ReferenceDynamics, (z, 1), &task_space::rate(), "");
            let lower = super::super::lower::robot(case.outside(), false, Some(kappa));
            list.lower(case, &lower, ["(73)", "(80)", ""]);
            list.adaptation(case);
            in_order(list.found)
        }
        // What is recorded of a law by a model has neither η nor φ; the identity of its V is held by the balance.
        (_, Step::Outside(_) | Step::ModelReference(_)) | (Led::Outside(_, None) | Led::Refuted(..), _) => Vec::new(),
        (_, Step::Thrust(ThrustStep::Continuous, _)) => {
            case.dynamics().map_or_else(Vec::new, |dynamics| continuous(case, &dynamics, notation))
        }
        (_, Step::Robot { .. } | Step::PositionOnly(_) | Step::Thrust(..) | Step::Chain(..)) => {
            if let Some(observer) = case.observer() {
                return observed(case, &observer, notation);
            }
            if let Some(composite) = case.composite() {
                return agreed(case, &composite, notation);
            }
            let found = case.dynamics().map_or_else(Vec::new, |dynamics| linear(case, &dynamics, notation));
            in_order(found)
        }
    }
}

/// Section by section.
fn in_order(mut found: Vec<Identity>) -> Vec<Identity> {
    found.sort_by_key(|identity| identity.subject as usize);
    found
}

/// Equations as they are found.
struct List {
    notation: Notation,
    frame: Frame,
    found: Vec<Identity>,
}

impl List {
    fn new(notation: Notation, frame: Frame) -> Self {
        List { notation, frame, found: Vec::new() }
    }

    fn push(&mut self, subject: Subject, (formula, place): (Formula, &'static str), rest: Rest) {
        self.found.push(Identity { subject, formula, place, rest });
    }

    /// p^k of a quantity is a form.
    fn equation(&mut self, subject: Subject, (of, k): (Quantity, usize), right: &Form, place: &'static str) {
        let left = Form::own(Combination::of(of, Polynomial::power(k)));
        self.equal(subject, [&left, right], (self.notation.equation(of, k, right), place));
    }

    fn equal(&mut self, subject: Subject, [left, right]: [&Form; 2], shown: (Formula, &'static str)) {
        let rest = self.frame.plain(&left.less(right), &[]);
        self.push(subject, shown, Rest::Form(rest));
    }

    /// The rows of a reduced system that say more than that a variable is the derivative of another.
    fn system(&mut self, subject: Subject, reduced: &Reduced, place: &'static str) {
        let named = self.notation.naming(reduced);
        let rows: Vec<_> = reduced.variables.iter().zip(&reduced.rates).enumerate().collect();
        for (number, (variable, rate)) in rows {
            let left = named.name(variable.name, Vertex::Own, 1);
            let right = named.form(rate);
            if right == Formula::Sum(vec![(Sign::Plus, left.clone())]) {
                continue;
            }
            let of = Combination::of(Quantity::own(Letter::Variable(number)), Polynomial::power(1));
            let rest = self.frame.plain(&Form::own(of).less(rate), &reduced.variables);
            self.push(subject, (Formula::equal(left, right), place), Rest::Form(rest));
        }
    }

    /// Equations of motion, law, and what they make of s.
    fn lower(&mut self, case: &Case<'_>, lower: &Lower, [plant, law, cascade]: [&'static str; 3]) {
        let agents = || case.agents.iter().map(|agent| &case.setup.agents[*agent]);
        let (input, moved) = (lower.input_alone(), lower.moved_by());
        let form = |form: &Form| self.notation.form(form);
        let shown = |left: &Form, right: &Form, place| (Formula::equal(form(left), form(right)), place);
        let equations = [
            (Subject::Controller, [&lower.plant, &moved], shown(&lower.plant, &moved, plant)),
            (Subject::Controller, [&input, &lower.law], shown(&input, &lower.law, law)),
            (Subject::Cascade, [&lower.left, &lower.right], shown(&lower.left, &lower.right, cascade)),
        ];
        let limited = agents().any(|agent| agent.enforce_limits);
        for (number, (subject, sides, shown)) in equations.into_iter().enumerate() {
            // u* of a vehicle is what its thrust and its angular velocity make of the third derivative of x.
            if number == 0 && matches!(case.step, Step::Thrust(..)) {
                self.push(subject, shown, Rest::Missing(Missing::Definition));
            } else if limited && number > 0 {
                self.push(subject, shown, Rest::Missing(Missing::Limited));
            } else {
                self.equal(subject, sides, shown);
            }
        }
    }

    fn adaptation(&mut self, case: &Case<'_>) {
        for (formula, place) in adaptation::of(case, &self.notation) {
            let rest = match (&case.step, place) {
                (Step::Robot { .. } | Step::TaskSpace(_) | Step::TipVelocity(_), "(7)" | "(81)") => Rest::Estimate,
                (Step::TaskSpace(_) | Step::TipVelocity(_), "(82)") => Rest::Kinematic,
                (Step::PositionOnly([_, rate]), "after (a9)") if is_rate_of(&formula, "y") => {
                    let y = Quantity::own(Letter::Filter);
                    let number = |number| Polynomial::number(number);
                    let own = Combination::of(y, &Polynomial::power(1) + &number(rate.clone()));
                    Rest::Form(Form::own(own.plus(Quantity::own(Letter::Error), &number(-rate))))
                }
                (Step::PositionOnly(_), "after (a9)") | (Step::Thrust(..), "(58)") => Rest::Estimate,
                // What w stands for.
                (Step::Thrust(..) | Step::PositionOnly(_), "") => Rest::Missing(Missing::Definition),
                _ => Rest::Missing(Missing::Term),
            };
            self.push(Subject::Controller, (formula, place), rest);
        }
    }
}

fn is_rate_of(formula: &Formula, base: &str) -> bool {
    let Formula::Equal(left, _) = formula else { return false };
    matches!(&**left, Formula::Symbol(symbol) if symbol.base == base)
}

/// Reference dynamics, law, cascade and all reductions of a linear design.
fn linear(case: &Case<'_>, dynamics: &Dynamics, notation: Notation) -> Vec<Identity> {
    let (places, upper) = (Places::of(case, dynamics.order), case.upper(dynamics));
    let mut list = List::new(notation, Frame::of(&upper, case));
    let (z, s) = (Quantity::own(Letter::Reference), Quantity::own(Letter::Error));
    let eta = Quantity::own(Letter::Integral);
    list.equation(Subject::VirtualControl, (s, 0), &dynamics.definition_of_error(), places.error);
    let subject = Subject::ReferenceDynamics;
    match (&case.led, case.smooth()) {
        (_, Some(smooth)) => {
            list.equation(subject, (z, 1), &smooth.realised().right, "");
            list.equation(subject, (eta, 1), &smooth.integral_rate(), "");
        }
        (Led::PureIntegral(_), None) => {
            let integrated = dynamics.integrated();
            list.equation(subject, (z, 1), &integrated.dz, "Remark 2");
            list.equation(subject, (eta, 1), &integrated.d_eta, "");
        }
        (_, None) => list.equation(subject, (z, dynamics.order), &dynamics.right, places.reference),
    }
    if let Some(lower) = case.lower() {
        list.lower(case, &lower, [places.plant, places.law, places.cascade]);
    }
    list.adaptation(case);
    let q = Quantity::own(Letter::Position);
    list.equation(Subject::Cascade, (q, dynamics.total_order()), &dynamics.loop_with_reference(), places.cascade);
    if dynamics.order > 0 {
        reductions(case, (dynamics, &upper), &places, &mut list);
    }
    list.found
}

fn reductions(case: &Case<'_>, (dynamics, upper): (&Dynamics, &Upper), places: &Places, list: &mut List) {
    let subject = Subject::DegreeReduction;
    match case.followed_variables(upper) {
        Some(variables) => {
            if let Some(reduced) = upper.reduced(variables) {
                list.system(subject, &reduced, "");
            }
        }
        None => {
            if let Some(last) = upper.steps(case.aim()).last() {
                list.system(subject, last, places.reduced);
            }
            if let Some(shifted) = upper.shifted() {
                list.system(subject, &shifted, places.reduced);
            }
            if case.has_xi(dynamics)
                && let Some(in_xi) = upper.reduced(case.xi_variables(dynamics))
            {
                list.system(subject, &in_xi, places.in_xi);
            }
        }
    }
    if let Some(filter) = dynamics.filter() {
        list.equation(subject, (Quantity::own(Letter::Reference), dynamics.order), &filter, places.filter);
    }
    // With s, which the printed form leaves out.
    if let Some(from) = case.averages_from()
        && let Some(roots) = case.roots.all_real()
        && let variables = chain(roots, from, case.roots_of_all)
        && upper.laplacian(variables.clone()).is_some()
        && let Some(disturbed) = upper.reduced(variables)
    {
        list.system(Subject::Laplacian, &disturbed, "");
    }
}

/// (46) and its averages: no z, and no s.
fn continuous(case: &Case<'_>, dynamics: &Dynamics, notation: Notation) -> Vec<Identity> {
    let upper = dynamics.upper().undisturbed();
    let frame = Frame {
        // Every derivative of x up to the last has a value.
        plant: upper.order + 1,
        error: Combination::default(),
        followed: None,
        letters: [upper.state, upper.input],
        integrated: None,
    };
    let mut list = List::new(notation, frame);
    let x = Quantity::own(Letter::Position);
    list.equation(Subject::ReferenceDynamics, (x, upper.order), &upper.right, "(46)");
    if let Some(from) = case.averages_from()
        && let Some(roots) = case.roots.all_real()
        && let Some(reduced) = upper.reduced(chain(roots, from, case.roots_of_all))
    {
        list.system(Subject::Laplacian, &reduced, "");
    }
    list.found
}

/// ω, which follows z where there is one.
fn turning(error: Combination) -> Frame {
    Frame { plant: 1, error, followed: None, letters: [Letter::Position, Letter::Error], integrated: None }
}

/// An observer of the leader, and a robot that is led to its estimate.
fn observed(case: &Case<'_>, observer: &Observer, notation: Notation) -> Vec<Identity> {
    let frame = Frame { plant: 2, ..turning(Combination::of(Quantity::own(Letter::Error), Polynomial::one())) };
    let mut list = List::new(notation, frame);
    let (z, places) = (Quantity::own(Letter::Reference), Places::of(case, 1));
    let subject = Subject::ReferenceDynamics;
    list.equation(subject, (Quantity::own(Letter::Observed), 2), &observer.observer(), "");
    list.equation(subject, (z, 0), &observer.reference(), "");
    list.equation(subject, (z, 1), &observer.rate(), "");
    let [left, right] = observer.distance();
    let formula = Formula::equal(list.notation.form(&left), list.notation.form(&right));
    list.equal(Subject::Cascade, [&left, &right], (formula, ""));
    if let Some(lower) = case.lower() {
        list.lower(case, &lower, [places.plant, places.law, ""]);
    }
    list.adaptation(case);
    in_order(list.found)
}

/// A vector on which agents agree with their leader, and a robot that is led by it.
fn agreed(case: &Case<'_>, composite: &Composite, notation: Notation) -> Vec<Identity> {
    let error = Combination::of(Quantity::own(Letter::Error), Polynomial::one());
    let letters = [Letter::Position, Letter::Error];
    let frame = Frame { plant: 2, error, followed: None, letters, integrated: None };
    let mut list = List::new(notation, frame);
    let (z, places) = (Quantity::own(Letter::Reference), Places::of(case, 2));
    list.equation(Subject::ReferenceDynamics, (composite::told(), 1), &composite.agreement(), "");
    list.equation(Subject::ReferenceDynamics, (z, 1), &composite.reference(), "");
    for [left, right] in [composite.cascade(), composite.reduced()] {
        let formula = Formula::equal(list.notation.form(&left), list.notation.form(&right));
        list.equal(Subject::Cascade, [&left, &right], (formula, ""));
    }
    if let Some(lower) = case.lower() {
        list.lower(case, &lower, [places.plant, places.law, ""]);
    }
    list.adaptation(case);
    in_order(list.found)
}

/// (94), (97)–(107).
fn spacecraft(case: &Case<'_>, gains: &[num_rational::BigRational; 2], notation: &Notation) -> Vec<Identity> {
    let frame = turning(Combination::of(Quantity::own(Letter::Error), Polynomial::one()));
    let mut list = List::new(notation.clone(), frame);
    let reference = attitude::reference(gains);
    let z = Quantity::own(Letter::Reference);
    list.equation(Subject::ReferenceDynamics, (z, 1), &reference, "(97)");
    let lower = super::super::lower::attitude(case.outside());
    list.lower(case, &lower, ["(94)", "(99)", "(107), second line"]);
    let (left, right) = attitude::filter();
    let formula = Formula::equal(notation.form(&left), notation.form(&right));
    list.equal(Subject::Controller, [&left, &right], (formula, "(100)"));
    let difference = Quantity::own(Letter::Term(Term::AttitudeDifference));
    list.equation(Subject::Controller, (difference, 1), &attitude::difference_rate(), "(106)");
    let delta = Quantity::own(Letter::Deviation);
    list.equation(Subject::Cascade, (delta, 1), &attitude::error(&reference), "(107), first line");
    in_order(list.found)
}

/// (94) under a filter of the attitude error: no z, and no s.
fn filtered_spacecraft(case: &Case<'_>, k: &num_rational::BigRational, notation: Notation) -> Vec<Identity> {
    // Every derivative of ω has a value of its own.
    let frame = Frame { plant: 2, ..turning(Combination::default()) };
    let mut list = List::new(notation.clone(), frame);
    list.lower(case, &super::super::lower::passivity_filter(case.outside(), k), ["(94)", "", ""]);
    let (left, right) = attitude::filter();
    let formula = Formula::equal(notation.form(&left), notation.form(&right));
    list.equal(Subject::Controller, [&left, &right], (formula, ""));
    let difference = Quantity::own(Letter::Term(Term::AttitudeDifference));
    list.equation(Subject::Controller, (difference, 1), &attitude::error_rate(), "");
    in_order(list.found)
}
