//! Formulas in MathML, which browsers draw without any script.

use forwardstep_check::certificate::decimal;
use forwardstep_check::derivation::formula::{At, Formula, Sign, Symbol};

/// A formula as an element `math` of its own line. Everything in it is escaped.
pub fn mathml(formula: &Formula) -> String {
    format!("<math display=\"block\">{}</math>", inner(formula))
}

fn inner(formula: &Formula) -> String {
    match formula {
        Formula::Number(number) => match decimal(number).split_once('/') {
            Some((above, below)) => format!("<mfrac><mn>{above}</mn><mn>{below}</mn></mfrac>"),
            None => format!("<mn>{}</mn>", decimal(number)),
        },
        Formula::Symbol(symbol) => letter(symbol),
        Formula::Sum(terms) => sum(terms),
        Formula::Product(factors) => row(&factors.iter().map(inner).collect::<Vec<_>>().join(SPACE)),
        Formula::Bracket(inside) => row(&format!("<mo>[</mo>{}<mo>]</mo>", inner(inside))),
        Formula::Function(name, arguments) => {
            let arguments = arguments.iter().map(inner).collect::<Vec<_>>().join("<mo>,</mo>");
            row(&format!(
                "{}<mo>(</mo>{arguments}<mo>)</mo>",
                if name.base.is_empty() { String::new() } else { letter(name) }
            ))
        }
        Formula::NeighbourSum => "<munder><mo>Σ</mo><mi>j</mi></munder>".into(),
        Formula::Rate(of) => row(&format!("<mfrac><mi>d</mi><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>{}", inner(of))),
        Formula::Equal(left, right) => row(&format!("{}<mo>=</mo>{}", inner(left), inner(right))),
        Formula::Element(one, set) => row(&format!("{}<mo>∈</mo>{}", inner(one), inner(set))),
        Formula::Matrix(rows) => {
            let cell = |cell: &Formula| format!("<mtd>{}</mtd>", inner(cell));
            let rows: String =
                rows.iter().map(|row| format!("<mtr>{}</mtr>", row.iter().map(cell).collect::<String>())).collect();
            row(&format!("<mo>[</mo><mtable>{rows}</mtable><mo>]</mo>"))
        }
    }
}

/// Between factors.
const SPACE: &str = "<mspace width=\"0.17em\"></mspace>";

fn row(inside: &str) -> String {
    format!("<mrow>{inside}</mrow>")
}

fn sum(terms: &[(Sign, Formula)]) -> String {
    let each = terms.iter().enumerate().map(|(k, (sign, term))| match (k, sign) {
        (0, Sign::Plus) => inner(term),
        (_, Sign::Plus) => format!("<mo>+</mo>{}", inner(term)),
        (_, Sign::Minus) => format!("<mo>−</mo>{}", inner(term)),
    });
    let text: String = each.collect();
    if text.is_empty() { "<mn>0</mn>".into() } else { row(&text) }
}

fn letter(symbol: &Symbol) -> String {
    let Symbol { base, hat, derivative, below, above, at } = symbol;
    let over = |text: String, sign: &str| format!("<mover>{text}<mo>{sign}</mo></mover>");
    let mut text = format!("<mi>{}</mi>", escaped(base));
    if *hat {
        text = over(text, "^");
    }
    let mut raised = above.to_string();
    match derivative {
        0 => {}
        1 => text = over(text, "˙"),
        2 => text = over(text, "¨"),
        3 => text = over(text, "…"),
        n => raised = format!("({n}){raised}"),
    }
    let (below, raised) = (format!("<mi>{}</mi>", escaped(below)), format!("<mi>{}</mi>", escaped(&raised)));
    const NONE: &str = "<mi></mi>";
    text = match (below == NONE, raised == NONE) {
        (true, true) => text,
        (false, true) => format!("<msub>{text}{below}</msub>"),
        (true, false) => format!("<msup>{text}{raised}</msup>"),
        (false, false) => format!("<msubsup>{text}{below}{raised}</msubsup>"),
    };
    let late = "<mi>t</mi><mo>−</mo><msub><mi>T</mi><mi>ij</mi></msub>";
    match at {
        At::Now => text,
        At::Time => row(&format!("{text}<mo>(</mo><mi>t</mi><mo>)</mo>")),
        At::Late => row(&format!("{text}<mo>(</mo>{late}<mo>)</mo>")),
        At::VaryingLate => row(&format!("{text}<mo>(</mo>{late}<mo>(</mo><mi>t</mi><mo>)</mo><mo>)</mo>")),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
