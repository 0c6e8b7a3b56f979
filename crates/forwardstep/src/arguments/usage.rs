//! Mistakes on the command line whose next step the parser does not know.

use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use forwardstep_io::for_shell;
use forwardstep_io::scenario::{beyond, shipped_scenario};
use forwardstep_io::shown;

/// The same mistake, with what to type instead where that can be told.
pub(crate) fn with_tips(mut error: clap::Error) -> clap::Error {
    let tip = match error.kind() {
        ErrorKind::InvalidSubcommand => match error.get(ContextKind::InvalidSubcommand) {
            Some(ContextValue::String(word)) => runs(word),
            _ => None,
        },
        // That it could be the value of another argument is no help where there is none, or for what that would refuse.
        ErrorKind::UnknownArgument => match error.get(ContextKind::InvalidArg) {
            Some(ContextValue::String(word)) => wished(word),
            _ => None,
        },
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

/// What is so here instead of an option that there is not.
fn wished(word: &str) -> Option<String> {
    let plain = word.trim_start_matches('-');
    if plain.starts_with(|first: char| first.is_ascii_digit()) {
        return Some("no number here is negative".to_owned());
    }
    beyond(plain)
}

/// What to type for a scenario without a command.
fn runs(word: &str) -> Option<String> {
    let path = Path::new(word);
    let is_scenario =
        shipped_scenario(word).is_some() || path.extension().is_some_and(|end| end == "toml") || path.is_dir();
    let pasted = for_shell(&shown(word).to_string());
    is_scenario
        .then(|| format!("a scenario needs a command: `forwardstep run {pasted}`, or `forwardstep check {pasted}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_wishes_and_negative_numbers_among_options_are_answered() {
        for (word, part) in [
            ("--obstacles", "joints keep to the position limits"),
            ("--floating-base", "`robot.vehicle`"),
            ("-1", "negative"),
        ] {
            assert!(wished(word).is_some_and(|tip| tip.contains(part)), "{word}: {:?}", wished(word));
        }
        assert_eq!(wished("--agnets"), None);
    }
}
