//! Mistakes on the command line whose next step the parser does not know.

use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use forwardstep_io::for_shell;
use forwardstep_io::scenario::shipped_scenario;
use forwardstep_io::shown;

/// The same mistake, with what to type instead where that can be told.
pub(crate) fn with_tips(mut error: clap::Error) -> clap::Error {
    let tip = match error.kind() {
        ErrorKind::InvalidSubcommand => match error.get(ContextKind::InvalidSubcommand) {
            Some(ContextValue::String(word)) => runs(word),
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

/// What to type for a scenario without a command.
fn runs(word: &str) -> Option<String> {
    let path = Path::new(word);
    let is_scenario =
        shipped_scenario(word).is_some() || path.extension().is_some_and(|end| end == "toml") || path.is_dir();
    let pasted = for_shell(&shown(word).to_string());
    is_scenario
        .then(|| format!("a scenario needs a command: `forwardstep run {pasted}`, or `forwardstep check {pasted}`"))
}
