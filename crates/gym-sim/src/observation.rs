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

    /// Returns where each part is in the observation.
    pub(crate) fn layout(&self) -> Layout {
        let mut parts = self.parts.clone();
        parts.sort_by_key(|part| part.name);
        Layout {
            members: members(&parts, 0),
            len: self.numbers.len(),
        }
    }

    /// Writes the numbers to `out`, an observation of the layout's space.
    pub(crate) fn write(&self, layout: &Layout, flat: bool, dtype: DType, out: &mut Value) {
        if flat {
            return fill(out, dtype, &[self.numbers.len()], &self.numbers);
        }
        self.write_dict(&layout.members, dtype, out);
    }

    fn write_dict(&self, members: &[(&str, Member)], dtype: DType, out: &mut Value) {
        let fits = |entries: &Vec<(String, Value)>| {
            let mut both = entries.iter().zip(members);
            entries.len() == members.len() && both.all(|((key, _), (name, _))| key == name)
        };
        if !matches!(out, Value::Dict(entries) if fits(entries)) {
            let entries = members.iter();
            *out = Value::Dict(
                entries
                    .map(|(name, _)| ((*name).to_owned(), Value::Null))
                    .collect(),
            );
        }
        let Value::Dict(entries) = out else { return };
        for ((_, member), (_, value)) in members.iter().zip(entries) {
            match member {
                Member::Dict(members) => self.write_dict(members, dtype, value),
                Member::Array(part) => {
                    let length: usize = part.shape.iter().product();
                    let numbers = &self.numbers[part.first..part.first + length];
                    fill(value, dtype, &part.shape, numbers);
                }
            }
        }
    }
}

/// What an observation is made of, sorted by name.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    members: Vec<(&'static str, Member)>,
    len: usize,
}

/// A member of a dict.
#[derive(Clone, Debug)]
enum Member {
    Array(Part),
    Dict(Vec<(&'static str, Member)>),
}

impl Layout {
    /// Returns the observation space.
    pub(crate) fn space(&self, flat: bool, dtype: DType) -> Result<Space> {
        if flat {
            reals(&[self.len], dtype)
        } else {
            dict(&self.members, dtype)
        }
    }
}

/// The members of a dict, of whose parts the names go on at `from`: what is before is the dict's.
fn members(parts: &[Part], from: usize) -> Vec<(&'static str, Member)> {
    let word = |part: &Part| {
        let rest = part.name.get(from..).unwrap_or_default();
        rest.split_once('/').map_or(rest, |(word, _)| word)
    };
    let groups = parts.chunk_by(|a, b| word(a) == word(b));
    let members = groups.map(|group| {
        let (part, word) = (&group[0], word(&group[0]));
        let end = from + word.len();
        let member = if part.name.len() > end {
            Member::Dict(members(group, end + 1))
        } else {
            Member::Array(part.clone())
        };
        (word, member)
    });
    members.collect()
}

fn dict(members: &[(&'static str, Member)], dtype: DType) -> Result<Space> {
    let spaces = members.iter().map(|(name, member)| {
        let space = match member {
            Member::Array(part) => reals(&part.shape, dtype)?,
            Member::Dict(members) => dict(members, dtype)?,
        };
        Ok((*name, space))
    });
    Ok(DictSpace::new(spaces.collect::<Result<Vec<_>>>()?)?.into())
}

fn reals(shape: &[usize], dtype: DType) -> Result<Space> {
    Ok(BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, shape, dtype)?.into())
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
