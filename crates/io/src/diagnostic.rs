//! Where in a file something is wrong, and what to do about it.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// A file's name and text, shared by all that is said about it.
#[derive(Clone, Debug)]
pub struct SourceText {
    named: Arc<NamedSource<String>>,
}

impl SourceText {
    /// Keeps `text` under `name`, the path as the user wrote it.
    pub fn new(name: impl AsRef<str>, text: impl Into<String>) -> Self {
        SourceText { named: Arc::new(NamedSource::new(name, text.into())) }
    }

    /// The file's name.
    pub fn name(&self) -> &str {
        self.named.name()
    }

    /// The file's text.
    pub fn text(&self) -> &str {
        self.named.inner()
    }

    /// Line and column, both from one, of a byte offset; columns count characters.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let text = self.text();
        let mut end = offset.min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &text[..end];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// What is wrong, as a typed value; every reader of this crate has its own.
pub trait Problem: std::error::Error + Send + Sync + 'static {
    /// What the user can do about it: what was allowed, the nearest match.
    fn help(&self) -> Option<String>;
}

/// A problem at a place in a file: one readable error with file, line, column, value, what was allowed and a near match.
#[derive(Clone, Debug)]
pub struct InputError<P> {
    /// The file.
    pub source: SourceText,
    /// Bytes of the file the problem is about; `None` when it is about the file as a whole.
    pub span: Option<Range<usize>>,
    /// What is wrong.
    pub problem: P,
}

impl<P: Problem> fmt::Display for InputError<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.span {
            Some(span) => {
                let (line, column) = self.source.line_column(span.start);
                write!(f, "{}:{line}:{column}: {}", self.source.name(), self.problem)
            }
            None => write!(f, "{}: {}", self.source.name(), self.problem),
        }
    }
}

impl<P: Problem> std::error::Error for InputError<P> {}

impl<P: Problem> Diagnostic for InputError<P> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.help().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.span.as_ref().map(|_| &*self.source.named as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.span.clone()?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(span))))
    }
}
