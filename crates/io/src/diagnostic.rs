//! Where in a file something is wrong, and what to do about it.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

use crate::Meant;
use crate::shown::{is_invisible, one_line, printable, shown, steers_terminals};

/// Lines longer than this are not shown whole, in bytes.
const LONGEST_LINE: usize = 400;
/// What is shown before and after the place in such a line, and of what is marked, in bytes.
const AROUND: usize = 60;
/// What stands in scenarios, robots and their states and hardly anywhere else. Of a file that has none of it, which may have been named by
/// mistake and be a secret, nothing is shown but the place of the mistake, and that only in part.
const FAMILIAR: [&str; 6] = ["[[agents]]", "[network]", "[time]", "format = ", "<robot", "\"q\":"];
/// What is shown of the place of a mistake in such a file, in bytes.
const AT_PLACE: usize = 24;

/// A file's name and text, shared by all that is said about it.
#[derive(Clone, Debug)]
pub struct SourceText {
    file: Arc<File>,
}

#[derive(Debug)]
struct File {
    name: String,
    text: String,
    /// The text as it may be shown, where that differs.
    shown: Option<String>,
}

impl SourceText {
    /// Keeps `text` under `name`, the path as the user wrote it.
    pub fn new(name: impl AsRef<str>, text: impl Into<String>) -> Self {
        let text = text.into();
        let shown = text.contains(|c| c == '\r' || steers_terminals(c) || is_invisible(c)).then(|| printable(&text));
        SourceText { file: Arc::new(File { name: name.as_ref().to_owned(), text, shown }) }
    }

    /// The file's name.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// The file's text.
    pub fn text(&self) -> &str {
        &self.file.text
    }

    /// The text without characters that would steer a terminal, byte for byte as long as [`text`](Self::text).
    fn shown(&self) -> &str {
        self.file.shown.as_deref().unwrap_or(&self.file.text)
    }

    /// Line and column, both from one, of a byte offset; columns count characters.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let before = &self.text()[..boundary(self.text(), offset)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// The nearest place between two characters at or before `offset`.
fn boundary(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

/// The beginning of what stands at `span`, as far as it is in one line.
fn place(text: &str, span: &SourceSpan) -> SourceSpan {
    let start = boundary(text, span.offset());
    let end = boundary(text, span.offset().saturating_add(span.len().min(AT_PLACE)));
    let end = text[start..end].find(['\r', '\n']).map_or(end, |newline| start + newline);
    (start, end - start).into()
}

/// Whether a text is one of those that this program reads, so that more of it may be shown than the place of a mistake.
fn is_familiar(text: &str) -> bool {
    FAMILIAR.iter().any(|own| text.contains(own)) || Meant::of(text) == Some(Meant::Csv)
}

impl SourceCode for SourceText {
    /// The lines around a place; of a very long line the part around it, so that no message is as long as its file.
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let text = self.shown();
        if !is_familiar(text) {
            let place = place(text, span);
            let data = &text.as_bytes()[place.offset()..place.offset() + place.len()];
            let (line, column) = self.line_column(place.offset());
            let name = shown(self.name()).to_string();
            return Ok(Box::new(MietteSpanContents::new_named(name, data, place, line - 1, column - 1, 1)));
        }
        let contents = text.read_span(span, lines_before, lines_after)?;
        let (mut data, mut whole) = (contents.data(), *contents.span());
        let (mut line, mut column, mut lines) = (contents.line(), contents.column(), contents.line_count());
        if data.split(|byte| *byte == b'\n').any(|line| line.len() > LONGEST_LINE) {
            let offset = span.offset();
            let line_start = text[..boundary(text, offset)].rfind('\n').map_or(0, |newline| newline + 1);
            let start = if lines_before == 0 { offset } else { line_start.max(offset.saturating_sub(AROUND)) };
            let start = boundary(text, start);
            let end = boundary(text, offset + span.len().min(AROUND) + AROUND);
            let end = text[start..end].find(['\r', '\n']).map_or(end, |newline| start + newline);
            (data, whole) = (&text.as_bytes()[start..end], (start, end - start).into());
            let (one, at) = self.line_column(start);
            (line, column, lines) = (one - 1, at - 1, 1);
        }
        Ok(Box::new(MietteSpanContents::new_named(shown(self.name()).to_string(), data, whole, line, column, lines)))
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
    /// What else is wrong with the file, as far as it can be told.
    pub others: Vec<InputError<P>>,
}

impl<P: Problem> fmt::Display for InputError<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.span {
            Some(span) => {
                let (line, column) = self.source.line_column(span.start);
                write!(f, "{}:{line}:{column}: {}", shown(self.source.name()), one_line(&self.problem))
            }
            None => write!(f, "{}: {}", shown(self.source.name()), one_line(&self.problem)),
        }
    }
}

impl<P: Problem> std::error::Error for InputError<P> {}

impl<P: Problem> Diagnostic for InputError<P> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.help().map(|help| Box::new(one_line(help)) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.span.as_ref().map(|_| &self.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.span.clone()?;
        // Of something very long the beginning is marked.
        let text = self.source.text();
        let end = if span.len() > LONGEST_LINE { boundary(text, span.start + AROUND) } else { span.end };
        Some(Box::new(std::iter::once(LabeledSpan::underline(span.start..end))))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        if self.others.is_empty() {
            return None;
        }
        Some(Box::new(self.others.iter().map(|other| other as &dyn Diagnostic)))
    }
}
