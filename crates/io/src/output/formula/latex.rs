//! Formulas in LaTeX, with amsmath.

use forwardstep_check::certificate::decimal;
use forwardstep_check::derivation::formula::{At, Formula, Sign, Symbol};

/// A formula as LaTeX, for a display.
pub(crate) fn latex(formula: &Formula) -> String {
    match formula {
        Formula::Number(number) => match decimal(number).split_once('/') {
            Some((above, below)) => format!("\\tfrac{{{above}}}{{{below}}}"),
            None => decimal(number),
        },
        Formula::Symbol(symbol) => letter(symbol),
        Formula::Sum(terms) => sum(terms),
        Formula::Product(factors) => {
            factors.iter().map(latex).collect::<Vec<_>>().join("\\, ").replace("N}_i}\\, ", "N}_i} ")
        }
        Formula::Bracket(inside) => format!("\\left[{}\\right]", latex(inside)),
        Formula::Function(name, arguments) => format!("{}\\left({}\\right)", letter(name), list(arguments, ", ")),
        Formula::NeighbourSum => "\\Sigma_{j\\in\\mathcal{N}_i}".into(),
        Formula::Rate(of) => format!("\\frac{{d}}{{dt}} {}", latex(of)),
        Formula::Equal(left, right) => format!("{} = {}", latex(left), latex(right)),
        Formula::Element(one, set) => format!("{} \\in {}", latex(one), latex(set)),
        Formula::Matrix(rows) => {
            let rows: Vec<String> = rows.iter().map(|row| list(row, " & ")).collect();
            format!("\\begin{{bmatrix}}{}\\end{{bmatrix}}", rows.join(" \\\\ "))
        }
    }
}

fn list(formulas: &[Formula], between: &str) -> String {
    formulas.iter().map(latex).collect::<Vec<_>>().join(between)
}

fn sum(terms: &[(Sign, Formula)]) -> String {
    let each = terms.iter().enumerate().map(|(k, (sign, term))| match (k, sign) {
        (0, Sign::Plus) => latex(term),
        (0, Sign::Minus) => format!("-{}", latex(term)),
        (_, Sign::Plus) => format!(" + {}", latex(term)),
        (_, Sign::Minus) => format!(" - {}", latex(term)),
    });
    let text: String = each.collect();
    if text.is_empty() { "0".into() } else { text }
}

fn letter(symbol: &Symbol) -> String {
    let Symbol { base, hat, derivative, below, above, at } = symbol;
    let mut text = command(base);
    if *hat {
        text = format!("\\hat{{{text}}}");
    }
    let mut raised = above.replace('∗', "*").replace('−', "-");
    match derivative {
        0 => {}
        1 => text = format!("\\dot{{{text}}}"),
        2 => text = format!("\\ddot{{{text}}}"),
        3 => text = format!("\\dddot{{{text}}}"),
        n => raised = format!("({n}){raised}"),
    }
    if !raised.is_empty() {
        text += &format!("^{{{raised}}}");
    }
    if !below.is_empty() {
        text += &format!("_{{{below}}}");
    }
    text += match at {
        At::Now => "",
        At::Time => "(t)",
        At::Late => "(t - T_{ij})",
        At::VaryingLate => "(t - T_{ij}(t))",
    };
    text
}

/// The commands of Greek letters and of words; other letters stand for themselves.
fn command(base: &str) -> String {
    let mut text = String::new();
    if base.chars().count() > 2 {
        return format!("\\mathrm{{{base}}}");
    }
    for letter in base.chars() {
        let command = match letter {
            'α' => "\\alpha",
            'β' => "\\beta",
            'γ' => "\\gamma",
            'Γ' => "\\Gamma",
            'Π' => "\\Pi",
            'δ' => "\\delta",
            'ε' => "\\varepsilon",
            'Δ' => "\\Delta ",
            'ζ' => "\\zeta",
            'η' => "\\eta",
            'θ' => "\\theta",
            'ϑ' => "\\vartheta",
            'κ' => "\\kappa",
            'λ' => "\\lambda",
            'Λ' => "\\Lambda",
            'μ' => "\\mu",
            'ξ' => "\\xi",
            'ρ' => "\\rho",
            'σ' => "\\sigma",
            'ς' => "\\varsigma",
            'τ' => "\\tau",
            'φ' => "\\varphi",
            'χ' => "\\chi",
            'ψ' => "\\psi",
            'Ψ' => "\\Psi",
            '𝒵' => "\\mathcal{Z}",
            '𝓕' => "\\mathcal{F}",
            'ω' => "\\omega",
            '′' => "'",
            other => {
                text.push(other);
                continue;
            }
        };
        text += command;
    }
    text
}
