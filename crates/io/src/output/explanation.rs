//! Why a run converges, as text, LaTeX, JSON and part of the report.

use forwardstep_check::derivation::{Explained, Explanation, Line, Subject};
use forwardstep_check::{Footing, Ground};
use forwardstep_sim::Setup;
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

use super::formula::{latex, latex_lines, mathml, unicode};
use super::names;
use super::text::prose;
use crate::scenario::Scenario;

/// The format of the JSON document; it grows when fields change their meaning or vanish, not when some are added.
pub const EXPLANATION_FORMAT: u32 = 1;

/// The heading of hypotheses that do not hold.
const LACKS: &str = "What it lacks";
/// What they mean for what is derived.
const LACKING: &str = "These hypotheses do not hold here. What follows is derived as if they did, and need not be so.";
/// The heading of what would break a hypothesis.
const BREAKS: &str = "What would break it";

/// A piece of an explanation in words, for a terminal.
#[derive(Clone, Debug, PartialEq)]
pub enum TextLine {
    /// The agents of a design.
    Agents(String),
    /// The heading of a section.
    Heading(&'static str),
    /// Sentences.
    Words(String),
    /// A formula, with its place in the paper.
    Formula(String, &'static str),
}

/// An explanation line by line.
pub fn explanation_lines(setup: &Setup, explanation: &Explanation, footing: &Footing) -> Vec<TextLine> {
    let mut lines = Vec::new();
    if !footing.lacks.is_empty() {
        lines.push(TextLine::Agents(LACKS.into()));
        lines.push(TextLine::Words(LACKING.into()));
        lines.extend(footing.lacks.iter().map(|one| TextLine::Words(in_a_line(one))));
    }
    for design in &explanation.designs {
        lines.push(TextLine::Agents(names::some_names(setup, &design.agents)));
        for section in &design.sections {
            lines.push(TextLine::Heading(heading(section.subject, footing)));
            lines.extend(section.lines.iter().map(|line| match line {
                Line::Words(words) => TextLine::Words(words.clone()),
                Line::Formula(formula, place) => TextLine::Formula(unicode(formula), place),
            }));
        }
    }
    if !footing.breaks.is_empty() {
        lines.push(TextLine::Agents(BREAKS.into()));
        lines.extend(footing.breaks.iter().map(|one| TextLine::Words(in_a_line(one))));
    }
    lines
}

/// The heading of a section; what does not follow is not said to converge.
fn heading(subject: Subject, footing: &Footing) -> &'static str {
    match subject {
        Subject::Convergence if !footing.lacks.is_empty() => "Why it would converge",
        _ => subject.heading(),
    }
}

fn in_a_line(one: &Ground) -> String {
    format!("{}: {}", one.id.name(), one.words)
}

/// An explanation in LaTeX: a section of equations for each design, with the words as comments. It needs amsmath.
pub fn explanation_latex(setup: &Setup, explanation: &Explanation, footing: &Footing) -> String {
    let mut text = String::from("% needs \\usepackage{amsmath}\n");
    if !footing.lacks.is_empty() {
        text += &format!("\n\\subsection*{{{LACKS}}}\n{}", comment(LACKING));
        text.extend(footing.lacks.iter().map(|one| comment(&in_a_line(one))));
    }
    for design in &explanation.designs {
        text += &format!("\n{}", comment(&names::some_names(setup, &design.agents)));
        for section in &design.sections {
            text += &format!("\\subsection*{{{}}}\n", heading(section.subject, footing));
            for line in &section.lines {
                match line {
                    Line::Words(words) => text += &comment(words),
                    Line::Formula(formula, place) => {
                        let lines = latex_lines(formula);
                        let kind = if lines.len() > 1 { "multline*" } else { "equation*" };
                        let lines = lines.join(" \\\\\n  ");
                        text += &format!("\\begin{{{kind}}}\n  {lines}{}\n\\end{{{kind}}}\n", tag(place));
                    }
                }
            }
        }
    }
    if !footing.breaks.is_empty() {
        text += &format!("\n\\subsection*{{{BREAKS}}}\n");
        text.extend(footing.breaks.iter().map(|one| comment(&in_a_line(one))));
    }
    text
}

/// A line of a LaTeX file that is not read. Names may hold what ends a line.
fn comment(words: &str) -> String {
    let one_line: String = words.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("% {one_line}\n")
}

/// The place in the paper as a tag.
fn tag(place: &str) -> String {
    let words =
        place.replace("ϑ\u{302}", "$\\hat{\\vartheta}$").replace('ϑ', "$\\vartheta$").replace('φ', "$\\varphi$");
    if place.is_empty() { String::new() } else { format!(" \\tag*{{{words}}}") }
}

/// An explanation as JSON.
pub fn explanation_document(scenario: &Scenario, version: &str, explanation: &Explanation, footing: &Footing) -> Value {
    let line = |line: &Line| match line {
        Line::Words(words) => json!({ "words": words }),
        Line::Formula(formula, place) => {
            json!({ "unicode": unicode(formula), "latex": latex(formula), "paper": place })
        }
    };
    let design = |design: &Explained| {
        let sections: Vec<Value> = (design.sections.iter())
            .map(|section| {
                let lines: Vec<Value> = section.lines.iter().map(line).collect();
                json!({ "subject": section.subject.name(), "lines": lines })
            })
            .collect();
        let names: Vec<String> = design.agents.iter().map(|agent| names::agent_name(&scenario.setup, *agent)).collect();
        json!({
            "agents": names,
            "order": design.order,
            "degree": design.degrees.map(|[before, _]| before),
            "reduced_degree": design.degrees.map(|[_, after]| after),
            "sections": sections,
        })
    };
    let designs: Vec<Value> = explanation.designs.iter().map(design).collect();
    let checked = json!({ "name": scenario.name, "title": scenario.title });
    let grounds = |all: &[Ground]| -> Vec<Value> {
        all.iter().map(|one| json!({ "id": one.id.name(), "words": one.words })).collect()
    };
    json!({
        "format": EXPLANATION_FORMAT, "version": version, "scenario": checked, "lacks": grounds(&footing.lacks), "designs": designs,
        "breaks": grounds(&footing.breaks),
    })
}

/// An explanation as a section of the report.
pub(crate) fn explanation_markup(setup: &Setup, explanation: &Explanation, footing: &Footing) -> Markup {
    html! {
        section #why {
            h2 { @if footing.lacks.is_empty() { "Why it works" } @else { "Why it would work" } }
            @if !footing.lacks.is_empty() {
                div.card {
                    h3 { (LACKS) }
                    p { (LACKING) }
                    @for one in &footing.lacks {
                        p { code { (one.id.name()) } " " (prose(&one.words)) }
                    }
                }
            }
            @for design in &explanation.designs {
                details.card open[explanation.designs.len() == 1] {
                    summary { strong { (names::some_names(setup, &design.agents)) } @if let Some([before, after]) = design.degrees {
                        span.by { "a cascade of degree " (before) ", reduced to " (after) }
                    } }
                    @for part in &design.sections {
                        h3 { (heading(part.subject, footing)) }
                        @for line in &part.lines {
                            @match line {
                                Line::Words(words) => p { (prose(words)) },
                                Line::Formula(formula, place) => div.formula {
                                    (PreEscaped(mathml(formula)))
                                    @if !place.is_empty() { span.place { (place) } }
                                },
                            }
                        }
                    }
                }
            }
            @if !footing.breaks.is_empty() {
                div.card {
                    h3 { (BREAKS) span.by { "for the hypotheses that hold" @if !footing.lacks.is_empty() { "; the others are listed under " em { (LACKS) } } } }
                    @for one in &footing.breaks {
                        p { code { (one.id.name()) } " " (prose(&one.words)) }
                    }
                }
            }
        }
    }
}
