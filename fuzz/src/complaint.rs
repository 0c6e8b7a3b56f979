//! What the program says about a file that it refuses.

use std::sync::OnceLock;

use miette::{Diagnostic, MietteHandler, MietteHandlerOpts, ReportHandler};

/// A message is no longer than this, in bytes, and all that is shown with it no longer than four times that.
const LONGEST: usize = 2_200;
/// Of one file no more mistakes are told at once.
const MOST: usize = 32;

/// The error as the program shows it, after looking at all its parts.
pub fn complaint(error: &dyn Diagnostic) -> String {
    one_line(&error.to_string());
    if let Some(help) = error.help() {
        let help = help.to_string();
        assert!(!help.trim().is_empty(), "an empty help for {error}");
        assert!(help.len() <= 4 * LONGEST, "{} bytes of help for {error}", help.len());
    }
    let labels: Vec<_> = error.labels().into_iter().flatten().collect();
    for label in &labels {
        let source = error.source_code().expect("a place has a text");
        if let Err(reason) = source.read_span(label.inner(), 0, 0) {
            panic!("{label:?} of {error} is not in the text: {reason}");
        }
    }
    static HANDLER: OnceLock<MietteHandler> = OnceLock::new();
    let handler = HANDLER.get_or_init(|| MietteHandlerOpts::new().wrap_lines(false).color(false).build());
    let shown = Shown { handler, error }.to_string();
    // Other mistakes of the same file are told with it, each no longer than if it stood alone.
    let others: Vec<String> = error.related().into_iter().flatten().map(complaint).collect();
    assert!(others.len() < MOST, "{} mistakes are told", others.len() + 1);
    let own = shown.len() - others.iter().map(String::len).sum::<usize>().min(shown.len());
    assert!(own <= 4 * LONGEST, "{own} bytes are shown for {error}");
    let steers =
        |c: char| c.is_control() && c != '\n' || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    assert!(!shown.contains(steers), "steers the terminal: {shown:?}");
    shown
}

/// Fails unless a message is one line that can be printed.
pub fn one_line(message: &str) {
    assert!(!message.is_empty() && !message.contains(char::is_control), "not one line: {message:?}");
    assert!(message.len() <= LONGEST, "{} bytes: {message}", message.len());
}

struct Shown<'a> {
    handler: &'a dyn ReportHandler,
    error: &'a dyn Diagnostic,
}

impl std::fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.handler.debug(self.error, f)
    }
}
