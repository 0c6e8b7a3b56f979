//! A state of a robot: a JSON map from joints to q, q̇, z and ż.
//!
//! The parser hands out pieces of the text, so every problem has its place.

use std::fmt;
use std::ops::Range;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::state_problem::StateProblem;
use crate::{InputError, SourceText};

/// The quantities of a joint, as files write them.
pub(super) const KEYS: [&str; 4] = ["q", "dq", "z", "dz"];

/// The arguments of the two-velocity torque, one entry per degree of freedom, in rad or m and s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointState {
    /// Positions q.
    pub q: Vec<f64>,
    /// Velocities q̇.
    pub dq: Vec<f64>,
    /// Reference velocities z.
    pub z: Vec<f64>,
    /// Reference accelerations ż.
    pub dz: Vec<f64>,
}

/// Reads a state of the robot whose degrees of freedom have these names.
///
/// ```
/// use forwardstep_io::SourceText;
/// use forwardstep_io::robot::read_state;
///
/// let text = r#"{ "elbow": { "q": 0.5, "z": 1 }, "shoulder": { "q": -1 } }"#;
/// let state = read_state(&SourceText::new("state.json", text), &["shoulder", "elbow"])?;
/// assert_eq!((state.q, state.z), (vec![-1.0, 0.5], vec![0.0, 1.0]));
///
/// let wrong = text.replace("elbow", "elbwo");
/// let error = read_state(&SourceText::new("state.json", wrong), &["shoulder", "elbow"]).unwrap_err();
/// assert_eq!(error.to_string(), "state.json:1:3: the robot has no moving joint `elbwo`");
/// # Ok::<(), forwardstep_io::InputError<forwardstep_io::robot::StateProblem>>(())
/// ```
///
/// # Errors
/// The first problem met, at its place in the file. Any text gives a result; none panics.
pub fn read_state(source: &SourceText, joints: &[&str]) -> Result<JointState, InputError<StateProblem>> {
    let reader = Reader { source, text: source.text() };
    let zeros = || vec![0.0; joints.len()];
    let mut values = [zeros(), zeros(), zeros(), zeros()];
    let mut given = vec![false; joints.len()];
    for (name, entry) in reader.entries(source.text(), || "the state".to_owned())? {
        let joint = reader.string(name)?;
        let Some(j) = joints.iter().position(|known| *known == joint) else {
            let joints = joints.iter().map(|&known| known.to_owned()).collect();
            return Err(reader.error(name, StateProblem::UnknownJoint { joint, joints }));
        };
        if std::mem::replace(&mut given[j], true) {
            return Err(reader.error(name, StateProblem::Twice { what: format!("joint `{joint}`") }));
        }
        let numbers = reader.joint(&joint, entry)?;
        if numbers[0].is_none() {
            return Err(reader.error(entry, StateProblem::NoPosition { joint }));
        }
        for (column, number) in values.iter_mut().zip(numbers) {
            column[j] = number.unwrap_or(0.0);
        }
    }
    if let Some(missing) = given.iter().position(|given| !given) {
        let problem = StateProblem::MissingJoint { joint: joints[missing].to_owned() };
        return Err(InputError { source: source.clone(), span: None, problem, others: Vec::new() });
    }
    let [q, dq, z, dz] = values;
    Ok(JointState { q, dq, z, dz })
}

/// The text, and where pieces of it stand.
struct Reader<'a> {
    source: &'a SourceText,
    text: &'a str,
}

impl<'a> Reader<'a> {
    /// The numbers of one joint in the order of [`KEYS`].
    fn joint(&self, joint: &str, entry: &'a str) -> Result<[Option<f64>; 4], InputError<StateProblem>> {
        let mut numbers = [None; 4];
        for (name, value) in self.entries(entry, || format!("joint `{joint}`"))? {
            let key = self.string(name)?;
            let Some(k) = KEYS.iter().position(|known| *known == key) else {
                return Err(self.error(name, StateProblem::UnknownKey { joint: joint.to_owned(), key }));
            };
            if numbers[k].is_some() {
                let what = format!("`{key}` of joint `{joint}`");
                return Err(self.error(name, StateProblem::Twice { what }));
            }
            numbers[k] = Some(self.number(joint, KEYS[k], value)?);
        }
        Ok(numbers)
    }

    fn number(&self, joint: &str, key: &'static str, value: &'a str) -> Result<f64, InputError<StateProblem>> {
        // Names such as `inf`, which Rust reads too, are no JSON and have been refused before.
        match value.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(self.error(value, StateProblem::NotFinite { found: excerpt(value) })),
            Err(_) => {
                let (joint, found) = (joint.to_owned(), excerpt(value));
                Err(self.error(value, StateProblem::NotANumber { joint, key, found }))
            }
        }
    }

    /// The keys, with their quotes, and values of an object.
    fn entries(
        &self,
        text: &'a str,
        what: impl Fn() -> String,
    ) -> Result<Vec<(&'a str, &'a str)>, InputError<StateProblem>> {
        let start = text.trim_start_matches([' ', '\t', '\n', '\r']);
        let entries = serde_json::from_str::<Entries<'a>>(text);
        // Anything that is JSON may stand there, but only an object has a meaning.
        if !start.is_empty() && !start.starts_with('{') && serde_json::from_str::<&RawValue>(text).is_ok() {
            return Err(self.error(start, StateProblem::NotAnObject { what: what(), found: excerpt(start) }));
        }
        entries.map(|Entries(entries)| entries).map_err(|error| self.malformed(text, &error))
    }

    /// The text of a key.
    fn string(&self, quoted: &'a str) -> Result<String, InputError<StateProblem>> {
        serde_json::from_str(quoted).map_err(|error| self.malformed(quoted, &error))
    }

    /// What the parser says, at its place: lines and columns of bytes, both from one, in a piece of the text.
    fn malformed(&self, piece: &'a str, error: &serde_json::Error) -> InputError<StateProblem> {
        let lines = piece.split_inclusive('\n').take(error.line().saturating_sub(1));
        let mut at = lines.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
        at = at.min(piece.trim_end().len());
        while !piece.is_char_boundary(at) {
            at -= 1;
        }
        let rest = &piece[at..];
        for name in ["NaN", "Infinity"] {
            if rest.starts_with(name) {
                return self.error(&rest[..name.len()], StateProblem::NotFinite { found: format!("`{name}`") });
            }
        }
        let message = error.to_string();
        let place = format!(" at line {} column {}", error.line(), error.column());
        let end = rest.chars().next().map_or(0, char::len_utf8);
        self.error(&rest[..end], StateProblem::Json { message: message.replacen(&place, "", 1) })
    }

    /// An error about a piece of the text.
    fn error(&self, piece: &'a str, problem: StateProblem) -> InputError<StateProblem> {
        InputError { source: self.source.clone(), span: Some(self.span(piece)), problem, others: Vec::new() }
    }

    fn span(&self, piece: &'a str) -> Range<usize> {
        let start = (piece.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize).min(self.text.len());
        start..(start + piece.trim_end().len()).min(self.text.len())
    }
}

/// The beginning of what was written, on one line.
fn excerpt(text: &str) -> String {
    const MOST: usize = 30;
    let line = text.lines().next().unwrap_or_default().trim_end();
    let more = if line.chars().count() > MOST || text.trim_end().len() > line.len() { "…" } else { "" };
    let start: String = line.chars().take(MOST).collect();
    format!("`{start}{more}`")
}

/// An object as pieces of the text, in the order of the file, repetitions included.
struct Entries<'a>(Vec<(&'a str, &'a str)>);

impl<'de> Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor;
        impl<'de> Visitor<'de> for EntriesVisitor {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries<'de>, A::Error> {
                let mut entries = Vec::new();
                while let Some((key, value)) = map.next_entry::<&'de RawValue, &'de RawValue>()? {
                    entries.push((key.get(), value.get()));
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(EntriesVisitor)
    }
}
