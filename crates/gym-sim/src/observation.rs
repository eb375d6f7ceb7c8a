//! Observations: named parts, each an array of numbers.

use gym_core::spaces::{BoxSpace, DictSpace, array_of};
use gym_core::{Array, DType, Result, Space, Value};

/// An observation under construction: a task adds its numbers part by part.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    numbers: Vec<f64>,
    /// The parts, in the order in which they were first added.
    parts: Vec<Part>,
    /// The number of parts added since the last [`clear`](Self::clear).
    filled: usize,
}

#[derive(Clone, Debug)]
struct Part {
    name: &'static str,
    shape: Vec<usize>,
    /// The index of its first number.
    first: usize,
}

impl Observation {
    /// Adds numbers to an observation of one part.
    pub fn extend(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.vector("observation", numbers);
    }

    /// Adds a scalar.
    pub fn scalar(&mut self, name: &'static str, number: f64) {
        self.part(name, &[], [number]);
    }

    /// Adds a vector. A name of two words, such as `goal/door`, is that of a part of a dict `goal`.
    pub fn vector(&mut self, name: &'static str, numbers: impl IntoIterator<Item = f64>) {
        self.part(name, &[0], numbers);
    }

    /// Adds a matrix by its rows.
    pub fn rows<const N: usize>(
        &mut self,
        name: &'static str,
        rows: impl IntoIterator<Item = [f64; N]>,
    ) {
        self.part(name, &[0, N], rows.into_iter().flatten());
    }

    /// Adds a part. If `shape` begins with 0, the number of `numbers` decides this length.
    fn part(
        &mut self,
        name: &'static str,
        shape: &[usize],
        numbers: impl IntoIterator<Item = f64>,
    ) {
        let first = self.numbers.len();
        self.numbers.extend(numbers);
        if self.filled == self.parts.len() {
            let mut shape = shape.to_vec();
            if let Some(length) = shape.first_mut() {
                *length = 1;
            }
            let row: usize = shape.iter().product();
            if let Some(length) = shape.first_mut() {
                *length = (self.numbers.len() - first) / row;
            }
            self.parts.push(Part { name, shape, first });
        }
        self.filled += 1;
    }

    /// Removes the numbers, but not the parts. The task must then add the same parts in the same
    /// order.
    pub(crate) fn clear(&mut self) {
        self.numbers.clear();
        self.filled = 0;
    }

    /// Returns the parts, sorted by name.
    pub(crate) fn layout(&self) -> Layout {
        let mut parts = self.parts.clone();
        parts.sort_by_key(|part| part.name);
        let len = self.numbers.len();
        Layout { parts, len }
    }

    /// Writes the numbers to `out`, an observation of the layout's space.
    pub(crate) fn write(&self, layout: &Layout, flat: bool, dtype: DType, out: &mut Value) {
        if flat {
            return fill(out, dtype, &[self.numbers.len()], &self.numbers);
        }
        self.write_parts(&layout.parts, 0, dtype, out);
    }

    /// Writes parts to a dict. Their names begin at `from`: what is before is that of the dict.
    fn write_parts(&self, parts: &[Part], from: usize, dtype: DType, out: &mut Value) {
        let fits = |entries: &Vec<(String, Value)>| {
            let mut both = entries.iter().zip(groups(parts, from));
            entries.len() == groups(parts, from).count()
                && both.all(|((key, _), group)| key == group[0].word(from))
        };
        if !matches!(out, Value::Dict(entries) if fits(entries)) {
            let entries = groups(parts, from);
            let entries = entries.map(|group| (group[0].word(from).to_owned(), Value::Null));
            *out = Value::Dict(entries.collect());
        }
        let Value::Dict(entries) = out else { return };
        for (group, (key, value)) in groups(parts, from).zip(entries) {
            let part = &group[0];
            if part.name.len() > from + key.len() {
                self.write_parts(group, from + key.len() + 1, dtype, value);
                continue;
            }
            let length: usize = part.shape.iter().product();
            let numbers = &self.numbers[part.first..part.first + length];
            fill(value, dtype, &part.shape, numbers);
        }
    }
}

impl Part {
    /// The word of its name that begins at `from`.
    fn word(&self, from: usize) -> &'static str {
        let rest = self.name.get(from..).unwrap_or_default();
        rest.split_once('/').map_or(rest, |(word, _)| word)
    }
}

/// The parts by the word of their names that begins at `from`.
fn groups(parts: &[Part], from: usize) -> impl Iterator<Item = &[Part]> {
    parts.chunk_by(move |a, b| a.word(from) == b.word(from))
}

/// The parts of an observation, sorted by name.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    parts: Vec<Part>,
    len: usize,
}

impl Layout {
    /// Returns the observation space.
    pub(crate) fn space(&self, flat: bool, dtype: DType) -> Result<Space> {
        let reals = |shape: &[usize]| -> Result<Space> {
            let space = BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, shape, dtype)?;
            Ok(space.into())
        };
        if flat {
            return reals(&[self.len]);
        }
        members(&self.parts, 0, &reals)
    }
}

/// The dict of parts, whose names begin at `from`.
fn members(
    parts: &[Part],
    from: usize,
    reals: &dyn Fn(&[usize]) -> Result<Space>,
) -> Result<Space> {
    let members = groups(parts, from).map(|group| {
        let (part, word) = (&group[0], group[0].word(from));
        let space = if part.name.len() > from + word.len() {
            members(group, from + word.len() + 1, reals)?
        } else {
            reals(&part.shape)?
        };
        Ok((word, space))
    });
    Ok(DictSpace::new(members.collect::<Result<Vec<_>>>()?)?.into())
}

/// Writes `numbers` to `out` as an array with the type `dtype` and the shape `shape`.
fn fill(out: &mut Value, dtype: DType, shape: &[usize], numbers: &[f64]) {
    let array: &mut Array = array_of(out, dtype, shape);
    if let Some(slice) = array.as_mut_slice::<f64>() {
        slice.copy_from_slice(numbers);
    } else if let Some(slice) = array.as_mut_slice::<f32>() {
        for (to, from) in slice.iter_mut().zip(numbers) {
            *to = *from as f32;
        }
    }
}
