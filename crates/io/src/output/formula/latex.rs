//! Formulas in LaTeX, with amsmath.

use forwardstep_check::certificate::decimal;
use forwardstep_check::derivation::formula::{At, Formula, Sign, Symbol};

/// A formula as LaTeX, for a display.
pub fn latex(formula: &Formula) -> String {
    match formula {
        Formula::Number(number) => match decimal(number).split_once('/') {
            Some((above, below)) => format!("\\tfrac{{{above}}}{{{below}}}"),
            None => decimal(number),
        },
        Formula::Symbol(symbol) => letter(symbol),
        Formula::Sum(terms) => sum(terms),
        Formula::Product(factors) => {
            factors.iter().map(|factor| vec![latex(factor)]).reduce(beside).unwrap_or_default().concat()
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

/// About how many letters and signs a line of a page has room for.
const LINE: usize = 70;

/// The same in lines that a page has room for: one, or several that begin with a sign, a relation, or a factor where many fill a line.
pub fn latex_lines(formula: &Formula) -> Vec<String> {
    let parts = parts(formula);
    if parts.iter().map(|part| width(part)).sum::<usize>() <= LINE {
        return vec![latex(formula)];
    }
    let mut lines: Vec<String> = Vec::new();
    let mut left = 0;
    for part in parts {
        let width = width(&part);
        match lines.last_mut() {
            Some(line) if width <= left => {
                *line += &part;
                left -= width;
                continue;
            }
            // An empty group, beside which the sign has the room of one between two terms.
            Some(_) => lines.push(format!("{{}}{part}")),
            None => lines.push(part),
        }
        left = LINE.saturating_sub(width);
    }
    lines
}

/// A formula in parts before each of which a line may begin. Brackets that are broken do not grow with what they hold.
fn parts(formula: &Formula) -> Vec<String> {
    match formula {
        Formula::Equal(left, right) => {
            let right = behind(" = ", parts(right));
            parts(left).into_iter().chain(right).collect()
        }
        Formula::Sum(terms) if !terms.is_empty() => {
            let each = terms.iter().enumerate().map(|(k, (sign, term))| behind(operator(k, *sign), parts(term)));
            each.flatten().collect()
        }
        Formula::Bracket(inside) => {
            let mut inside = behind("\\bigl[", parts(inside));
            inside.last_mut().into_iter().for_each(|last| *last += "\\bigr]");
            inside
        }
        Formula::Product(factors) => factors.iter().map(parts).reduce(beside).unwrap_or_default(),
        other => vec![latex(other)],
    }
}

/// Parts with something in front of the first.
fn behind(front: &str, mut parts: Vec<String>) -> Vec<String> {
    parts.first_mut().into_iter().for_each(|first| first.insert_str(0, front));
    parts
}

/// The parts of two factors.
fn beside(mut left: Vec<String>, right: Vec<String>) -> Vec<String> {
    let mut right = right.into_iter();
    if let (Some(last), Some(first)) = (left.last_mut(), right.next()) {
        let beside = if last.ends_with("N}_i}") { " " } else { "\\, " };
        // Many factors take more than one line, too.
        if width(last) + width(&first) > LINE {
            left.push(format!("{beside}{first}"));
        } else {
            *last += beside;
            *last += &first;
        }
    }
    left.extend(right);
    left
}

/// How many letters and signs are seen of what is written in LaTeX.
fn width(text: &str) -> usize {
    let mut letters = text.chars().peekable();
    let mut seen = 0;
    while let Some(letter) = letters.next() {
        match letter {
            '{' | '}' | '^' | '_' | ' ' | '&' => {}
            '\\' => {
                let word = std::iter::from_fn(|| letters.next_if(char::is_ascii_alphabetic)).count();
                seen += usize::from(word > 0);
            }
            _ => seen += 1,
        }
    }
    seen
}

fn list(formulas: &[Formula], between: &str) -> String {
    formulas.iter().map(latex).collect::<Vec<_>>().join(between)
}

fn sum(terms: &[(Sign, Formula)]) -> String {
    let each = terms.iter().enumerate().map(|(k, (sign, term))| format!("{}{}", operator(k, *sign), latex(term)));
    let text: String = each.collect();
    if text.is_empty() { "0".into() } else { text }
}

/// What stands in front of the k-th term of a sum.
fn operator(k: usize, sign: Sign) -> &'static str {
    match (k, sign) {
        (0, Sign::Plus) => "",
        (0, Sign::Minus) => "-",
        (_, Sign::Plus) => " + ",
        (_, Sign::Minus) => " - ",
    }
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
