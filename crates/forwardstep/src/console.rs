//! Text for people: colours on terminals only, nothing else that a terminal would obey, and a pipe that closes early is no error.
//!
//! All that the program says leaves here. What others wrote and it repeats, names of files above all, is escaped where it is named
//! ([`forwardstep::io::shown`]); what slips through is escaped here.

use std::borrow::Cow;
use std::ffi::OsString;
use std::fmt;
use std::io::{self, ErrorKind, IsTerminal, Stdout, Write};

use anstream::AutoStream;
use anstyle::{AnsiColor, Style};
use forwardstep::io::{breaks_lines, is_invisible, one_line, shown, steers_terminals, unbroken};
use miette::{Diagnostic, MietteHandlerOpts, ReportHandler};
use textwrap::core::display_width;
use textwrap::{Options, WordSeparator, WordSplitter};

pub(crate) use crate::mistake::Plain;
use crate::mistake::Told;
use crate::status::Status;

/// Green, for what holds.
pub(crate) const GOOD: Style = AnsiColor::Green.on_default();
/// Yellow, for what holds in part.
pub(crate) const FAIR: Style = AnsiColor::Yellow.on_default();
/// Red, for what does not hold.
pub(crate) const BAD: Style = AnsiColor::Red.on_default();
/// Narrower than this is no terminal that somebody reads.
const NARROWEST: usize = 40;
/// For headings.
pub(crate) const BOLD: Style = Style::new().bold();
/// For what matters less.
pub(crate) const DIM: Style = Style::new().dimmed();

/// Standard output. Colours are left out unless it is a terminal, and when `NO_COLOR` is set.
pub(crate) struct Console {
    out: AutoStream<Stdout>,
    muted: bool,
    failure: Option<io::Error>,
}

impl Console {
    pub(crate) fn new() -> Self {
        Console { out: AutoStream::auto(io::stdout()), muted: false, failure: None }
    }

    /// One that says nothing, for a command that is a part of another.
    pub(crate) fn muted() -> Self {
        Console { muted: true, ..Console::new() }
    }

    /// Writes a line. After a failure nothing more is written: a run goes on although its words are not read.
    pub(crate) fn line(&mut self, text: impl fmt::Display) {
        self.text(format_args!("{text}\n"));
    }

    /// Writes text, on a terminal in lines of its width.
    pub(crate) fn text(&mut self, text: impl fmt::Display) {
        let text = harmless(&text.to_string(), |c| c.escape_debug().to_string());
        match width_of(&io::stdout()) {
            Some(width) => self.verbatim(in_lines(&text, width)),
            None => self.verbatim(text),
        }
    }

    /// Writes a line that stays one, such as the path of a file, which somebody may copy.
    pub(crate) fn whole(&mut self, line: impl fmt::Display) {
        self.verbatim(harmless(&format!("{line}\n"), |c| c.escape_debug().to_string()));
    }

    /// Writes a JSON document, whose strings have escapes of their own.
    pub(crate) fn json(&mut self, document: impl fmt::Display) {
        self.verbatim(harmless(&format!("{document}\n"), |c| {
            // Characters beyond the first 65536 have two escapes there.
            c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect()
        }));
    }

    /// Writes the text of a file: as it is for a pipe or a file, and without what a terminal would obey for a terminal.
    pub(crate) fn file(&mut self, text: &str) {
        if !io::stdout().is_terminal() {
            return self.verbatim(text);
        }
        for line in text.lines() {
            self.whole(line);
        }
    }

    /// Writes the text of a file as it is, which a reader will ask for again.
    pub(crate) fn verbatim(&mut self, text: impl fmt::Display) {
        if !self.muted
            && self.failure.is_none()
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
    let said = explained(&Told(mistake), width_of(&io::stderr()), io::stderr().is_terminal());
    // A closed standard error leaves only the exit status to tell.
    let _ = writeln!(io::stderr(), "{}", harmless(&said, |c| c.escape_debug().to_string()));
    Status::BadInput
}

/// Columns of the terminal on a stream, and what `COLUMNS` says where that does not know its size; nothing where there is none: programs
/// read whole lines.
pub(crate) fn width_of<S: Terminal>(stream: &S) -> Option<usize> {
    if !stream.is_terminal() {
        return None;
    }
    let stated = || std::env::var("COLUMNS").ok()?.parse().ok();
    let columns = stream.columns().or_else(stated).filter(|columns| *columns > 0)?;
    Some(columns.max(NARROWEST))
}

/// What may be a terminal.
pub(crate) trait Terminal: IsTerminal {
    /// How many columns it has, if it knows.
    fn columns(&self) -> Option<usize>;
}

#[cfg(unix)]
impl<S: IsTerminal + std::os::fd::AsFd> Terminal for S {
    // One that knows no height, as under `script`, may still know its width.
    fn columns(&self) -> Option<usize> {
        rustix::termios::tcgetwinsize(self).ok().map(|size| size.ws_col.into()).filter(|columns| *columns > 0)
    }
}

#[cfg(windows)]
impl<S: IsTerminal + std::os::windows::io::AsHandle> Terminal for S {
    fn columns(&self) -> Option<usize> {
        terminal_size::terminal_size_of(self).map(|(width, _)| width.0.into())
    }
}

/// A mistake in the words of its file; wrapped at this width, if there is one, between words only: names are not taken apart, and
/// lines of a file stay whole.
fn explained(mistake: &dyn Diagnostic, width: Option<usize>, colour: bool) -> String {
    let mut options = MietteHandlerOpts::new().wrap_lines(width.is_some()).break_words(false);
    if let Some(width) = width {
        options =
            options.width(width).word_separator(WordSeparator::AsciiSpace).word_splitter(WordSplitter::NoHyphenation);
    }
    if !colour {
        options = options.color(false);
    }
    let handler = options.build();
    Shown { handler: &handler, mistake }.to_string()
}

/// The same text in lines of this width, if there is one.
fn wrapped(text: &str, width: Option<usize>) -> String {
    width.map_or_else(|| text.to_owned(), |width| filled(text, between_words(width)))
}

/// Lines that part no number from its unit.
fn filled(text: &str, options: Options<'_>) -> String {
    textwrap::fill(&unbroken(text), options).replace('\u{a0}', " ")
}

/// Lines of this width, broken between words only.
fn between_words<'a>(width: usize) -> Options<'a> {
    Options::new(width)
        .break_words(false)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation)
}

/// The same text with lines that are wider broken between words. They go on two columns further in, or below the value of
/// `name   value`; rows of tables, which have more gaps than that one, stay as they are.
fn in_lines(text: &str, width: usize) -> String {
    let lines = text.split('\n').map(|line| {
        if display_width(line) <= width { Cow::Borrowed(line) } else { Cow::Owned(continued(line, width)) }
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn continued(line: &str, width: usize) -> String {
    let content = line.trim_start_matches(' ');
    let indent = line.len() - content.len();
    // Where a run of two blanks or more ends.
    let bytes = content.as_bytes();
    let ends = (2..bytes.len()).filter(|k| bytes[*k] != b' ' && bytes[k - 2..*k] == *b"  ");
    let gaps: Vec<usize> = ends.map(|end| end + behind_colours(&content[end..])).collect();
    let further = indent + if indent == 0 { 0 } else { 2 };
    let hang = match gaps.as_slice() {
        _ if content.starts_with('|') => return line.to_owned(),
        [] => further,
        [end] => Some(indent + display_width(&content[..*end])).filter(|hang| 2 * hang <= width).unwrap_or(further),
        _ => return line.to_owned(),
    };
    let (first, rest) = (" ".repeat(indent), " ".repeat(hang));
    let options = between_words(width).initial_indent(&first).subsequent_indent(&rest);
    filled(content, options)
}

/// Explains a mistake in the arguments on standard error, or shows the help that they ask for on standard output, which fails where that
/// cannot be written, unless the reader simply went away.
pub(crate) fn show_usage(answer: &clap::Error, arguments: &[OsString]) -> io::Result<()> {
    // What is asked for repeats no argument.
    if !answer.use_stderr() {
        return answer.print().and_then(|()| io::stdout().flush()).or_else(|error| match error.kind() {
            ErrorKind::BrokenPipe => Ok(()),
            _ => Err(error),
        });
    }
    let mut said = answer.render().ansi().to_string();
    for argument in arguments.iter().map(|argument| argument.to_string_lossy()).filter(|a| a.contains(breaks_lines)) {
        said = said.replace(&*argument, &shown(&*argument).to_string());
        // Of `--name=value` and `joint=value` the value alone may be repeated.
        for (at, _) in argument.match_indices('=') {
            let value = &argument[at + 1..];
            if value.contains(breaks_lines) {
                said = said.replace(value, &shown(value).to_string());
            }
        }
    }
    // A closed standard error leaves only the exit status to tell.
    let _ = write!(AutoStream::auto(io::stderr()), "{}", harmless(&said, |c| c.escape_debug().to_string()));
    Ok(())
}

/// Says one sentence on standard error.
pub(crate) fn remark(sentence: impl fmt::Display) {
    // What it repeats of others must not begin a line that looks like one of the program's own.
    let sentence = one_line(sentence);
    let _ = writeln!(AutoStream::auto(io::stderr()), "{}", wrapped(&sentence, width_of(&io::stderr())));
}

/// The same text with all `escaped` that a terminal would obey, but for colours.
fn harmless(text: &str, escaped: impl Fn(char) -> String) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let colour = colour(rest);
        let (piece, tail) = rest.split_at(colour.unwrap_or(c.len_utf8()));
        match colour {
            None if steers_terminals(c) || is_invisible(c) || c == '\r' => shown.push_str(&escaped(c)),
            None | Some(_) => shown.push_str(piece),
        }
        rest = tail;
    }
    shown
}

/// How long the sequence for a colour or a weight is with which a text begins, `ESC [ 1 ; 31 m`, in bytes; `None` if there is none.
fn colour(text: &str) -> Option<usize> {
    const BEGINS: &str = "\u{1b}[";
    let end = text.strip_prefix(BEGINS)?.find(|c: char| !c.is_ascii_digit() && c != ';')? + BEGINS.len();
    text[end..].starts_with('m').then_some(end + 1)
}

/// Where blanks and colours end with which a text begins.
fn behind_colours(text: &str) -> usize {
    let mut end = 0;
    while let Some(more) = colour(&text[end..]).or_else(|| text[end..].starts_with(' ').then_some(1)) {
        end += more;
    }
    end
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

#[cfg(test)]
mod tests {
    use super::*;

    fn escaped(text: &str) -> String {
        harmless(text, |c| c.escape_debug().to_string())
    }

    #[test]
    fn colours_pass_and_whatever_else_a_terminal_would_obey_is_escaped() {
        let own = format!("{BOLD}holds{BOLD:#}: {BAD}q\u{307}{BAD:#}\n\tnext \u{1b}[38;5;1;4mline\u{1b}[m");
        assert_eq!(escaped(&own), own);
        for (text, shown) in [
            ("\u{1b}[2J", "\\u{1b}[2J"),
            ("\u{1b}[31", "\\u{1b}[31"),
            ("\u{1b}]0;title\u{7}", "\\u{1b}]0;title\\u{7}"),
            ("\u{1b}\u{1b}[1m\u{1b}", "\\u{1b}\u{1b}[1m\\u{1b}"),
            ("a\u{9b}2Jb\rc\u{8}", "a\\u{9b}2Jb\\rc\\u{8}"),
            ("\u{202e}gpj.exe\u{2066}\u{200f}", "\\u{202e}gpj.exe\\u{2066}\\u{200f}"),
        ] {
            assert_eq!(escaped(text), shown);
        }
        let json = harmless("\"\u{202e}\u{9b}\"", |c| format!("\\u{:04x}", u32::from(c)));
        assert_eq!(json, "\"\\u202e\\u009b\"");
    }

    #[derive(Debug, thiserror::Error)]
    #[error("`six-arms-over-radioo` is no scenario, and there is no such file: choose one of those that are listed")]
    struct Unknown;

    impl Diagnostic for Unknown {
        fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
            let names = (0..60).map(|k| format!("`scenario-of-some-length-{k}`")).collect::<Vec<_>>();
            Some(Box::new(format!("did you mean `six-arms-over-radio`? {}", names.join(", "))))
        }
    }

    #[test]
    fn messages_are_as_wide_as_a_terminal_and_whole_in_pipes() {
        let plain = explained(&Unknown, None, false);
        assert_eq!(plain.lines().filter(|line| line.len() > 200).count(), 1, "{plain}");
        let words =
            |text: &str| text.split_whitespace().filter(|word| *word != "│").map(str::to_owned).collect::<Vec<_>>();
        for width in [40, 60, 80, 133] {
            let said = explained(&Unknown, Some(width), false);
            assert!(said.lines().all(|line| line.chars().count() <= width), "{width}:\n{said}");
            // No name is taken apart, and none is left out.
            assert_eq!(words(&said), words(&plain), "{said}");
            let sentence =
                "Interrupted at t = 3.25 s of 100 s; everything until then is kept, as is what stands beside it.";
            let lines = wrapped(sentence, Some(width));
            assert!(lines.lines().all(|line| line.chars().count() <= width), "{lines}");
            assert_eq!(words(&lines), words(sentence));
        }
        assert_eq!(wrapped(&"word ".repeat(50), None), "word ".repeat(50));
    }

    #[test]
    fn what_is_printed_is_as_wide_as_a_terminal_but_for_tables() {
        let sentence = "the union of the graphs over uniformly bounded windows contains a directed spanning tree";
        let hypothesis = format!("  {GOOD}holds{GOOD:#}: {sentence} {DIM}[spanning-tree]{DIM:#}");
        let named = format!("{BOLD}{:22}{BOLD:#} {sentence}", "six-arms");
        let row = format!(" verdict               Theorem 2: {sentence}");
        let table = format!("arm-1    2.0    {sentence}\n| a | {sentence} |");
        let path = "forwardstep-runs/a-folder-with-a-rather-long-name/that-cannot-be-broken/report.html";
        let text = format!("{sentence}\n\n{hypothesis}\n{row}\n{named}\n{path}\n");
        for width in [60, 80] {
            let shown = in_lines(&text, width);
            let lines: Vec<&str> = shown.lines().collect();
            assert!(lines.iter().all(|line| display_width(line) <= width || *line == path), "{shown}");
            let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
            assert_eq!(words(&shown), words(&text));
            assert!(
                shown.ends_with('\n') && lines[0].starts_with("the union") && !lines[1].starts_with(' '),
                "{shown}"
            );
            let after = |begin: &str| lines[lines.iter().position(|line| line.contains(begin)).unwrap() + 1];
            assert!(after("holds").starts_with("    ") && !after("holds").starts_with("     "), "{shown}");
            assert!(after("verdict").starts_with(&" ".repeat(23)), "{shown}");
            assert!(after("six-arms").starts_with(&" ".repeat(23)) && !after("six-arms").starts_with(&" ".repeat(24)));
            assert_eq!(in_lines(&table, width), table);
        }
        assert_eq!(in_lines(&text, 500), text);
    }
}
