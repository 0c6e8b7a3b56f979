//! The equations of every scenario, as pages and LaTeX documents have them.

use forwardstep_check::derivation::{Line, explain};
use forwardstep_io::output::formula::{latex, latex_lines, mathml};
use forwardstep_io::scenario::{SHIPPED_SCENARIOS, open_scenario};

/// How many children an element has; `None` for any number of them, and for text alone.
fn children(name: &str) -> Option<usize> {
    match name {
        "mover" | "munder" | "msub" | "msup" | "mfrac" => Some(2),
        "msubsup" => Some(3),
        "mspace" => Some(0),
        "math" | "mrow" | "mtable" | "mtr" | "mtd" | "mi" | "mn" | "mo" => None,
        other => panic!("<{other}> is not used here"),
    }
}

/// Every element has the children that MathML Core gives it, and letters, numbers and signs hold text.
fn assert_is_mathml(page: &str) {
    let document = roxmltree::Document::parse(page).unwrap_or_else(|error| panic!("{error}: {page}"));
    for element in document.descendants().filter(roxmltree::Node::is_element) {
        let (name, inside) = (element.tag_name().name(), element.children().filter(roxmltree::Node::is_element));
        let within = element.parent().map_or("", |parent| parent.tag_name().name());
        let (count, text) = (inside.count(), element.text().unwrap_or_default());
        assert!(children(name).is_none_or(|needed| needed == count), "<{name}> has {count} children: {page}");
        match name {
            "mi" | "mn" | "mo" => assert!(count == 0 && !text.is_empty(), "<{name}> without text: {page}"),
            "mtr" => assert_eq!(within, "mtable"),
            "mtd" => assert_eq!(within, "mtr"),
            "math" => assert_eq!(within, ""),
            _ => assert_eq!(text, "", "text belongs to letters: {page}"),
        }
    }
}

/// Braces and environments are balanced, and nothing is left that LaTeX takes for a command or knows no letter for.
fn assert_is_latex(text: &str) {
    let mut depth = 0_i32;
    for letter in text.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        assert!(depth >= 0 && letter.is_ascii() && !"%#$~\"".contains(letter), "{letter}: {text}");
    }
    assert!(depth == 0 && text.matches("\\left").count() == text.matches("\\right").count(), "{text}");
    assert!(!text.contains('&') || text.contains("bmatrix"), "{text}");
}

#[test]
fn every_formula_of_every_shipped_scenario_is_mathml_and_latex() {
    for scenario in SHIPPED_SCENARIOS {
        let setup = open_scenario(scenario.name).unwrap().setup;
        let sections = explain(&setup).designs.into_iter().flat_map(|design| design.sections);
        for line in sections.flat_map(|section| section.lines) {
            if let Line::Formula(formula, _) = line {
                assert_is_mathml(&mathml(&formula));
                assert_is_latex(&latex(&formula));
                let lines = latex_lines(&formula);
                // Lines are those of the whole, and begin where a term does.
                let whole =
                    |text: &str| text.replace("{}", "").replace("\\bigl", "\\left").replace("\\bigr", "\\right");
                assert_eq!(whole(&lines.concat()), latex(&formula));
                for line in lines.iter().skip(1) {
                    assert!([" + ", " - ", " = ", "\\, "].iter().any(|sign| line[2..].starts_with(sign)), "{line}");
                }
            }
        }
    }
}
