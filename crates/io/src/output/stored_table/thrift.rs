//! Thrift's compact protocol, in which Parquet writes everything but the numbers: only what it takes to find some fields and
//! to pass over all others.
//!
//! Whatever the bytes are, reading ends with them: every element of a list takes a byte at least, nothing is set aside because
//! a length says so, and no value nests deeper than [`DEEPEST`].

use std::io::Read;

use super::ParquetProblem;

/// Values of a footer nest eight deep.
const DEEPEST: usize = 16;
/// A variable-length integer of 64 bits.
const LONGEST_VARINT: u32 = 10;

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bool(bool),
    Byte,
    Integer,
    Double,
    Bytes,
    List,
    Map,
    Struct,
}

impl Kind {
    fn of(code: u8) -> Result<Kind, ParquetProblem> {
        Ok(match code {
            1 => Kind::Bool(true),
            2 => Kind::Bool(false),
            3 => Kind::Byte,
            4..=6 => Kind::Integer,
            7 => Kind::Double,
            8 => Kind::Bytes,
            9 | 10 => Kind::List,
            11 => Kind::Map,
            12 => Kind::Struct,
            _ => return Err(ParquetProblem::Malformed),
        })
    }
}

/// A number of a field of a structure, with the type of its value.
pub(super) type Field = (i64, Kind);

/// Reads values one after the other.
pub(super) struct Thrift<R>(pub(super) R);

impl<R: Read> Thrift<R> {
    fn byte(&mut self) -> Result<u8, ParquetProblem> {
        let mut byte = [0];
        self.0.read_exact(&mut byte)?;
        Ok(byte[0])
    }

    fn varint(&mut self) -> Result<u64, ParquetProblem> {
        let mut value = 0_u64;
        for k in 0..LONGEST_VARINT {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f).checked_shl(7 * k).unwrap_or(0);
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(ParquetProblem::Malformed)
    }

    /// A whole number of 16, 32 or 64 bits.
    pub(super) fn integer(&mut self) -> Result<i64, ParquetProblem> {
        let folded = self.varint()?;
        Ok((folded >> 1).cast_signed() ^ -((folded & 1).cast_signed()))
    }

    /// A text of at most `longest` bytes.
    pub(super) fn text(&mut self, longest: u64) -> Result<String, ParquetProblem> {
        let length = self.varint()?;
        if length > longest {
            return Err(ParquetProblem::Malformed);
        }
        let mut bytes = Vec::new();
        (&mut self.0).take(length).read_to_end(&mut bytes)?;
        if bytes.len() as u64 != length {
            return Err(ParquetProblem::Ended);
        }
        String::from_utf8(bytes).map_err(|_| ParquetProblem::Malformed)
    }

    /// Calls `field` for every field of a structure, which answers whether it took the value; else it is passed over.
    pub(super) fn fields(
        &mut self,
        mut field: impl FnMut(&mut Self, Field) -> Result<bool, ParquetProblem>,
    ) -> Result<(), ParquetProblem> {
        self.fields_within(DEEPEST, &mut |own, found, depth| match field(own, found)? {
            true => Ok(()),
            false => own.pass(found.1, depth),
        })
    }

    fn fields_within(
        &mut self,
        depth: usize,
        field: &mut dyn FnMut(&mut Self, Field, usize) -> Result<(), ParquetProblem>,
    ) -> Result<(), ParquetProblem> {
        let inner = depth.checked_sub(1).ok_or(ParquetProblem::Malformed)?;
        let mut number = 0_i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(());
            }
            number = match head >> 4 {
                0 => self.integer()?,
                step => number.checked_add(i64::from(step)).ok_or(ParquetProblem::Malformed)?,
            };
            field(self, (number, Kind::of(head & 0x0f)?), inner)?;
        }
    }

    /// The head of a list: how many elements it says it has, and their type.
    fn list(&mut self) -> Result<(u64, Kind), ParquetProblem> {
        let head = self.byte()?;
        let length = match head >> 4 {
            15 => self.varint()?,
            length => u64::from(length),
        };
        Ok((length, Kind::of(head & 0x0f)?))
    }

    /// Calls `element` for every structure of a list of them.
    pub(super) fn structures(
        &mut self,
        mut element: impl FnMut(&mut Self) -> Result<(), ParquetProblem>,
    ) -> Result<(), ParquetProblem> {
        let (length, kind) = self.list()?;
        if kind != Kind::Struct {
            return Err(ParquetProblem::Malformed);
        }
        (0..length).try_for_each(|_| element(self))
    }

    fn pass(&mut self, kind: Kind, depth: usize) -> Result<(), ParquetProblem> {
        match kind {
            Kind::Bool(_) => Ok(()),
            Kind::Byte => self.byte().map(|_| ()),
            Kind::Integer => self.varint().map(|_| ()),
            Kind::Double => self.pass_bytes(8),
            Kind::Bytes => {
                let length = self.varint()?;
                self.pass_bytes(length)
            }
            Kind::List => {
                let (length, kind) = self.list()?;
                let inner = depth.checked_sub(1).ok_or(ParquetProblem::Malformed)?;
                (0..length).try_for_each(|_| self.pass_element(kind, inner))
            }
            Kind::Map => {
                let length = self.varint()?;
                if length == 0 {
                    return Ok(());
                }
                let kinds = self.byte()?;
                let (key, value) = (Kind::of(kinds >> 4)?, Kind::of(kinds & 0x0f)?);
                let inner = depth.checked_sub(1).ok_or(ParquetProblem::Malformed)?;
                (0..length).try_for_each(|_| {
                    self.pass_element(key, inner)?;
                    self.pass_element(value, inner)
                })
            }
            Kind::Struct => self.fields_within(depth, &mut |own, (_, kind), inner| own.pass(kind, inner)),
        }
    }

    /// Within lists and maps, truth takes a byte of its own.
    fn pass_element(&mut self, kind: Kind, depth: usize) -> Result<(), ParquetProblem> {
        match kind {
            Kind::Bool(_) => self.byte().map(|_| ()),
            kind => self.pass(kind, depth),
        }
    }

    fn pass_bytes(&mut self, length: u64) -> Result<(), ParquetProblem> {
        let passed = std::io::copy(&mut (&mut self.0).take(length), &mut std::io::sink())?;
        if passed == length { Ok(()) } else { Err(ParquetProblem::Ended) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thrift(bytes: &[u8]) -> Thrift<&[u8]> {
        Thrift(bytes)
    }

    #[test]
    fn integers_are_folded_and_end() {
        for (bytes, value) in [(&[0_u8][..], 0), (&[1], -1), (&[2], 1), (&[0xac, 0x02], 150)] {
            assert_eq!(thrift(bytes).integer().ok(), Some(value));
        }
        let least = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01];
        assert_eq!(thrift(&least).integer().ok(), Some(i64::MIN));
        assert!(matches!(thrift(&[0xff; 11]).integer(), Err(ParquetProblem::Malformed)));
        assert!(matches!(thrift(&[0xff; 3]).integer(), Err(ParquetProblem::Ended)));
    }

    #[test]
    fn a_length_sets_nothing_aside() {
        let long = [0xff, 0xff, 0xff, 0xff, 0x0f, b'a'];
        assert!(matches!(thrift(&long).text(u64::MAX), Err(ParquetProblem::Ended)));
        assert!(matches!(thrift(&long).text(9), Err(ParquetProblem::Malformed)));
        // A list of 2^32 − 1 truths of which one is there.
        let truths = [0x19, 0xf1, 0xff, 0xff, 0xff, 0xff, 0x0f, 1];
        assert!(matches!(thrift(&truths).fields(|_, _| Ok(false)), Err(ParquetProblem::Ended)));
    }

    #[test]
    fn structures_nest_only_so_deep() {
        let deep = |levels: usize| [vec![0x1c; levels], vec![0; levels + 1]].concat();
        assert!(thrift(&deep(DEEPEST - 1)).fields(|_, _| Ok(false)).is_ok());
        assert!(matches!(thrift(&deep(DEEPEST)).fields(|_, _| Ok(false)), Err(ParquetProblem::Malformed)));
        assert!(matches!(thrift(&vec![0x19; 1 << 20]).fields(|_, _| Ok(false)), Err(ParquetProblem::Malformed)));
    }

    #[test]
    fn what_is_not_asked_for_is_passed_over() {
        // 1: map {1: "ab"}, 2: double, 3: true, 4: list of two structures, 9: integer 5, which is asked for.
        let bytes = [
            0x1b, 1, 0x58, 2, 2, b'a', b'b', 0x17, 0, 0, 0, 0, 0, 0, 0, 0, 0x11, 0x19, 0x2c, 0, 0x15, 2, 0, 0x55, 10, 0,
        ];
        let mut found = Vec::new();
        let read = thrift(&bytes).fields(|own, field| {
            if field != (9, Kind::Integer) {
                return Ok(false);
            }
            found.push(own.integer()?);
            Ok(true)
        });
        assert!(read.is_ok());
        assert_eq!(found, [5]);
    }
}
