//! Mistakes on the command line whose next step the parser does not know.

use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use forwardstep_io::for_shell;
use forwardstep_io::scenario::{nearest_here, shipped_scenario};
use forwardstep_io::shown;

/// The same mistake, with what to type instead where that can be told.
pub(crate) fn with_tips(mut error: clap::Error) -> clap::Error {
    let tip = match error.kind() {
        ErrorKind::InvalidSubcommand => match error.get(ContextKind::InvalidSubcommand) {
            Some(ContextValue::String(word)) => runs(word),
            _ => None,
        },
        // Options that are spelt alike are the better tip.
        ErrorKind::UnknownArgument if error.get(ContextKind::SuggestedArg).is_none() => {
            match error.get(ContextKind::InvalidArg) {
                Some(ContextValue::String(word)) => tip_for_unknown(word),
                _ => None,
            }
        }
        ErrorKind::TooFewValues if is_of_runs(&error) => {
            Some("name two runs or scenarios at least; `forwardstep report RUN` makes the page of one".to_owned())
        }
        ErrorKind::InvalidUtf8 => Some(
            "names of files are given in Unicode; go into the folder (`cd`) whose name is none, or rename the file"
                .to_owned(),
        ),
        _ => None,
    };
    if let Some(tip) = tip {
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// The tip for an option that does not exist.
fn tip_for_unknown(word: &str) -> Option<String> {
    match word.strip_prefix("--") {
        Some("slide" | "slides" | "animation" | "film" | "png" | "svg") => {
            Some("the page of a run or a comparison has buttons for slides, pictures and films".to_owned())
        }
        Some(name) => nearest_here(name),
        None if word.parse::<f64>().is_ok() => Some("no number here is negative".to_owned()),
        None => is_scenario(word).then(|| {
            "one scenario or run at a time; `forwardstep compare A B` sets several side by side, and a loop of the shell takes one after the other"
                .to_owned()
        }),
    }
}

/// Whether runs or scenarios are what there are too few of.
fn is_of_runs(error: &clap::Error) -> bool {
    matches!(error.get(ContextKind::InvalidArg), Some(ContextValue::String(what)) if what.contains("RUN|SCENARIO"))
}

fn is_scenario(word: &str) -> bool {
    let path = Path::new(word);
    shipped_scenario(word).is_some() || path.extension().is_some_and(|end| end == "toml") || path.is_dir()
}

/// What to type for a scenario without a command.
fn runs(word: &str) -> Option<String> {
    let pasted = for_shell(&shown(word).to_string());
    is_scenario(word)
        .then(|| format!("a scenario needs a command: `forwardstep run {pasted}`, or `forwardstep check {pasted}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_wishes_and_negative_numbers_among_options_are_answered() {
        for (word, part) in [
            ("--obstacles", "ends a run where a joint leaves the position limits"),
            ("--floating-base", "`robot.vehicle`"),
            ("--slide", "buttons for slides"),
            ("-1", "negative"),
            ("own.toml", "compare A B"),
        ] {
            assert!(tip_for_unknown(word).is_some_and(|tip| tip.contains(part)), "{word}: {:?}", tip_for_unknown(word));
        }
        assert_eq!(tip_for_unknown("--agnets"), None);
    }
}
