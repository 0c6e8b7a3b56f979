//! From TOML's tree with places to the structs of a scenario file.
//!
//! The deserialiser that comes with `toml` reports what is wrong as text. This one walks the same tree and reports a
//! [`ScenarioProblem`] with the bytes it is about, so that near matches can be offered and every message reads the same.

use std::fmt::Display;
use std::ops::Range;

use forwardstep_sim::quantity::LARGEST;
use serde::de::value::UsizeDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;
use toml::Spanned;
use toml::de::{DeInteger, DeString, DeTable, DeValue};

use super::at::AT;
use super::document::Node;
use super::edges_file::LIST_OR_CHOICE;
use super::fault::Fault;
use super::file::{AGENT_REFERENCE, LAW, REFERENCE, ROBOT};
use super::formula_text::{FORMULA, of_any_length};
use super::kinds::Kinds;
use super::network_file::{DELAY, SWITCHING};
use super::value_problem::ValueProblem;
use super::values::shorter;
use crate::shown::breaks_lines;

/// Bytes that a text may have.
const LONGEST_TEXT: usize = 500;

impl Error for Fault {
    fn custom<T: Display>(message: T) -> Self {
        Fault::new(ValueProblem::Unreadable { message: message.to_string() })
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let found = match found {
            Unexpected::Bool(value) => value.to_string(),
            Unexpected::Signed(value) => value.to_string(),
            Unexpected::Unsigned(value) => value.to_string(),
            Unexpected::Float(value) => value.to_string(),
            Unexpected::Str(text) => quoted(text),
            Unexpected::Seq => "a list".into(),
            Unexpected::Map => "a table".into(),
            other => other.to_string(),
        };
        Fault::new(ValueProblem::WrongType { found, expected: expected.to_string() })
    }

    fn unknown_variant(found: &str, allowed: &'static [&'static str]) -> Self {
        Fault::new(ValueProblem::UnknownChoice { found: found.into(), allowed: allowed.to_vec() })
    }

    fn unknown_field(key: &str, allowed: &'static [&'static str]) -> Self {
        Fault::new(ValueProblem::UnknownKey { key: key.into(), allowed: allowed.to_vec() })
    }

    fn invalid_length(found: usize, expected: &dyn Expected) -> Self {
        let found = format!("a list of {found}");
        Fault::new(ValueProblem::WrongType { found, expected: expected.to_string() })
    }

    fn missing_field(key: &'static str) -> Self {
        Fault::new(ValueProblem::MissingKey { key })
    }
}

/// A string as messages show it: in quotes, and not for ever.
pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((cut, _)) => format!("{:?}…", &text[..cut]),
        None => format!("{text:?}"),
    }
}

/// A text that fits into a line: every text of a scenario but formulas is a name, a choice or a title.
pub(super) fn plain(text: &str) -> Result<&str, Fault> {
    if text.len() > LONGEST_TEXT || text.contains(breaks_lines) {
        return Err(Fault::new(ValueProblem::Text { found: quoted(text), most: LONGEST_TEXT }));
    }
    Ok(text)
}

/// A place in the tree.
#[derive(Clone, Copy)]
pub(super) struct ValueDe<'a, 'i> {
    pub(super) value: &'a Spanned<DeValue<'i>>,
    /// Whose tables are checked on the way.
    pub(super) kinds: &'a Kinds,
}

impl<'a, 'i> ValueDe<'a, 'i> {
    pub(super) fn wrong(self, expected: &str) -> Fault {
        Fault::new(ValueProblem::WrongType { found: self.found(), expected: expected.into() }).at(&self.value.span())
    }

    /// What stands here, for a message.
    pub(super) fn found(self) -> String {
        match self.value.get_ref() {
            DeValue::String(text) => quoted(text),
            DeValue::Integer(value) => value.to_string(),
            DeValue::Float(value) => value.as_str().into(),
            DeValue::Boolean(value) => value.to_string(),
            DeValue::Datetime(value) => format!("the date {value}"),
            DeValue::Array(_) => "a list".into(),
            DeValue::Table(_) => "a table".into(),
        }
    }

    fn integer(self, integer: &DeInteger<'_>) -> Result<i64, Fault> {
        i64::from_str_radix(integer.as_str(), integer.radix()).map_err(|_| self.too_large(integer.to_string()))
    }

    fn too_large(self, found: String) -> Fault {
        Fault::new(ValueProblem::NumberTooLarge { found }).at(&self.value.span())
    }

    /// Any number. Nothing in a scenario may be infinite, no number at all, or so large that products overflow.
    fn number(self) -> Result<f64, Fault> {
        match self.value.get_ref() {
            DeValue::Integer(integer) => Ok(self.integer(integer)? as f64),
            DeValue::Float(float) => match float.as_str().parse::<f64>() {
                Ok(value) if value.abs() <= LARGEST => match shorter(float.as_str(), value) {
                    None => Ok(value),
                    Some(kept) => {
                        let found = float.as_str().into();
                        Err(Fault::new(ValueProblem::TooManyDigits { found, kept }).at(&self.value.span()))
                    }
                },
                Ok(_) if !float.as_str().contains(['i', 'n']) => Err(self.too_large(float.as_str().into())),
                _ => Err(Fault::new(ValueProblem::NotFinite { found: float.as_str().into() }).at(&self.value.span())),
            },
            _ => Err(self.wrong("a number")),
        }
    }

    pub(super) fn table(self, expected: &str) -> Result<Entries<'a, 'i>, Fault> {
        match self.value.get_ref() {
            DeValue::Table(table) => Ok(Entries::new(table, self.kinds)),
            _ => Err(self.wrong(expected)),
        }
    }

    pub(super) fn span(self) -> Range<usize> {
        self.value.span()
    }

    /// Hands over the key of a kind whose table was found sound.
    fn kind<'de, T: ?Sized, V: Visitor<'de>>(
        self,
        read: Result<(&'static str, Box<T>), Fault>,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        read.and_then(|(key, _)| visitor.visit_str(key)).map_err(|fault: Fault| fault.at(&self.value.span()))
    }

    fn list<'de, V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value.get_ref() {
            DeValue::Array(array) => visitor.visit_seq(Elements(array.iter(), self.kinds)),
            _ => Err(self.wrong("a list")),
        }
    }
}

macro_rules! forward {
    ($($method:ident),*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            self.deserialize_any(visitor)
        })*
    };
}

macro_rules! whole {
    ($($method:ident),*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            match self.value.get_ref() {
                DeValue::Integer(integer) => visitor.visit_i64(self.integer(integer)?),
                _ => Err(self.wrong("a whole number")),
            }
            .map_err(|error: Fault| error.at(&self.value.span()))
        })*
    };
}

macro_rules! text {
    ($($method:ident),*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            match self.value.get_ref() {
                DeValue::String(text) => plain(text).and_then(|text| visitor.visit_str(text)),
                _ => Err(self.wrong("a text in quotes")),
            }
            .map_err(|error: Fault| error.at(&self.value.span()))
        })*
    };
}

impl<'de> Deserializer<'de> for ValueDe<'_, '_> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value.get_ref() {
            DeValue::String(text) => plain(text).and_then(|text| visitor.visit_str(text)),
            DeValue::Integer(_) | DeValue::Float(_) => self.number().and_then(|value| visitor.visit_f64(value)),
            DeValue::Boolean(value) => visitor.visit_bool(*value),
            DeValue::Datetime(_) => Err(self.wrong("a number, a text, a list or a table")),
            DeValue::Array(array) => visitor.visit_seq(Elements(array.iter(), self.kinds)),
            DeValue::Table(table) => visitor.visit_map(Entries::new(table, self.kinds)),
        }
        .map_err(|error| error.at(&self.value.span()))
    }

    forward! {
        deserialize_bytes, deserialize_byte_buf, deserialize_unit, deserialize_identifier, deserialize_char
    }

    whole! {
        deserialize_i8, deserialize_i16, deserialize_i32, deserialize_i64, deserialize_u8, deserialize_u16,
        deserialize_u32, deserialize_u64
    }

    text! { deserialize_str, deserialize_string }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => visitor.visit_bool(*value),
            _ => Err(self.wrong("true or false")),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_any(visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, name: &'static str, visitor: V) -> Result<V::Value, Fault> {
        if name == AT {
            visitor.visit_seq(Placed { de: self, span: self.value.span(), part: 0 })
        } else if name == ROBOT {
            self.kind(self.kinds.robot(self), visitor)
        } else if name == LAW {
            self.kind(self.kinds.law(self), visitor)
        } else if name == REFERENCE {
            self.kind(self.kinds.reference(self), visitor)
        } else if name == AGENT_REFERENCE {
            self.kind(self.kinds.agent_reference(self), visitor)
        } else if name == SWITCHING {
            self.kind(self.kinds.schedule(self), visitor)
        } else if name == DELAY {
            self.kinds.delay(self).map_err(|fault| fault.at(&self.value.span()))?;
            visitor.visit_u64(Node::of(self.value).0)
        } else if let (FORMULA, DeValue::String(text)) = (name, self.value.get_ref()) {
            let text = of_any_length(text).and_then(|text| visitor.visit_str(text));
            text.map_err(|fault: Fault| fault.at(&self.value.span()))
        } else if name == FORMULA || name == LIST_OR_CHOICE && !matches!(self.value.get_ref(), DeValue::Table(_)) {
            self.deserialize_any(visitor)
        } else {
            visitor.visit_newtype_struct(self)
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.list(visitor).map_err(|error| error.at(&self.value.span()))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        match self.value.get_ref() {
            DeValue::Array(array) if array.len() != length => {
                let problem = ValueProblem::ListLength { found: array.len(), need: length };
                Err(Fault::new(problem).at(&self.value.span()))
            }
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.deserialize_tuple(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_map(self.table("a table")?).map_err(|error| error.at(&self.value.span()))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let entries = self.table(&format!("a table of {}", fields.join(", ")))?;
        visitor.visit_map(entries).map_err(|error| error.at(&self.value.span()))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        choices: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let choice = self.choice(choices)?;
        visitor.visit_enum(choice).map_err(|error| error.at(&self.value.span()))
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_unit()
    }
}

/// The parts of an [`super::At`]: start, end, value.
struct Placed<D> {
    de: D,
    span: Range<usize>,
    part: u8,
}

impl<'de, D: Deserializer<'de, Error = Fault> + Copy> SeqAccess<'de> for Placed<D> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        self.part += 1;
        let bound = |bytes: usize| -> UsizeDeserializer<Fault> { bytes.into_deserializer() };
        match self.part {
            1 => seed.deserialize(bound(self.span.start)),
            2 => seed.deserialize(bound(self.span.end)),
            _ => seed.deserialize(self.de),
        }
        .map(Some)
    }
}

struct Elements<'a, 'i>(std::slice::Iter<'a, Spanned<DeValue<'i>>>, &'a Kinds);

impl<'de> SeqAccess<'de> for Elements<'_, '_> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        self.0.next().map(|value| seed.deserialize(ValueDe { value, kinds: self.1 })).transpose()
    }
}

pub(super) type Entry<'a, 'i> = (&'a Spanned<DeString<'i>>, &'a Spanned<DeValue<'i>>);

/// The entries of a table in the order of the file, so that the first mistake is the one reported.
pub(super) struct Entries<'a, 'i> {
    entries: std::vec::IntoIter<Entry<'a, 'i>>,
    value: Option<&'a Spanned<DeValue<'i>>>,
    kinds: &'a Kinds,
}

impl<'a, 'i> Entries<'a, 'i> {
    fn new(table: &'a DeTable<'i>, kinds: &'a Kinds) -> Self {
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        Entries { entries: entries.into_iter(), value: None, kinds }
    }

    pub(super) fn next(&mut self) -> Option<Entry<'a, 'i>> {
        self.entries.next()
    }
}

impl<'de> MapAccess<'de> for Entries<'_, '_> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Fault> {
        let Some((key, value)) = self.next() else { return Ok(None) };
        self.value = Some(value);
        seed.deserialize(KeyDe(key)).map(Some).map_err(|error| error.at(&key.span()))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Fault> {
        match self.value.take() {
            Some(value) => seed.deserialize(ValueDe { value, kinds: self.kinds }),
            None => Err(Fault::custom("a key without a value")),
        }
    }
}

/// A key, which may be asked for its place like a value.
#[derive(Clone, Copy)]
struct KeyDe<'a, 'i>(&'a Spanned<DeString<'i>>);

impl<'de> Deserializer<'de> for KeyDe<'_, '_> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_str(plain(self.0.get_ref())?)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, name: &'static str, visitor: V) -> Result<V::Value, Fault> {
        if name == AT {
            visitor.visit_seq(Placed { de: self, span: self.0.span(), part: 0 })
        } else {
            visitor.visit_newtype_struct(self)
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct seq
        tuple tuple_struct map struct enum identifier ignored_any
    }
}
