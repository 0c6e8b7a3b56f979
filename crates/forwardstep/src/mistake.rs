//! Mistakes as they are told on standard error.

use std::borrow::Cow;
use std::fmt;

use forwardstep::io::one_line;
use miette::Diagnostic;

/// A mistake whose words are one line without colours, whatever they repeat of others: what a reader's own errors escape already, those of other
/// libraries do not.
#[derive(Debug)]
pub(crate) struct Told<'a>(pub(crate) &'a dyn Diagnostic);

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(self.0))
    }
}

impl std::error::Error for Told<'_> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.source()
    }
}

impl Diagnostic for Told<'_> {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.code()
    }

    fn severity(&self) -> Option<miette::Severity> {
        self.0.severity()
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.help().map(|help| Box::new(one_line(help)) as Box<dyn fmt::Display>)
    }

    fn url<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.url()
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.0.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        self.0.labels()
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        self.0.related()
    }

    fn diagnostic_source(&self) -> Option<&dyn Diagnostic> {
        self.0.diagnostic_source()
    }
}

/// An error without a place in a file, with help if there is any.
#[derive(Debug)]
pub(crate) struct Plain<E> {
    error: E,
    help: Option<Cow<'static, str>>,
}

impl<E> Plain<E> {
    pub(crate) fn new(error: E) -> Self {
        Plain { error, help: None }
    }

    pub(crate) fn with_help(error: E, help: Option<impl Into<Cow<'static, str>>>) -> Self {
        Plain { error, help: help.map(Into::into) }
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
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }
}
