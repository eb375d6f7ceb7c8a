//! `Sequence`: any number of elements of one space.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::value::Value;

use super::Space;
use super::batch::{concatenate, iterate};
use super::sampler::Streams;
use super::selection::Selection;
use super::weight::Weight;
use crate::value::fault::Fault;

/// The probability that a sampled sequence ends after an element, as in Gymnasium.
const END_PROBABILITY: f64 = 0.25;

/// Any number of elements of one space, in order: Gymnasium's `Sequence`.
///
/// ```
/// use gym_core::{Space, spaces::SequenceSpace};
/// let words = SequenceSpace::new(Space::discrete(26));
/// assert_eq!(words.to_string(), "Sequence(Discrete(26), stack=False)");
/// ```
///
/// An element is a [`Value::Tuple`]; of a [stacked](Self::stacked) space it is one array of all
/// elements, or, for tuples or dicts, a tuple or dict of such arrays. A sample has a geometric
/// length, 4 on average and never 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SequenceSpace {
    feature: Box<Space>,
    stack: bool,
}

impl SequenceSpace {
    /// Tuples of elements of `feature`.
    pub fn new(feature: impl Into<Space>) -> Self {
        Self {
            feature: Box::new(feature.into()),
            stack: false,
        }
    }

    /// Arrays of elements of `feature`, one after the other: Gymnasium's `stack=True`.
    pub fn stacked(feature: impl Into<Space>) -> Self {
        Self {
            stack: true,
            ..Self::new(feature)
        }
    }

    /// The space of each element of a sequence.
    pub fn feature_space(&self) -> &Space {
        &self.feature
    }

    /// Whether elements are stacked into arrays.
    pub fn is_stacked(&self) -> bool {
        self.stack
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        match value {
            Value::Tuple(items) if !self.stack => {
                items.iter().all(|item| self.feature.contains(item))
            }
            _ => self.check(value).is_ok(),
        }
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        for (i, item) in self.items(value)?.iter().enumerate() {
            self.feature
                .check_value(item)
                .map_err(|fault| fault.at(i))?;
        }
        Ok(())
    }

    /// The elements of a sequence.
    pub(super) fn items(&self, value: &Value) -> Result<Vec<Value>, Fault> {
        match value {
            _ if self.stack => iterate(&self.feature, value),
            Value::Tuple(items) => Ok(items.clone()),
            _ => Err(Fault::kind("a tuple", value)),
        }
    }

    /// The sequence of some elements.
    pub(super) fn collect(&self, items: Vec<Value>) -> Result<Value, Fault> {
        if self.stack {
            concatenate(&self.feature, &items.iter().collect::<Vec<_>>())
        } else {
            Ok(Value::Tuple(items))
        }
    }

    pub(super) fn draw<T: Weight>(
        &self,
        streams: &mut Streams,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let (lengths, member) = match selection {
            Selection::Sequence { lengths, member } => (lengths.as_deref(), &**member),
            _ => (None, &Selection::Any),
        };
        let length = match lengths {
            Some(lengths) => lengths[streams.own.choice(lengths.len())],
            None => streams.own.geometric(END_PROBABILITY) as usize,
        };
        let mut items = match std::mem::take(out) {
            Value::Tuple(items) if !self.stack => items,
            _ => Vec::new(),
        };
        items.resize(length, Value::Null);
        for item in &mut items {
            self.feature.draw(&mut streams.members[0], member, item);
        }
        // Samples of one space always collect into one value.
        *out = self.collect(items).unwrap_or_default();
    }
}

/// Prints as Gymnasium does: `Sequence(Discrete(26), stack=False)`.
impl fmt::Display for SequenceSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stack = if self.stack { "True" } else { "False" };
        write!(f, "Sequence({}, stack={stack})", self.feature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::TupleSpace;

    #[test]
    fn contains_tuples_of_elements() {
        let space = SequenceSpace::new(Space::discrete(2));
        let tuple = |items: &[i64]| Value::Tuple(items.iter().map(|&i| Value::Int(i)).collect());
        assert!(space.contains(&tuple(&[])) && space.contains(&tuple(&[0, 1, 1])));
        assert!(
            !space.contains(&tuple(&[0, 2])) && !space.contains(&Value::Array([0i64, 1].into()))
        );
        assert_eq!(
            space.check(&tuple(&[0, 2])).unwrap_err().to_string(),
            "[1]: 2 is not between 0 and 1"
        );
    }

    #[test]
    fn stacked_sequences_are_arrays() {
        let space = SequenceSpace::stacked(Space::discrete(2));
        let contains = |array: crate::value::Array| space.contains(&Value::Array(array));
        assert!(
            contains([0i64, 1].into())
                && contains([1u8].into())
                && contains(Vec::<i64>::new().into())
        );
        assert!(!contains([2i64].into()) && !contains([0.0f64].into()));
        assert!(!space.contains(&Value::Tuple(vec![Value::Int(0)])));
    }

    #[test]
    fn stacked_tuples_are_tuples_of_arrays_of_one_length() {
        let pair = TupleSpace::new([Space::discrete(2), Space::discrete(3)]);
        let space = SequenceSpace::stacked(pair);
        let value = |a: &[i64], b: &[i64]| {
            Value::Tuple(
                [a, b]
                    .map(|numbers| Value::Array(numbers.to_vec().into()))
                    .into(),
            )
        };
        assert!(space.contains(&value(&[0, 1], &[2, 2])));
        assert!(!space.contains(&value(&[0, 1], &[2])) && !space.contains(&value(&[0], &[3])));
    }

    #[test]
    fn prints_as_gymnasium() {
        let space = SequenceSpace::stacked(SequenceSpace::new(Space::discrete(2)));
        assert_eq!(
            space.to_string(),
            "Sequence(Sequence(Discrete(2), stack=False), stack=True)"
        );
    }
}
