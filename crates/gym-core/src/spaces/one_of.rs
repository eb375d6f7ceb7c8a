//! `OneOf`: a value of one of several spaces.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::value::{Error, Result, Value};

use super::sampler::Streams;
use super::selection::Selection;
use super::weight::Weight;
use super::{Space, invalid, write_list};
use crate::value::fault::Fault;

/// The index of one of several spaces, with a value of it: Gymnasium's `OneOf`.
///
/// ```
/// use gym_core::{Space, Value, spaces::OneOfSpace};
/// let space: Space = OneOfSpace::new([Space::discrete(3), Space::boxed([0.0], [1.0])])?.into();
/// assert!(space.contains(&Value::OneOf(1, Box::new(Value::Array([0.5f32].into())))));
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// A sample has a uniform index.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct OneOfSpace {
    spaces: Vec<Space>,
}

impl OneOfSpace {
    /// The spaces to choose from.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] for an empty list.
    pub fn new(spaces: impl IntoIterator<Item = Space>) -> Result<Self> {
        let spaces: Vec<_> = spaces.into_iter().collect();
        if spaces.is_empty() {
            return invalid("OneOf() has no spaces to choose from: give at least one");
        }
        Ok(Self { spaces })
    }

    /// The spaces to choose from.
    pub fn spaces(&self) -> &[Space] {
        &self.spaces
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        let Value::OneOf(index, value) = value else {
            return false;
        };
        self.spaces
            .get(*index)
            .is_some_and(|space| space.contains(value))
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let (_, space, member) = self.chosen(value)?;
        space.check_value(member).map_err(|fault| fault.at(1))
    }

    /// Returns the index, the space with this index, and the element of this space.
    pub(super) fn chosen<'a>(
        &'a self,
        value: &'a Value,
    ) -> Result<(usize, &'a Space, &'a Value), Fault> {
        let Value::OneOf(index, value) = value else {
            return Err(Fault::kind("an index with a value", value));
        };
        match self.spaces.get(*index) {
            Some(space) => Ok((*index, space, value)),
            None => {
                let last = self.spaces.len() - 1;
                Err(Fault::new(format!("the index {index} is not between 0 and {last}")).at(0))
            }
        }
    }

    pub(super) fn draw<T: Weight>(
        &self,
        streams: &mut Streams,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let chosen = streams.own.choice(self.spaces.len());
        if !matches!(out, Value::OneOf(..)) {
            *out = Value::OneOf(0, Box::new(Value::Null));
        }
        let Value::OneOf(index, value) = out else {
            return;
        };
        *index = chosen;
        self.spaces[chosen].draw(&mut streams.members[chosen], selection.at(chosen), value);
    }
}

/// Prints as Gymnasium does: `OneOf(Discrete(3), Discrete(2))`.
impl fmt::Display for OneOfSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_list(f, "OneOf", &self.spaces)
    }
}

/// The stored form, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    spaces: Vec<Space>,
}

impl TryFrom<Description> for OneOfSpace {
    type Error = Error;

    fn try_from(Description { spaces }: Description) -> Result<Self> {
        Self::new(spaces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> OneOfSpace {
        OneOfSpace::new([Space::discrete(2), Space::discrete(5)]).unwrap()
    }

    fn value(index: usize, i: i64) -> Value {
        Value::OneOf(index, Box::new(Value::Int(i)))
    }

    #[test]
    fn needs_a_space() {
        assert!(
            OneOfSpace::new([])
                .unwrap_err()
                .to_string()
                .contains("give at least one")
        );
        assert!(serde_json::from_str::<OneOfSpace>(r#"{"spaces":[]}"#).is_err());
    }

    #[test]
    fn contains_values_of_the_chosen_space() {
        assert!(space().contains(&value(0, 1)) && space().contains(&value(1, 4)));
        assert!(!space().contains(&value(0, 4)) && !space().contains(&value(2, 0)));
        assert!(!space().contains(&Value::Int(0)) && !space().contains(&Value::Tuple(vec![])));
    }

    #[test]
    fn faults_name_the_place() {
        let fault = |value: Value| space().check(&value).unwrap_err().to_string();
        assert_eq!(fault(value(0, 4)), "[1]: 4 is not between 0 and 1");
        assert_eq!(
            fault(value(2, 0)),
            "[0]: the index 2 is not between 0 and 1"
        );
    }

    #[test]
    fn prints_as_gymnasium() {
        assert_eq!(space().to_string(), "OneOf(Discrete(2), Discrete(5))");
    }
}
