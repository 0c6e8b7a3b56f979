//! Numbers that change with time, with their derivatives at one instant.

use alloc::vec;
use alloc::vec::Vec;

/// A number that changes with time, and its first four derivatives.
pub type Jet = [f64; 5];

/// What changes with time along several axes, with derivatives at one instant; with more than four from a [`JetsBuffer`].
///
/// ```
/// use forwardstep_core::controller::Jets;
///
/// // 0.5 t² and 3 at t = 2.
/// let jets = [[2.0, 2.0, 1.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0, 0.0]];
/// let target = Jets::from(&jets);
/// assert_eq!((target.len(), target.derivatives()), (2, 4));
/// assert_eq!(target.get(0).and_then(|axis| axis.get(1)), Some(&2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jets<'a> {
    /// Numbers of an axis.
    each: usize,
    /// Axis by axis.
    values: &'a [f64],
}

impl<'a> Jets<'a> {
    /// Every axis has so many derivatives at least.
    pub const LEAST: usize = 4;

    /// None of any axis.
    pub const NONE: Jets<'static> = Jets { each: Jets::LEAST + 1, values: &[] };

    /// How many axes there are.
    pub fn len(&self) -> usize {
        self.values.len() / self.each
    }

    /// Whether there is no axis.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// How many derivatives every axis has.
    pub fn derivatives(&self) -> usize {
        self.each - 1
    }

    /// The value of one axis and its derivatives.
    pub fn get(&self, axis: usize) -> Option<&'a [f64]> {
        self.iter().nth(axis)
    }

    /// One axis with four derivatives, zero where there is no such axis.
    pub fn jet(&self, axis: usize) -> Jet {
        self.get(axis).and_then(|axis| axis.first_chunk()).copied().unwrap_or_default()
    }

    /// Axis by axis.
    pub fn iter(&self) -> core::slice::ChunksExact<'a, f64> {
        self.values.chunks_exact(self.each)
    }
}

impl<'a> IntoIterator for Jets<'a> {
    type Item = &'a [f64];
    type IntoIter = core::slice::ChunksExact<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> From<&'a [Jet]> for Jets<'a> {
    fn from(jets: &'a [Jet]) -> Self {
        Jets { values: jets.as_flattened(), ..Jets::NONE }
    }
}

impl<'a, const AXES: usize> From<&'a [Jet; AXES]> for Jets<'a> {
    fn from(jets: &'a [Jet; AXES]) -> Self {
        Jets::from(&jets[..])
    }
}

/// Room for [`Jets`].
///
/// ```
/// use forwardstep_core::controller::JetsBuffer;
///
/// let mut target = JetsBuffer::new(1, 6);
/// target.iter_mut().for_each(|axis| axis.fill(0.5));
/// assert_eq!((target.jets().len(), target.jets().derivatives()), (1, 6));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JetsBuffer {
    each: usize,
    values: Vec<f64>,
}

impl JetsBuffer {
    /// Zeros: for so many axes their values and `derivatives` derivatives, [`Jets::LEAST`] at least.
    pub fn new(axes: usize, derivatives: usize) -> Self {
        let each = derivatives.max(Jets::LEAST) + 1;
        JetsBuffer { each, values: vec![0.0; axes * each] }
    }

    /// What is in it.
    pub fn jets(&self) -> Jets<'_> {
        Jets { each: self.each, values: &self.values }
    }

    /// Axis by axis.
    pub fn iter_mut(&mut self) -> core::slice::ChunksExactMut<'_, f64> {
        self.values.chunks_exact_mut(self.each)
    }
}
