//! A point mass by a model and a high gain, without reference dynamics: the law with its numbers, the errors of its proof, and what V loses.

use num_rational::BigRational;

use super::case::Case;
use super::explanation::{Explained, Section, Subject};
use super::formula::{Formula, Sign, Symbol};

fn symbol(base: &'static str) -> Symbol {
    Symbol::new(base)
}

/// A letter of this derivative, as a plain term.
fn plus(symbol: Symbol) -> (Sign, Formula) {
    (Sign::Plus, symbol.into())
}

/// ẋ + a x = right, for a filter.
fn filter(state: Symbol, rate: &BigRational, right: impl Into<Formula>) -> Formula {
    Formula::equal(Formula::sum([plus(state.clone().derivative(1)), Formula::term(rate, state.into())]), right)
}

/// The explanation of the law, with λ_f.
pub(super) fn explained(case: &Case<'_>, rate: &BigRational) -> Explained {
    let model = case.roots.product();
    let [a0, a1] = [model.coefficient(0), model.coefficient(1)];
    let two = BigRational::from_integer(2.into());
    // p, b, and 1/c.
    let zero = &a0 * &a1 / (&a1 * &a1 + &two * &a0);
    let left = &a1 - &zero;
    let between = &a0 - &zero * &left;
    let desired = |k| Formula::from(symbol("x").below("d").derivative(k));
    let (e, y, eta, phi, phi_0) = (symbol("e"), symbol("y"), symbol("η"), symbol("φ"), symbol("φ").below("0"));
    let estimate = symbol("m").hat();
    let product = |factors: Vec<Symbol>| Formula::product(factors.into_iter().map(Formula::from));
    let mut motion = vec![plus(symbol("u"))];
    if case.is_pushed() {
        motion.push(plus(symbol("f")));
    }
    let driven = product(vec![symbol("m"), symbol("x").derivative(2)]);
    let input = Formula::sum([
        (Sign::Plus, product(vec![estimate.clone(), phi_0.clone()])),
        (Sign::Plus, product(vec![estimate.clone().derivative(1), phi.clone()])),
        Formula::term(&-&a1, eta.clone().into()),
    ]);
    let wanted = Formula::sum([
        (Sign::Plus, desired(2)),
        Formula::term(&a1, desired(1)),
        Formula::term(&-&a0, e.clone().into()),
        Formula::term(&-&a1, y.clone().into()),
    ]);
    let adapted = Formula::minus(product(vec![symbol("γ").above("∗"), e.clone().above("T"), phi.clone()]));
    let controller = Section::new(Subject::Controller)
        .formula(Formula::equal(driven, Formula::sum(motion)), "(a7)")
        .formula(Formula::equal(symbol("u"), input), "")
        .formula(Formula::equal(phi_0.clone(), wanted), "")
        .words("e = x − x_d, which is to vanish as the model has it. No velocity is measured: y stands in for ẋ, and η for m (ẋ − y), which y leaves out. φ is what \
                m̂ is learnt by; its filter has the zero p that makes the model positive real.")
        .system(
            vec![
                filter(y, rate, Formula::term(rate, symbol("x").derivative(1).into()).1),
                filter(eta, rate, symbol("u")),
                filter(phi, &zero, phi_0),
                Formula::equal(estimate.derivative(1), adapted),
            ],
            "",
        );
    let r = symbol("r");
    // What m divides.
    let over_mass = |factors: &[Symbol]| product([&[symbol("m").above("−1")], factors].concat());
    let mut turned = vec![
        Formula::term(&-&zero, r.clone().into()),
        Formula::term(&-&between, e.clone().into()),
        Formula::term(&-&a1, over_mass(&[symbol("δ")])),
    ];
    let mut fading = Vec::new();
    if case.is_pushed() {
        turned.push((Sign::Plus, over_mass(&[symbol("f")])));
        fading.push((Sign::Minus, symbol("f").into()));
    }
    let cascade = Section::new(Subject::Cascade)
        .words("There is no reference velocity, and so no cascade. With δ = η − m (ẋ − y), which vanishes by itself, and r = ė − Δm φ/m + b e the errors obey")
        .system(
            vec![
                Formula::equal(
                    e.clone().derivative(1),
                    Formula::sum([
                        Formula::term(&-&left, e.clone().into()),
                        plus(r.clone()),
                        (Sign::Plus, over_mass(&[symbol("Δm"), symbol("φ")])),
                    ]),
                ),
                Formula::equal(r.clone().derivative(1), Formula::sum(turned)),
                filter(symbol("δ"), rate, Formula::sum(fading)),
            ],
            "",
        );
    let sections = vec![controller, cascade, Section::new(Subject::Convergence).words(super::words::of_s(case))];
    Explained { agents: case.agents.clone(), order: None, degrees: None, sections }
}
