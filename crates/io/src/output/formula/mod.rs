//! Formulas as text: in a terminal, in LaTeX and in MathML, from one tree.

mod latex;
mod mathml;
mod unicode;

pub use latex::{latex, latex_lines};
pub use mathml::mathml;
pub use unicode::unicode;

#[cfg(test)]
mod tests {
    use forwardstep_check::derivation::formula::{At, Formula, Sign, Symbol};
    use num_rational::BigRational;

    use super::*;

    fn number(p: i64, q: i64) -> Formula {
        Formula::Number(BigRational::new(p.into(), q.into()))
    }

    /// q̈_i = −2.5 q̇_i − Σ_j w_ij(t) [ξ_i − ξ_j(t − T_ij(t))] + ṡ*_i
    fn example() -> Formula {
        let symbol = |base: &'static str, below: &'static str| Symbol::new(base).below(below);
        let inside = Formula::sum([
            (Sign::Plus, symbol("ξ", "i").into()),
            (Sign::Minus, symbol("ξ", "j").at(At::VaryingLate).into()),
        ]);
        let weight = symbol("w", "ij").at(At::Time).into();
        let network = Formula::product([Formula::NeighbourSum, weight, Formula::bracket(inside)]);
        let right = Formula::sum([
            (Sign::Minus, Formula::product([number(5, 2), symbol("q", "i").derivative(1).into()])),
            (Sign::Minus, network),
            (Sign::Plus, symbol("s", "i").above("∗").derivative(1).into()),
        ]);
        Formula::equal(symbol("q", "i").derivative(2), right)
    }

    #[test]
    fn one_formula_is_written_in_three_ways() {
        assert_eq!(
            unicode(&example()),
            "q\u{308}_i = −2.5 q\u{307}_i − Σ_j w_ij(t) [ξ_i − ξ_j(t − T_ij(t))] + s\u{307}*_i"
        );
        assert_eq!(
            latex(&example()),
            "\\ddot{q}_{i} = -2.5\\, \\dot{q}_{i} - \\Sigma_{j\\in\\mathcal{N}_i} w_{ij}(t)\\, \\left[\\xi_{i} - \\xi_{j}(t - T_{ij}(t))\\right] \
             + \\dot{s}^{*}_{i}"
        );
        assert_eq!(
            mathml(&Formula::equal(Symbol::new("ϑ").hat().derivative(1), number(1, 3))),
            "<math display=\"block\"><mrow><mover><mover><mi>ϑ</mi><mo>^</mo></mover><mo>˙</mo></mover><mo>=</mo>\
             <mfrac><mn>1</mn><mn>3</mn></mfrac></mrow></math>"
        );
        let page = mathml(&example());
        let opened = page.matches('<').count() - 2 * page.matches("</").count();
        assert_eq!(opened, 0, "every element is closed: {page}");
    }

    #[test]
    fn nothing_of_a_symbol_escapes_into_the_page() {
        let page = mathml(&Symbol::new("q").below("<b>&").into());
        assert!(page.contains("<mi>&lt;b&gt;&amp;</mi>"), "{page}");
    }

    #[test]
    fn sums_without_terms_are_zero_and_high_derivatives_are_counted() {
        assert_eq!(unicode(&Formula::Sum(Vec::new())), "0");
        let fifth = Symbol::new("z").below("i").derivative(5);
        assert_eq!(unicode(&fifth.clone().into()), "z^(5)_i");
        assert_eq!(latex(&fifth.into()), "z^{(5)}_{i}");
        // A combining mark would stand beside the letter, not above it.
        let third = Symbol::new("z").derivative(3);
        assert_eq!(mathml(&third.into()), "<math display=\"block\"><mover><mi>z</mi><mo>…</mo></mover></math>");
        let inverse = Symbol::new("q").below("z").above("−1");
        assert_eq!([unicode(&inverse.clone().into()), latex(&inverse.into())], ["q⁻¹_z", "q^{-1}_{z}"]);
        let rows = vec![vec![number(1, 1), number(0, 1)], vec![number(0, 1), number(1, 2)]];
        assert_eq!(unicode(&Formula::Matrix(rows.clone())), "[1, 0; 0, 1/2]".replace("1/2", "0.5"));
        assert_eq!(latex(&Formula::Matrix(rows)), "\\begin{bmatrix}1 & 0 \\\\ 0 & 0.5\\end{bmatrix}");
    }
}
