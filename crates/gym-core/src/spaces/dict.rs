//! `Dict`: named members.

use std::collections::BTreeSet;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::value::{Error, Result, Value, numpy_fmt};

use super::sampler::Streams;
use super::selection::Selection;
use super::weight::Weight;
use super::{Space, invalid};
use crate::value::fault::Fault;

/// Values with a member per key, each from its own space: Gymnasium's `Dict`.
///
/// ```
/// use gym_core::{Space, spaces::DictSpace};
/// let space = DictSpace::new([("b", Space::discrete(4)), ("a", Space::discrete(2))])?;
/// assert_eq!(space.to_string(), "Dict('a': Discrete(2), 'b': Discrete(4))");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// The order of the keys is that of samples, of seeds and of the flat form; it matters neither to
/// [`contains`](Space::contains) nor to equality.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct DictSpace {
    spaces: Vec<(String, Space)>,
}

impl DictSpace {
    /// The members, sorted by key, as Gymnasium sorts a plain `dict`.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if a key occurs twice.
    pub fn new<K: Into<String>>(spaces: impl IntoIterator<Item = (K, Space)>) -> Result<Self> {
        let mut space = Self::in_order(spaces)?;
        space.spaces.sort_by(|(a, _), (b, _)| a.cmp(b));
        Ok(space)
    }

    /// The members with their keys in the order given.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if a key occurs twice.
    pub fn in_order<K: Into<String>>(spaces: impl IntoIterator<Item = (K, Space)>) -> Result<Self> {
        let spaces: Vec<_> = spaces
            .into_iter()
            .map(|(key, space)| (key.into(), space))
            .collect();
        let mut keys = BTreeSet::new();
        match spaces.iter().find(|(key, _)| !keys.insert(key)) {
            None => Ok(Self { spaces }),
            Some((key, _)) => invalid(format!(
                "the key {key:?} of a dict occurs twice: rename one"
            )),
        }
    }

    /// Keys and members, in order.
    pub fn spaces(&self) -> &[(String, Space)] {
        &self.spaces
    }

    /// The member under a key.
    pub fn get(&self, key: &str) -> Option<&Space> {
        self.spaces
            .iter()
            .find_map(|(name, space)| (name == key).then_some(space))
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        let Value::Dict(entries) = value else {
            return false;
        };
        entries.len() == self.spaces.len()
            && self
                .spaces
                .iter()
                .all(|(key, space)| value.get(key).is_some_and(|member| space.contains(member)))
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        self.each(value, Space::check_value)
    }

    /// Calls `f` with each member space and the value under its key. A fault names the key.
    pub(super) fn each<'a>(
        &'a self,
        value: &'a Value,
        mut f: impl FnMut(&'a Space, &'a Value) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut members = self.spaces.iter().zip(self.members(value)?);
        members.try_for_each(|((key, _), (space, member))| {
            f(space, member).map_err(|fault| fault.under(key))
        })
    }

    /// Returns the space whose members are the results of `f` for the members of this space.
    pub(super) fn map(&self, mut f: impl FnMut(&Space) -> Result<Space>) -> Result<Self> {
        let spaces = self
            .spaces
            .iter()
            .map(|(key, space)| Ok((key.clone(), f(space)?)));
        Ok(Self {
            spaces: spaces.collect::<Result<_>>()?,
        })
    }

    /// Returns the value whose members are the results of `f` for the member spaces.
    pub(super) fn value(&self, mut f: impl FnMut(&Space) -> Result<Value>) -> Result<Value> {
        let entries = self
            .spaces
            .iter()
            .map(|(key, space)| Ok((key.clone(), f(space)?)));
        entries.collect::<Result<_>>().map(Value::Dict)
    }

    /// The entries of `out`, which becomes a dict with the keys of the space, in its order.
    pub(super) fn entries_of<'a>(&self, out: &'a mut Value) -> &'a mut [(String, Value)] {
        if !matches!(out, Value::Dict(entries) if self.has_keys(entries)) {
            let entries = self
                .spaces
                .iter()
                .map(|(key, _)| (key.clone(), Value::Null));
            *out = Value::Dict(entries.collect());
        }
        match out {
            Value::Dict(entries) => entries,
            _ => unreachable!("`out` was just made a dict"),
        }
    }

    /// Whether `entries` have the keys of the space, in its order.
    pub(super) fn has_keys(&self, entries: &[(String, Value)]) -> bool {
        entries.len() == self.spaces.len()
            && entries.iter().zip(&self.spaces).all(|(a, b)| a.0 == b.0)
    }

    /// Each member space with the value under its key, if the keys equal the space's keys.
    pub(super) fn members<'a>(
        &'a self,
        value: &'a Value,
    ) -> Result<impl Iterator<Item = (&'a Space, &'a Value)>, Fault> {
        let Value::Dict(entries) = value else {
            return Err(Fault::kind("a dict", value));
        };
        let in_order = self.has_keys(entries);
        if !in_order {
            self.check_keys(entries)?;
        }
        let members = self.spaces.iter().enumerate();
        Ok(members.filter_map(move |(i, (key, space))| match in_order {
            true => Some((space, &entries[i].1)),
            false => Some((space, value.get(key)?)),
        }))
    }

    fn check_keys(&self, entries: &[(String, Value)]) -> Result<(), Fault> {
        if let Some((key, _)) = entries.iter().find(|(key, _)| self.get(key).is_none()) {
            return Err(Fault::new(format!("the space has no key {key:?}")));
        }
        if entries.len() > self.spaces.len() {
            return Err(Fault::new("a key occurs twice"));
        }
        let has = |name: &str| entries.iter().any(|(key, _)| key == name);
        match self.spaces.iter().find(|(key, _)| !has(key)) {
            Some((key, _)) => Err(Fault::new(format!("the key {key:?} is missing"))),
            None => Ok(()),
        }
    }

    pub(super) fn draw<T: Weight>(
        &self,
        streams: &mut Streams,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let entries = self.entries_of(out);
        for (((key, space), streams), (_, out)) in
            self.spaces.iter().zip(&mut streams.members).zip(entries)
        {
            space.draw(streams, selection.under(key), out);
        }
    }
}

/// The order of the keys does not matter.
impl PartialEq for DictSpace {
    fn eq(&self, other: &Self) -> bool {
        self.spaces.len() == other.spaces.len()
            && self
                .spaces
                .iter()
                .all(|(key, space)| other.get(key) == Some(space))
    }
}

/// Prints as Gymnasium does: `Dict('a': Discrete(2), 'b': Discrete(4))`.
impl fmt::Display for DictSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Dict(")?;
        for (i, (key, space)) in self.spaces.iter().enumerate() {
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}{}: {space}", numpy_fmt::quoted(key))?;
        }
        f.write_str(")")
    }
}

/// The stored form, before it is checked: a list of pairs, which keeps the order.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    spaces: Vec<(String, Space)>,
}

impl TryFrom<Description> for DictSpace {
    type Error = Error;

    fn try_from(Description { spaces }: Description) -> Result<Self> {
        Self::in_order(spaces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> DictSpace {
        DictSpace::new([("b", Space::discrete(4)), ("a", Space::discrete(2))]).unwrap()
    }

    fn value(entries: &[(&str, i64)]) -> Value {
        Value::Dict(
            entries
                .iter()
                .map(|&(key, i)| (key.to_owned(), Value::Int(i)))
                .collect(),
        )
    }

    #[test]
    fn keys_are_sorted_unless_kept_in_order() {
        assert_eq!(space().spaces()[0].0, "a");
        let kept =
            DictSpace::in_order([("b", Space::discrete(4)), ("a", Space::discrete(2))]).unwrap();
        assert_eq!(kept.to_string(), "Dict('b': Discrete(4), 'a': Discrete(2))");
        assert_eq!(kept, space());
        let stored = serde_json::to_string(&kept).unwrap();
        assert_eq!(
            serde_json::from_str::<DictSpace>(&stored)
                .unwrap()
                .to_string(),
            kept.to_string()
        );
    }

    #[test]
    fn keys_are_distinct() {
        let twice = [("a", Space::discrete(1)), ("a", Space::discrete(2))];
        assert!(
            DictSpace::new(twice)
                .unwrap_err()
                .to_string()
                .contains(r#"the key "a" of a dict occurs twice"#)
        );
        assert!(DictSpace::new::<&str>([]).is_ok());
    }

    #[test]
    fn contains_exactly_the_keys_in_any_order() {
        let contains = |entries: &[(&str, i64)]| space().contains(&value(entries));
        assert!(contains(&[("a", 1), ("b", 3)]) && contains(&[("b", 0), ("a", 0)]));
        assert!(!contains(&[("a", 1)]) && !contains(&[("a", 1), ("b", 3), ("c", 0)]));
        assert!(!contains(&[("a", 1), ("c", 3)]) && !contains(&[("a", 2), ("b", 3)]));
        assert!(!contains(&[("a", 1), ("a", 1)]) && !space().contains(&Value::Tuple(vec![])));
    }

    #[test]
    fn faults_name_the_key() {
        let fault =
            |entries: &[(&str, i64)]| space().check(&value(entries)).unwrap_err().to_string();
        assert_eq!(
            fault(&[("a", 2), ("b", 3)]),
            r#"["a"]: 2 is not between 0 and 1"#
        );
        assert_eq!(fault(&[("a", 1)]), r#"the key "b" is missing"#);
        assert_eq!(fault(&[("a", 1), ("c", 1)]), r#"the space has no key "c""#);
        assert_eq!(fault(&[("a", 1), ("b", 1), ("b", 1)]), "a key occurs twice");
        assert_eq!(space().check(&value(&[("b", 1), ("a", 1)])), Ok(()));
    }
}
