//! The XML below the URDF: a document within bounds, and elements that know where they stand.

use std::ops::Range;

use roxmltree::{Document, Node, ParsingOptions};

use super::ignored::{IgnoreReason, Tally};
use super::notice::{Notice, NoticeKind};
use super::problem::UrdfProblem;
use super::subject::{AttributeOf, Owner, Size};
use crate::shown::breaks_lines;
use crate::wording::{beginning, nearest};
use crate::{InputError, Meant, SourceText};

/// Bytes accepted; the largest robots in use have less than one million.
const MOST_BYTES: usize = 1 << 26;
/// XML nodes accepted.
const MOST_NODES: u32 = 1 << 21;
/// Namespace declarations accepted: the parser's memory can grow with their square.
const MOST_NAMESPACES: usize = 1000;
/// Attributes that an element may have: the parser compares each with all others. Those of URDF have at most six.
const MOST_ATTRIBUTES: usize = 100;
/// Bytes that a name may have.
const LONGEST_NAME: usize = 200;
/// So many mistakes are told beside the first; the rest is counted.
const MOST_OTHERS: usize = 23;

/// A value and the bytes it was read from.
#[derive(Clone, Debug)]
pub(super) struct Located<T> {
    pub(super) value: T,
    pub(super) span: Range<usize>,
}

/// What is wrong, and where.
pub(super) type UrdfError = InputError<UrdfProblem>;

/// A file being read, with what there is to say about it so far.
pub(super) struct Reading<'a> {
    pub(super) source: &'a SourceText,
    pub(super) notices: Vec<Notice>,
    pub(super) ignored: Tally,
    /// The mistakes that were met, as many as are told.
    mistakes: Vec<UrdfError>,
    /// How many more there are.
    untold: usize,
    /// The first place that shows that the file is a template; all else follows from that.
    template: Option<UrdfError>,
    /// Whether some link or joint has no name, or a joint not both of its links: then who holds whom is not known.
    pub(super) has_gaps: bool,
}

impl<'a> Reading<'a> {
    pub(super) fn new(source: &'a SourceText) -> Self {
        Reading {
            source,
            notices: Vec::new(),
            ignored: Tally::default(),
            mistakes: Vec::new(),
            untold: 0,
            template: None,
            has_gaps: false,
        }
    }

    /// What was read; a mistake is noted, and told with all others at the [`end`](Self::end).
    pub(super) fn noted<T>(&mut self, read: Result<T, UrdfError>) -> Option<T> {
        match read {
            Ok(read) => return Some(read),
            Err(error) if matches!(error.problem, UrdfProblem::Xacro { .. }) => {
                self.template.get_or_insert(error);
            }
            Err(error) if self.mistakes.len() <= MOST_OTHERS => self.mistakes.push(error),
            Err(_) => self.untold += 1,
        }
        None
    }

    /// Whether a mistake was noted.
    pub(super) fn is_mistaken(&self) -> bool {
        !self.mistakes.is_empty() || self.template.is_some()
    }

    /// All mistakes that were noted as one, the first that was met in front and the others in the order of the file.
    pub(super) fn end(&mut self) -> Result<(), UrdfError> {
        if let Some(template) = self.template.take() {
            return Err(template);
        }
        let mut mistakes = std::mem::take(&mut self.mistakes).into_iter();
        let Some(mut first) = mistakes.next() else { return Ok(()) };
        first.others = mistakes.collect();
        first.others.sort_by_key(|other| other.span.as_ref().map_or(0, |span| span.start));
        if self.untold > 0 {
            first.others.push(self.error_overall(UrdfProblem::Further { count: self.untold }));
        }
        Err(first)
    }

    /// An error about the bytes `span`.
    pub(super) fn error(&self, span: Range<usize>, problem: UrdfProblem) -> UrdfError {
        InputError { source: self.source.clone(), span: Some(span), problem, others: Vec::new() }
    }

    /// An error about the file as a whole, or about what was asked of it.
    pub(super) fn error_overall(&self, problem: UrdfProblem) -> UrdfError {
        InputError { source: self.source.clone(), span: None, problem, others: Vec::new() }
    }

    /// Records a notice about the bytes `span`.
    pub(super) fn notice(&mut self, span: &Range<usize>, kind: NoticeKind) {
        self.notices.push(Notice { source: self.source.clone(), span: Some(span.clone()), kind });
    }

    /// The line of a byte offset.
    pub(super) fn line(&self, offset: usize) -> usize {
        self.source.line_column(offset).0
    }
}

/// Parses the text of `reading`, within bounds on its size and without entities.
pub(super) fn parse<'a>(reading: &Reading<'a>) -> Result<Document<'a>, UrdfError> {
    let source: &'a SourceText = reading.source;
    let text = source.text();
    let too_large = |size, most| Err(reading.error_overall(UrdfProblem::TooLarge { size, most }));
    if text.len() > MOST_BYTES {
        return too_large(Size::Bytes, MOST_BYTES);
    }
    if text.matches("xmlns").take(MOST_NAMESPACES + 1).count() > MOST_NAMESPACES {
        return too_large(Size::Namespaces, MOST_NAMESPACES);
    }
    if let Some(at) = crowded(text) {
        let problem = UrdfProblem::TooLarge { size: Size::Attributes, most: MOST_ATTRIBUTES };
        return Err(reading.error(at..at + 1, problem));
    }
    // XML with a mistake stays XML.
    if let Some(meant @ (Meant::Scenario | Meant::Json | Meant::Yaml | Meant::Csv)) = Meant::of(text) {
        let file = reading.source.name().to_owned();
        return Err(reading.error_overall(UrdfProblem::Meant { meant, file }));
    }
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).or_else(|error| {
        let at = match error {
            roxmltree::Error::NodesLimitReached => return too_large(Size::Nodes, MOST_NODES as usize),
            roxmltree::Error::DtdDetected => {
                let offset = text.find("<!DOCTYPE").unwrap_or(0);
                return Err(reading.error(offset..offset + 1, UrdfProblem::Doctype));
            }
            roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode => text.trim_end().len(),
            _ => offset_of(text, error.pos()),
        };
        let span = at..next_boundary(text, at);
        let problem = match &error {
            roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
                let name = text[at..].split(|c: char| c.is_whitespace() || c == '/' || c == '>').next();
                UrdfProblem::Xacro { found: excerpt(name.unwrap_or("xacro")) }
            }
            _ => UrdfProblem::Xml { error: Box::new(error) },
        };
        Err(reading.error(span, problem))
    })
}

/// Where an element begins that has more attributes than are accepted, found without the parser.
fn crowded(text: &str) -> Option<usize> {
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|found| at + found) {
        let rest = &text[start..];
        // What stands in these is no element.
        let closed = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((opens, closes)) = closed.into_iter().find(|(opens, _)| rest.starts_with(opens)) {
            at = start + opens.len() + rest[opens.len()..].find(closes)? + closes.len();
            continue;
        }
        let (mut quote, mut attributes, mut end) = (None, 0, rest.len());
        for (offset, byte) in rest.bytes().enumerate().skip(1) {
            match (quote, byte) {
                (Some(mark), _) if mark == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => attributes += 1,
                (None, b'>' | b'<') => {
                    end = offset;
                    break;
                }
                (None, _) => {}
            }
        }
        if attributes > MOST_ATTRIBUTES {
            return Some(start);
        }
        at = start + end;
    }
    None
}

/// The byte offset of a line and column, both from one.
fn offset_of(text: &str, at: roxmltree::TextPos) -> usize {
    let line_start = match at.row {
        0 | 1 => 0,
        row => text.match_indices('\n').nth(row as usize - 2).map_or(text.len(), |(newline, _)| newline + 1),
    };
    let rest = &text[line_start..];
    let column = (at.col as usize).saturating_sub(1);
    line_start + rest.char_indices().nth(column).map_or(rest.len(), |(offset, _)| offset)
}

fn next_boundary(text: &str, at: usize) -> usize {
    at + text.get(at..).and_then(|rest| rest.chars().next()).map_or(0, char::len_utf8)
}

/// An element of the file and whose it is.
#[derive(Clone)]
pub(super) struct Element<'a> {
    node: Node<'a, 'a>,
    pub(super) owner: Option<Owner>,
}

impl<'a> Element<'a> {
    pub(super) fn new(node: Node<'a, 'a>, owner: Option<Owner>) -> Self {
        Element { node, owner }
    }

    /// The same element, once its owner's name is known.
    pub(super) fn owned_by(self, owner: Owner) -> Self {
        Element { owner: Some(owner), ..self }
    }

    pub(super) fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The bytes of `<name`, without the attributes and content.
    pub(super) fn span(&self) -> Range<usize> {
        let Range { start, end } = self.node.range();
        let text = self.node.document().input_text().get(start..end).unwrap_or("");
        let stop = |c: char| c.is_whitespace() || c == '/' || c == '>';
        start..start + text.find(stop).unwrap_or(text.len())
    }

    /// Sorts the children: each name in `once` at most once, the rest to `other`, which gives the reason to ignore it
    /// or an error.
    pub(super) fn children_once<const N: usize>(
        &self,
        reading: &mut Reading<'_>,
        once: [&'static str; N],
        reason: impl Fn(&str) -> Option<IgnoreReason>,
    ) -> Result<[Option<Element<'a>>; N], UrdfError> {
        let mut found: [Option<Element<'a>>; N] = std::array::from_fn(|_| None);
        for child in self.children(reading)? {
            match once.iter().position(|name| *name == child.name()) {
                Some(k) => match &found[k] {
                    Some(first) => {
                        let problem = UrdfProblem::RepeatedElement {
                            owner: self.owner.clone().unwrap_or(Owner::Robot),
                            element: once[k],
                            first_line: reading.line(first.span().start),
                        };
                        reading.noted::<()>(Err(reading.error(child.span(), problem)));
                    }
                    None => found[k] = Some(child),
                },
                None => child.ignore(reading, &once, &reason),
            }
        }
        Ok(found)
    }

    /// The child elements in the namespace of this one; others, and text, are noted as ignored.
    pub(super) fn children(&self, reading: &mut Reading<'_>) -> Result<Vec<Element<'a>>, UrdfError> {
        let mut elements = Vec::new();
        for node in self.node.children() {
            if let (true, Some(text)) = (node.is_text(), node.text())
                && !text.trim().is_empty()
            {
                let blanks = text.len() - text.trim_start().len();
                let reason = IgnoreReason::Unknown { nearest: None };
                reading.ignored.add(format!("text in {}", self.name()), node.range().start + blanks, reason);
            }
            if !node.is_element() {
                continue;
            }
            let element = Element::new(node, self.owner.clone());
            element.refuse_xacro(reading)?;
            if node.tag_name().namespace() == self.node.tag_name().namespace() {
                elements.push(element);
            } else {
                reading.ignored.add(element.qualified_name(), node.range().start, IgnoreReason::Foreign);
            }
        }
        Ok(elements)
    }

    /// Refuses an element of xacro.
    pub(super) fn refuse_xacro(&self, reading: &Reading<'_>) -> Result<(), UrdfError> {
        match self.node.tag_name().namespace() {
            Some(uri) if uri.contains("xacro") => {
                let problem = UrdfProblem::Xacro { found: format!("<{}>", self.qualified_name()) };
                Err(reading.error(self.span(), problem))
            }
            _ => Ok(()),
        }
    }

    /// Notes this element as ignored; `known` are the names that would have been read here.
    pub(super) fn ignore(
        &self,
        reading: &mut Reading<'_>,
        known: &[&'static str],
        reason: impl Fn(&str) -> Option<IgnoreReason>,
    ) {
        let reason = reason(self.name())
            .unwrap_or_else(|| IgnoreReason::Unknown { nearest: nearest(self.name(), known.iter().copied()) });
        reading.ignored.add(self.name().to_owned(), self.node.range().start, reason);
    }

    /// Notes attributes that are not in `known` as ignored.
    pub(super) fn only_attributes(&self, reading: &mut Reading<'_>, known: &[&'static str]) {
        for attribute in self.node.attributes() {
            if attribute.namespace().is_some() || !known.contains(&attribute.name()) {
                let nearest = nearest(attribute.name(), known.iter().copied());
                let name = format!("{}@{}", self.name(), attribute.name());
                reading.ignored.add(name, attribute.range().start, IgnoreReason::Unknown { nearest });
            }
        }
    }

    /// Notes the attribute, if there is one, as ignored.
    pub(super) fn ignore_attribute(&self, reading: &mut Reading<'_>, name: &'static str, reason: IgnoreReason) {
        if let Some(attribute) = self.node.attribute_node(name) {
            reading.ignored.add(format!("{}@{name}", self.name()), attribute.range().start, reason);
        }
    }

    /// The text of an attribute.
    pub(super) fn text(
        &self,
        reading: &Reading<'_>,
        name: &'static str,
    ) -> Result<Option<Located<&'a str>>, UrdfError> {
        let Some(attribute) = self.node.attribute_node(name) else { return Ok(None) };
        let (value, mut span) = (attribute.value(), attribute.range_value());
        if span.start > span.end {
            span = attribute.range(); // absurdly long blanks around `=` overflow the parser's positions
        }
        if value.contains("${") || value.contains("$(") {
            return Err(reading.error(span, UrdfProblem::Xacro { found: excerpt(value) }));
        }
        Ok(Some(Located { value, span }))
    }

    /// The name in an attribute that must be there.
    pub(super) fn required_text(
        &self,
        reading: &Reading<'_>,
        name: &'static str,
        element: &'static str,
    ) -> Result<Located<&'a str>, UrdfError> {
        let attribute = || Box::new(AttributeOf { attribute: name, element, owner: self.owner.clone() });
        match self.text(reading, name)? {
            None => Err(reading.error(self.span(), UrdfProblem::MissingAttribute { attribute: attribute() })),
            Some(located) if located.value.trim().is_empty() => {
                Err(reading.error(located.span, UrdfProblem::Empty { attribute: attribute() }))
            }
            // Names head columns and stand in messages.
            Some(located) if located.value.len() > LONGEST_NAME || located.value.contains(breaks_lines) => {
                let (attribute, found) = (attribute(), excerpt(located.value));
                Err(reading.error(located.span, UrdfProblem::Name { attribute, found, most: LONGEST_NAME }))
            }
            Some(located) => Ok(located),
        }
    }

    /// The name of a link or joint; where it has none that can be used, that is noted.
    pub(super) fn own_name(&self, reading: &mut Reading<'_>, element: &'static str) -> Located<String> {
        let name = self.required_text(reading, "name", element);
        match reading.noted(name) {
            Some(Located { value, span }) => Located { value: value.to_owned(), span },
            None => {
                reading.has_gaps = true;
                Located { value: "(without a name)".into(), span: self.span() }
            }
        }
    }

    /// An attribute that holds one number.
    pub(super) fn number(
        &self,
        reading: &Reading<'_>,
        name: &'static str,
        element: &'static str,
    ) -> Result<Option<Located<f64>>, UrdfError> {
        let numbers = self.numbers::<1>(reading, name, element)?;
        Ok(numbers.map(|Located { value: [value], span }| Located { value, span }))
    }

    /// An attribute that holds one number and must be there.
    pub(super) fn required_number(
        &self,
        reading: &Reading<'_>,
        name: &'static str,
        element: &'static str,
    ) -> Result<Located<f64>, UrdfError> {
        match self.number(reading, name, element)? {
            Some(number) => Ok(number),
            None => {
                let attribute = Box::new(AttributeOf { attribute: name, element, owner: self.owner.clone() });
                Err(reading.error(self.span(), UrdfProblem::MissingAttribute { attribute }))
            }
        }
    }

    /// An attribute that holds one number, zero or more.
    pub(super) fn non_negative(
        &self,
        reading: &Reading<'_>,
        name: &'static str,
        element: &'static str,
    ) -> Result<Option<Located<f64>>, UrdfError> {
        match self.number(reading, name, element)? {
            Some(Located { value, span }) if value < 0.0 => {
                let attribute = Box::new(AttributeOf { attribute: name, element, owner: self.owner.clone() });
                Err(reading.error(span, UrdfProblem::Negative { attribute, value }))
            }
            number => Ok(number),
        }
    }

    /// An attribute that holds N numbers between blanks.
    pub(super) fn numbers<const N: usize>(
        &self,
        reading: &Reading<'_>,
        name: &'static str,
        element: &'static str,
    ) -> Result<Option<Located<[f64; N]>>, UrdfError> {
        let Some(Located { value: text, span }) = self.text(reading, name)? else { return Ok(None) };
        let attribute = || Box::new(AttributeOf { attribute: name, element, owner: self.owner.clone() });
        // Words have bytes of their own unless the value contains references such as &#32;.
        let literal = self.node.document().input_text().get(span.clone()) == Some(text);
        let mut values = [0.0; N];
        let mut got = 0;
        for word in text.split_ascii_whitespace() {
            let offset = word.as_ptr() as usize - text.as_ptr() as usize;
            let word_span = if literal { span.start + offset..span.start + offset + word.len() } else { span.clone() };
            let problem = match word.parse::<f64>() {
                Ok(value) if value.is_finite() => {
                    if let Some(slot) = values.get_mut(got) {
                        *slot = value;
                    }
                    got += 1;
                    continue;
                }
                Ok(_) => UrdfProblem::NotFinite { attribute: attribute(), text: excerpt(word) },
                Err(_) => UrdfProblem::NotANumber { attribute: attribute(), text: excerpt(word) },
            };
            return Err(reading.error(word_span, problem));
        }
        if got != N {
            let problem = match (N, got) {
                (_, 0) => UrdfProblem::Empty { attribute: attribute() },
                _ => UrdfProblem::WrongCount { attribute: attribute(), need: N, got },
            };
            return Err(reading.error(span, problem));
        }
        Ok(Some(Located { value: values, span }))
    }

    fn qualified_name(&self) -> String {
        let span = self.span();
        self.node.document().input_text().get(span.start + 1..span.end).unwrap_or(self.name()).to_owned()
    }
}

/// The beginning of a text, for messages.
fn excerpt(text: &str) -> String {
    beginning(text, 40)
}
