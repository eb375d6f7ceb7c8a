//! `Tuple`: members in order.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::value::{Result, Value};

use super::sampler::Streams;
use super::selection::Selection;
use super::weight::Weight;
use super::{Space, write_list};
use crate::value::fault::Fault;

/// A fixed number of members, each from its own space: Gymnasium's `Tuple`.
///
/// ```
/// use gym_core::{Space, spaces::TupleSpace};
/// let hand = TupleSpace::new([Space::discrete(32), Space::discrete(11), Space::discrete(2)]);
/// assert_eq!(hand.to_string(), "Tuple(Discrete(32), Discrete(11), Discrete(2))");
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TupleSpace {
    spaces: Vec<Space>,
}

impl TupleSpace {
    /// The members in order; there may be none.
    pub fn new(spaces: impl IntoIterator<Item = Space>) -> Self {
        Self {
            spaces: spaces.into_iter().collect(),
        }
    }

    /// The members.
    pub fn spaces(&self) -> &[Space] {
        &self.spaces
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        let Value::Tuple(items) = value else {
            return false;
        };
        items.len() == self.spaces.len()
            && self
                .spaces
                .iter()
                .zip(items)
                .all(|(space, item)| space.contains(item))
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        self.each(value, Space::check_value)
    }

    /// Calls `f` with each member space and its member of `value`. A fault names the member.
    pub(super) fn each<'a>(
        &'a self,
        value: &'a Value,
        mut f: impl FnMut(&'a Space, &'a Value) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut members = self.members(value)?.enumerate();
        members.try_for_each(|(i, (space, member))| f(space, member).map_err(|fault| fault.at(i)))
    }

    /// Returns the space whose members are the results of `f` for the members of this space.
    pub(super) fn map(&self, f: impl FnMut(&Space) -> Result<Space>) -> Result<Self> {
        let spaces = self.spaces.iter().map(f).collect::<Result<_>>()?;
        Ok(Self { spaces })
    }

    /// Returns the value whose members are the results of `f` for the member spaces.
    pub(super) fn value(&self, f: impl FnMut(&Space) -> Result<Value>) -> Result<Value> {
        self.spaces
            .iter()
            .map(f)
            .collect::<Result<_>>()
            .map(Value::Tuple)
    }

    /// Each member space with its member of `value`; `None` if the numbers of members differ.
    pub(super) fn members<'a>(
        &'a self,
        value: &'a Value,
    ) -> Result<impl Iterator<Item = (&'a Space, &'a Value)>, Fault> {
        let Value::Tuple(items) = value else {
            return Err(Fault::kind("a tuple", value));
        };
        let (actual, expected) = (items.len(), self.spaces.len());
        if actual != expected {
            return Err(Fault::new(format!(
                "there are {actual} members and should be {expected}"
            )));
        }
        Ok(self.spaces.iter().zip(items))
    }

    /// The items of `out`, which becomes a tuple with an item for each member.
    pub(super) fn items_of<'a>(&self, out: &'a mut Value) -> &'a mut [Value] {
        if !matches!(out, Value::Tuple(items) if items.len() == self.spaces.len()) {
            *out = Value::Tuple(vec![Value::Null; self.spaces.len()]);
        }
        match out {
            Value::Tuple(items) => items,
            _ => unreachable!("`out` was just made a tuple"),
        }
    }

    pub(super) fn draw<T: Weight>(
        &self,
        streams: &mut Streams,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let spaces = self.spaces.iter().zip(&mut streams.members);
        for (i, ((space, streams), out)) in spaces.zip(self.items_of(out)).enumerate() {
            space.draw(streams, selection.at(i), out);
        }
    }
}

/// Prints as Gymnasium does: `Tuple(Discrete(3), Discrete(2))`.
impl fmt::Display for TupleSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_list(f, "Tuple", &self.spaces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> TupleSpace {
        TupleSpace::new([
            Space::discrete(2),
            TupleSpace::new([Space::discrete(3)]).into(),
        ])
    }

    fn value(a: i64, b: i64) -> Value {
        Value::Tuple(vec![Value::Int(a), Value::Tuple(vec![Value::Int(b)])])
    }

    #[test]
    fn contains_members_in_order() {
        assert!(space().contains(&value(1, 2)));
        assert!(!space().contains(&value(2, 2)) && !space().contains(&value(1, 3)));
        assert!(
            !space().contains(&Value::Tuple(vec![Value::Int(1)]))
                && !space().contains(&Value::Int(1))
        );
        assert!(TupleSpace::new([]).contains(&Value::Tuple(vec![])));
    }

    #[test]
    fn faults_name_the_place() {
        let fault = |value: &Value| space().check(value).unwrap_err().to_string();
        assert_eq!(fault(&value(1, 5)), "[1][0]: 5 is not between 0 and 2");
        assert_eq!(
            fault(&Value::Tuple(vec![])),
            "there are 0 members and should be 2"
        );
        assert_eq!(
            fault(&Value::Text("a".into())),
            "expected a tuple, not a text"
        );
    }

    #[test]
    fn prints_as_gymnasium() {
        assert_eq!(
            space().to_string(),
            "Tuple(Discrete(2), Tuple(Discrete(3)))"
        );
        assert_eq!(TupleSpace::new([]).to_string(), "Tuple()");
    }
}
