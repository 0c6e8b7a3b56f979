//! Text for people: colours on terminals only, and a pipe that closes early is no error.

use std::fmt;
use std::io::{self, ErrorKind, IsTerminal, Stdout, Write};

use anstream::AutoStream;
use anstyle::{AnsiColor, Style};
use miette::{Diagnostic, MietteHandlerOpts, ReportHandler};

use crate::status::Status;

/// Green, for what holds.
pub(crate) const GOOD: Style = AnsiColor::Green.on_default();
/// Yellow, for what holds in part.
pub(crate) const FAIR: Style = AnsiColor::Yellow.on_default();
/// Red, for what does not hold.
pub(crate) const BAD: Style = AnsiColor::Red.on_default();
/// For headings.
pub(crate) const BOLD: Style = Style::new().bold();
/// For what matters less.
pub(crate) const DIM: Style = Style::new().dimmed();

/// Standard output. Colours are left out unless it is a terminal, and when `NO_COLOR` is set.
pub(crate) struct Console {
    out: AutoStream<Stdout>,
    failure: Option<io::Error>,
}

impl Console {
    pub(crate) fn new() -> Self {
        Console { out: AutoStream::auto(io::stdout()), failure: None }
    }

    /// Writes a line. After a failure nothing more is written: a run goes on although its words are not read.
    pub(crate) fn line(&mut self, text: impl fmt::Display) {
        self.text(format_args!("{text}\n"));
    }

    /// Writes text as it is.
    pub(crate) fn text(&mut self, text: impl fmt::Display) {
        if self.failure.is_none()
            && let Err(error) = write!(self.out, "{text}").and_then(|()| self.out.flush())
        {
            self.failure = Some(error);
        }
    }

    /// The first failure to write, unless the reader simply went away.
    pub(crate) fn finish(self) -> io::Result<()> {
        match self.failure {
            Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
            _ => Ok(()),
        }
    }
}

/// Explains a mistake on standard error.
pub(crate) fn complain(mistake: &dyn Diagnostic) -> Status {
    // Whole lines: programs read them, and terminals wrap them without taking names apart.
    let mut options = MietteHandlerOpts::new().wrap_lines(false);
    if !io::stderr().is_terminal() {
        options = options.color(false);
    }
    let handler = options.build();
    // A closed standard error leaves only the exit status to tell.
    let _ = writeln!(io::stderr(), "{}", Shown { handler: &handler, mistake });
    Status::BadInput
}

/// Says one sentence on standard error.
pub(crate) fn remark(sentence: impl fmt::Display) {
    let _ = writeln!(AutoStream::auto(io::stderr()), "{sentence}");
}

struct Shown<'a> {
    handler: &'a dyn ReportHandler,
    mistake: &'a dyn Diagnostic,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.handler.debug(self.mistake, f)
    }
}

/// An error without a place in a file, with help if there is any.
#[derive(Debug)]
pub(crate) struct Plain<E> {
    error: E,
    help: Option<&'static str>,
}

impl<E> Plain<E> {
    pub(crate) fn new(error: E) -> Self {
        Plain { error, help: None }
    }

    pub(crate) fn with_help(error: E, help: Option<&'static str>) -> Self {
        Plain { error, help }
    }
}

impl<E: fmt::Display> fmt::Display for Plain<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.fmt(f)
    }
}

impl<E: fmt::Debug + fmt::Display> std::error::Error for Plain<E> {}

impl<E: fmt::Debug + fmt::Display> Diagnostic for Plain<E> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }
}
