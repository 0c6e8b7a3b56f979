//! Names and words from outside as text that does nothing to a terminal but appear on it.

use std::fmt::{self, Write};
use std::path::Path;

/// Messages longer than this are cut, in bytes.
const LONGEST_MESSAGE: usize = 2000;

/// Whether a character would do something to a terminal rather than appear on it: control characters, separators of lines and paragraphs,
/// which are none, and what changes the direction in which text runs.
pub fn steers_terminals(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{2028}' | '\u{2029}') || turns
}

/// Whether a character takes no place and shows nothing, so that a text with it looks as one without: zero widths, soft hyphens, marks of the
/// order of bytes, tags.
pub fn is_invisible(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{200b}'..='\u{200d}' | '\u{2060}'..='\u{2064}' | '\u{feff}' | '\u{e0000}'..='\u{e007f}')
}

/// Whether a character does not belong into a line of text.
pub fn breaks_lines(c: char) -> bool {
    c.is_control() || steers_terminals(c)
}

/// A path, or a name of a file, as one line: what does not belong into a line is escaped, as in `a\u{1b}[2Jb`, and what is no Unicode
/// replaced.
///
/// ```
/// assert_eq!(forwardstep_io::shown("a\n\u{1b}[31m.toml").to_string(), "a\\n\\u{1b}[31m.toml");
/// ```
pub fn shown<P: AsRef<Path> + ?Sized>(path: &P) -> Shown<'_> {
    Shown(path.as_ref())
}

/// [`shown`].
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a>(&'a Path);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.to_string_lossy().chars().try_for_each(|c| escaped(c, f))
    }
}

/// A message as one line of reasonable length, whatever of a file it quotes.
pub fn one_line(message: impl fmt::Display) -> String {
    let message = message.to_string();
    let mut line = String::with_capacity(message.len().min(LONGEST_MESSAGE));
    for c in message.chars() {
        if line.len() + c.len_utf8() > LONGEST_MESSAGE {
            line.push('…');
            break;
        }
        // A text takes all that is written to it.
        let _ = escaped(c, &mut line);
    }
    line
}

fn escaped(c: char, out: &mut impl Write) -> fmt::Result {
    let is_raw = !breaks_lines(c) && !is_invisible(c);
    if is_raw { out.write_char(c) } else { write!(out, "{}", c.escape_debug()) }
}

/// The same text with question marks in place of such characters and of those that show nothing, and of returns that end no line, as many
/// as they have bytes. The mark of the order of bytes with which some editors begin a file becomes blanks.
pub(crate) fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for (start, c) in text.char_indices() {
        let returns = c == '\r' && !text[start + 1..].starts_with('\n');
        if c == '\u{feff}' && start == 0 {
            shown.push_str("   ");
        } else if returns || steers_terminals(c) || is_invisible(c) {
            (0..c.len_utf8()).for_each(|_| shown.push('?'));
        } else {
            shown.push(c);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_shows_nothing_is_escaped_and_takes_the_place_of_its_bytes_where_lines_are_shown() {
        let hidden = ['\u{ad}', '\u{200b}', '\u{200d}', '\u{2060}', '\u{2064}', '\u{feff}', '\u{e0001}', '\u{e0041}'];
        for c in hidden {
            let name = format!("ti{c}tle");
            assert_eq!(shown(&name).to_string(), format!("ti\\u{{{:x}}}tle", u32::from(c)));
            assert_eq!(one_line(&name), shown(&name).to_string());
            assert_eq!(printable(&name), format!("ti{}tle", "?".repeat(c.len_utf8())));
        }
        assert_eq!(printable("\u{feff}format = 2"), "   format = 2");
        for plain in ["title", "größe", "q\u{307}", "σ ≤ 1 – 2"] {
            assert_eq!((shown(plain).to_string(), printable(plain)), (plain.to_owned(), plain.to_owned()));
        }
    }
}
