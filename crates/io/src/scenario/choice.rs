//! A choice among several, in TOML's tree: a text, or a table with a single key.

use std::ops::Range;

use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, VariantAccess, Visitor};
use toml::Spanned;
use toml::de::DeValue;

use super::de::{ValueDe, plain};
use super::fault::Fault;
use super::kinds::Kinds;
use super::value_problem::ValueProblem;

impl<'a, 'i> ValueDe<'a, 'i> {
    /// One of `choices`: a text, or a table with a single key.
    pub(super) fn choice(self, choices: &[&'static str]) -> Result<Choice<'a, 'i>, Fault> {
        let span = self.value.span();
        let (kinds, unknown) = (self.kinds, |key: &str| unknown_choice(key, choices));
        let choice = match self.value.get_ref() {
            DeValue::String(text) => {
                Choice { key: plain(text).map_err(|fault| fault.at(&span))?, span: span.clone(), content: None, kinds }
            }
            DeValue::Table(_) => {
                let mut entries = self.table("a table")?;
                let Some((key, content)) = entries.next() else {
                    let problem = ValueProblem::NoChoice { allowed: choices.to_vec() };
                    return Err(Fault::new(problem).at(&span));
                };
                if let Some((second, _)) = entries.next() {
                    let stranger = [key, second].into_iter().find(|key| !choices.contains(&key.get_ref().as_ref()));
                    return Err(match stranger {
                        Some(key) => plain(key.get_ref()).map_or_else(|fault| fault, unknown).at(&key.span()),
                        None => Fault::new(ValueProblem::TwoChoices {
                            first: key.get_ref().to_string(),
                            second: second.get_ref().to_string(),
                        })
                        .at(&second.span()),
                    });
                }
                let name = plain(key.get_ref()).map_err(|fault| fault.at(&key.span()))?;
                Choice { key: name, span: key.span(), content: Some(content), kinds }
            }
            _ => {
                let problem = ValueProblem::NotAChoice { found: self.found(), allowed: choices.to_vec() };
                return Err(Fault::new(problem).at(&self.value.span()));
            }
        };
        if choices.contains(&choice.key) { Ok(choice) } else { Err(choice.unknown(choices)) }
    }
}

fn unknown_choice(found: &str, allowed: &[&'static str]) -> Fault {
    Fault::new(ValueProblem::UnknownChoice { found: found.into(), allowed: allowed.to_vec() })
}

/// A choice among several, with what belongs to it.
pub(super) struct Choice<'a, 'i> {
    pub(super) key: &'a str,
    span: Range<usize>,
    content: Option<&'a Spanned<DeValue<'i>>>,
    kinds: &'a Kinds,
}

impl<'de, 'a, 'i> EnumAccess<'de> for Choice<'a, 'i> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Fault> {
        let key: StrDeserializer<'_, Fault> = self.key.into_deserializer();
        Ok((seed.deserialize(key)?, self))
    }
}

impl<'a, 'i> Choice<'a, 'i> {
    pub(super) fn unknown(&self, choices: &[&'static str]) -> Fault {
        unknown_choice(self.key, choices).at(&self.span)
    }

    pub(super) fn content(&self) -> Result<ValueDe<'a, 'i>, Fault> {
        let missing = || ValueProblem::ChoiceNeedsValue { choice: self.key.into() };
        let kinds = self.kinds;
        self.content.map(|value| ValueDe { value, kinds }).ok_or_else(|| Fault::new(missing()).at(&self.span))
    }
}

impl<'de> VariantAccess<'de> for Choice<'_, '_> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        match self.content {
            None => Ok(()),
            Some(_) => {
                let problem = ValueProblem::ChoiceTakesNoValue { choice: self.key.into() };
                Err(Fault::new(problem).at(&self.span))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        seed.deserialize(self.content()?)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        self.content()?.deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: &'static [&'static str], visitor: V) -> Result<V::Value, Fault> {
        self.content()?.deserialize_struct("", fields, visitor)
    }
}
