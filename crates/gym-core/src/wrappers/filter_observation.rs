use serde::{Deserialize, Serialize};

use crate::spaces::{DictSpace, TupleSpace};
use crate::{BoxEnv, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;

/// Keeps some members of dict or tuple observations.
#[derive(Clone, Debug)]
pub struct FilterObservation<E = BoxEnv> {
    env: E,
    space: Space,
    keys: FilterKeys,
    inner: Value,
}

/// The members that [`FilterObservation`] keeps.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FilterKeys {
    /// Keys of a `Dict`.
    Names(Vec<String>),
    /// Indices into a `Tuple`, counted from 0.
    Indices(Vec<usize>),
}

impl<const N: usize> From<[&str; N]> for FilterKeys {
    fn from(names: [&str; N]) -> Self {
        Self::Names(names.map(str::to_owned).into())
    }
}

impl<const N: usize> From<[usize; N]> for FilterKeys {
    fn from(indices: [usize; N]) -> Self {
        Self::Indices(indices.into())
    }
}

impl<E: Env> FilterObservation<E> {
    /// Keeps the members of these keys: `["position", "speed"]` of a `Dict`, `[0, 2]` of a `Tuple`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if there is no key, a key twice, a key that the space does not have,
    /// or the space is neither a `Dict` with names nor a `Tuple` with indices.
    pub fn new(env: E, filter_keys: impl Into<FilterKeys>) -> Result<Self> {
        let (keys, inner) = (filter_keys.into(), env.observation_space());
        let refuse = |reason: String| Error::argument("FilterObservation", reason);
        let missing = |key: &dyn std::fmt::Display| refuse(format!("there is no member {key} in {inner}"));
        let space = match (&inner, &keys) {
            (Space::Dict(space), FilterKeys::Names(names)) => {
                let member =
                    |name: &String| Ok((name.clone(), space.get(name).ok_or_else(|| missing(name))?.clone()));
                let members: Vec<_> = names.iter().map(member).collect::<Result<_>>()?;
                let build = if is_sorted(space) { DictSpace::new } else { DictSpace::in_order };
                Space::from(build(members).map_err(|error| refuse(error.to_string()))?)
            }
            (Space::Tuple(space), FilterKeys::Indices(indices)) => {
                if (1..indices.len()).any(|i| indices[..i].contains(&indices[i])) {
                    return Err(refuse(format!("an index occurs twice in {indices:?}")));
                }
                let member = |i: &usize| space.spaces().get(*i).cloned().ok_or_else(|| missing(i));
                TupleSpace::new(indices.iter().map(member).collect::<Result<Vec<_>>>()?).into()
            }
            _ => {
                let reason = format!("names need a Dict and indices a Tuple, and the space is {inner}");
                return Err(refuse(reason));
            }
        };
        let is_empty = match &keys {
            FilterKeys::Names(names) => names.is_empty(),
            FilterKeys::Indices(indices) => indices.is_empty(),
        };
        if is_empty {
            return Err(refuse("filter_keys is empty: nothing would be left to observe".into()));
        }
        Ok(Self { env, space, keys, inner: Value::Null })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let lacking = || Error::Contract(format!("the observation {} lacks a member", self.inner));
        match (&self.space, &self.keys) {
            (Space::Dict(space), _) => {
                let count = space.spaces().len();
                if !matches!(out, Value::Dict(entries) if entries.len() == count) {
                    let empty = space.spaces().iter().map(|(key, _)| (key.clone(), Value::Null));
                    *out = Value::Dict(empty.collect());
                }
                let Value::Dict(entries) = out else { return Err(lacking()) };
                for ((name, value), (key, _)) in entries.iter_mut().zip(space.spaces()) {
                    name.clone_from(key);
                    value.clone_from(self.inner.get(key).ok_or_else(lacking)?);
                }
            }
            (_, FilterKeys::Indices(indices)) => {
                let members = self.inner.as_tuple().ok_or_else(lacking)?;
                if !matches!(out, Value::Tuple(items) if items.len() == indices.len()) {
                    *out = Value::Tuple(vec![Value::Null; indices.len()]);
                }
                let Value::Tuple(items) = out else { return Err(lacking()) };
                for (item, i) in items.iter_mut().zip(indices) {
                    item.clone_from(members.get(*i).ok_or_else(lacking)?);
                }
            }
            _ => return Err(lacking()),
        }
        Ok(())
    }

    fn stored(&self) -> WrapperSpec {
        let keys = serde_json::to_value(&self.keys).unwrap_or_default();
        WrapperSpec::new("FilterObservation").arg("filter_keys", keys)
    }
}

/// Whether the keys are sorted, so that a dict with more or fewer of them is to be as well.
pub(super) fn is_sorted(space: &DictSpace) -> bool {
    space.spaces().is_sorted_by(|(a, _), (b, _)| a <= b)
}

observation_wrapper!(FilterObservation);
