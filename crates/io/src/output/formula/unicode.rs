//! Formulas in a terminal.

use forwardstep_check::certificate::decimal;
use forwardstep_check::derivation::formula::{At, Formula, Sign, Symbol};
use forwardstep_core::signal::superscript;

/// A formula as one line.
pub fn unicode(formula: &Formula) -> String {
    match formula {
        Formula::Number(number) => decimal(number),
        Formula::Symbol(symbol) => letter(symbol),
        Formula::Sum(terms) => sum(terms),
        Formula::Product(factors) => product(factors),
        Formula::Bracket(inside) => format!("[{}]", unicode(inside)),
        Formula::Function(name, arguments) => format!("{}({})", letter(name), list(arguments)),
        Formula::NeighbourSum => "Σ_j".into(),
        Formula::Rate(of) => format!("d/dt {}", unicode(of)),
        Formula::Equal(left, right) => format!("{} = {}", unicode(left), unicode(right)),
        Formula::Element(one, set) => format!("{} ∈ {}", unicode(one), unicode(set)),
        Formula::Matrix(rows) => {
            let rows: Vec<String> = rows.iter().map(|row| list(row)).collect();
            format!("[{}]", rows.join("; "))
        }
    }
}

fn list(formulas: &[Formula]) -> String {
    formulas.iter().map(unicode).collect::<Vec<_>>().join(", ")
}

fn sum(terms: &[(Sign, Formula)]) -> String {
    let each = terms.iter().enumerate().map(|(k, (sign, term))| match (k, sign) {
        (0, Sign::Plus) => unicode(term),
        (0, Sign::Minus) => format!("−{}", unicode(term)),
        (_, Sign::Plus) => format!(" + {}", unicode(term)),
        (_, Sign::Minus) => format!(" − {}", unicode(term)),
    });
    let text: String = each.collect();
    if text.is_empty() { "0".into() } else { text }
}

/// Factors with a space between them, but for brackets behind each other.
fn product(factors: &[Formula]) -> String {
    let mut text = String::new();
    for factor in factors {
        let factor = unicode(factor);
        let close = text.ends_with(')') && factor.starts_with('(');
        if !text.is_empty() && !close {
            text.push(' ');
        }
        // A fraction in front of others would read as a division by all of them.
        text += &if factor.contains('/') && factors.len() > 1 { format!("({factor})") } else { factor };
    }
    text
}

fn letter(symbol: &Symbol) -> String {
    let Symbol { base, hat, derivative, below, above, at } = symbol;
    let mut text = String::from(*base);
    if *hat {
        text.push('\u{302}');
    }
    match (derivative, hat) {
        (0, _) => {}
        (n, true) => text.extend(std::iter::repeat_n('′', *n)),
        (1, false) => text.push('\u{307}'),
        (2, false) => text.push('\u{308}'),
        (3, false) => text.push('\u{20db}'),
        (n, false) => text += &format!("^({n})"),
    }
    text += &raised(above);
    if !below.is_empty() {
        text += &format!("_{below}");
    }
    text += match at {
        At::Now => "",
        At::Time => "(t)",
        At::Late => "(t − T_ij)",
        At::VaryingLate => "(t − T_ij(t))",
    };
    text
}

fn raised(above: &str) -> String {
    let text = superscript(above.replace('∗', "*").replace('−', "-").replace('T', "ᵀ"));
    if above.chars().any(|c| c.is_alphabetic() && c != 'T') { format!("^{text}") } else { text }
}
