//! A selection of the members of dict and tuple observations.

use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{DictSpace, TupleSpace};
use gym_core::{BoxEnv, Error, Result, Space, Value};
use serde::{Deserialize, Serialize};

use crate::map::{MapObservation, ObservationMap};

/// Keeps some members of dict or tuple observations.
pub type FilterObservation<T = BoxEnv> = MapObservation<T, Filter>;

gym_core::arguments! {
    /// The arguments of [`FilterObservation`].
    pub struct Config {
        /// The members to keep, at least one: names of a `Dict`, as in `["position"]`, or indices
        /// into a `Tuple`.
        pub filter_keys: FilterKeys,
    }
}

/// The members that [`FilterObservation`] keeps.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a list of names, or a list of indices from 0"
)]
pub enum FilterKeys {
    /// Keys of a `Dict`.
    Names(Vec<String>),
    /// Indices into a `Tuple`, counted from 0.
    Indices(Vec<usize>),
}

impl gym_core::ArgumentType for FilterKeys {
    fn kind() -> String {
        "list of strings or of integers".into()
    }
}

impl Default for FilterKeys {
    fn default() -> Self {
        Self::Names(Vec::new())
    }
}

impl<const N: usize> From<[&str; N]> for Config {
    fn from(names: [&str; N]) -> Self {
        Self {
            filter_keys: FilterKeys::Names(names.map(str::to_owned).into()),
        }
    }
}

impl<const N: usize> From<[usize; N]> for Config {
    fn from(indices: [usize; N]) -> Self {
        Self {
            filter_keys: FilterKeys::Indices(indices.into()),
        }
    }
}

/// The map of [`FilterObservation`].
#[derive(Clone, Debug)]
pub enum Filter {
    /// The keys of a dict, in the order of the space.
    Dict(Vec<String>),
    /// The indices into a tuple.
    Tuple(Vec<usize>),
}

impl ObservationMap for Filter {
    type Config = Config;
    const TAKES_BATCHES: bool = true;

    fn new(Config { filter_keys }: &Config, inner: &Space) -> Result<(Self, Space)> {
        let missing =
            |key: &dyn fmt::Display| Config::refuse(format!("there is no member {key} in {inner}"));
        let is_empty = match filter_keys {
            FilterKeys::Names(names) => names.is_empty(),
            FilterKeys::Indices(indices) => indices.is_empty(),
        };
        if is_empty {
            return Err(Config::refuse("filter_keys is empty: give at least one"));
        }
        match (inner, filter_keys) {
            (Space::Dict(space), FilterKeys::Names(names)) => {
                let member = |name: &String| {
                    Ok((
                        name.clone(),
                        space.get(name).ok_or_else(|| missing(name))?.clone(),
                    ))
                };
                let members: Vec<_> = names.iter().map(member).collect::<Result<_>>()?;
                let space =
                    dict_like(space, members).map_err(|error| Config::refuse(error.to_string()))?;
                let keys = space.spaces().iter().map(|(key, _)| key.clone()).collect();
                Ok((Self::Dict(keys), space.into()))
            }
            (Space::Tuple(space), FilterKeys::Indices(indices)) => {
                if (1..indices.len()).any(|i| indices[..i].contains(&indices[i])) {
                    return Err(Config::refuse(format!(
                        "an index occurs twice in {indices:?}"
                    )));
                }
                let member = |i: &usize| space.spaces().get(*i).cloned().ok_or_else(|| missing(i));
                let members = indices.iter().map(member).collect::<Result<Vec<_>>>()?;
                Ok((
                    Self::Tuple(indices.clone()),
                    TupleSpace::new(members).into(),
                ))
            }
            _ => {
                let reason =
                    format!("names need a Dict and indices a Tuple, and the space is {inner}");
                Err(Config::refuse(reason))
            }
        }
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let lacking = || {
            Error::Contract(format!(
                "the observation {inner} lacks a member of its space"
            ))
        };
        match self {
            Self::Dict(keys) => {
                for (key, value) in keys.iter().zip(entries(keys.iter(), out)) {
                    value.clone_from(inner.get(key).ok_or_else(lacking)?);
                }
            }
            Self::Tuple(indices) => {
                let members = inner.as_tuple().ok_or_else(lacking)?;
                if !matches!(out, Value::Tuple(items) if items.len() == indices.len()) {
                    *out = Value::Tuple(vec![Value::Null; indices.len()]);
                }
                let Value::Tuple(items) = out else {
                    return Err(lacking());
                };
                for (item, i) in items.iter_mut().zip(indices) {
                    item.clone_from(members.get(*i).ok_or_else(lacking)?);
                }
            }
        }
        Ok(())
    }
}

/// A dict space with the members `members`. Its keys are sorted if the keys of `space` are.
pub(crate) fn dict_like(space: &DictSpace, members: Vec<(String, Space)>) -> Result<DictSpace> {
    let is_sorted = space.spaces().is_sorted_by(|(a, _), (b, _)| a <= b);
    if is_sorted {
        DictSpace::new(members)
    } else {
        DictSpace::in_order(members)
    }
}

/// Returns the entries of the dict in `out`. First replaces `out` if `out` is not a dict with the
/// keys `keys`.
pub(crate) fn entries<'a>(
    keys: impl ExactSizeIterator<Item = &'a String> + Clone,
    out: &'a mut Value,
) -> impl Iterator<Item = &'a mut Value> {
    if !matches!(out, Value::Dict(entries) if entries.len() == keys.len()) {
        *out = Value::Dict(keys.clone().map(|key| (key.clone(), Value::Null)).collect());
    }
    let entries = if let Value::Dict(entries) = out {
        entries.as_mut_slice()
    } else {
        Default::default()
    };
    entries.iter_mut().zip(keys).map(|((name, value), key)| {
        name.clone_from(key);
        value
    })
}

gym_core::register_wrapper!(
    "FilterObservation", "keeps some members of a dict or tuple", Config,
    env: FilterObservation::new, vector: FilterObservation::new
);
