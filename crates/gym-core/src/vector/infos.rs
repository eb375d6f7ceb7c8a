//! The infos of sub-environments as columns: Gymnasium's `_add_info`.

use std::collections::{BTreeMap, BTreeSet};

use super::{Columns, VectorEnv};
use crate::value::number::{Number, Numeric, with_type};
use crate::value::{Array, DType, Info, Value};

/// See [`VectorEnvExt::infos`](super::VectorEnvExt::infos).
pub(super) fn batch<V: VectorEnv + ?Sized>(envs: &V, columns: &Columns) -> Info {
    let n = envs.num_envs();
    let space = columns
        .has_final
        .contains(&true)
        .then(|| envs.single_observation_space());
    let (mut columns_there, mut entries) = (BTreeSet::new(), Info::new());
    envs.column_infos(&mut |key, column| {
        columns_there.insert(key.to_owned());
        entries.insert(key.to_owned(), column);
    });
    let mut group = Group::new(n);
    for index in 0..n {
        if let Some(space) = &space
            && columns.has_final.get(index) == Some(&true)
        {
            let mut observation = Value::Null;
            if space
                .read_row(&columns.final_observations, index, &mut observation)
                .is_ok()
            {
                group.add_to("final_obs", index, observation, |n, _| {
                    Values::Objects(vec![Value::Null; n])
                });
            }
            let mut entries = Vec::new();
            envs.final_info(index, &mut |key, value| {
                entries.push((key.to_owned(), value));
            });
            group.add("final_info", index, Value::Dict(entries));
        }
        envs.info(index, &mut |key, value| {
            if !columns_there.contains(key) {
                group.add(key, index, value);
            }
        });
    }
    entries.extend(group.into_entries());
    entries
}

/// A flag for each sub-environment, as in [`infos`](crate::VectorEnvExt::infos).
pub fn flags(flags: &[bool]) -> Value {
    Value::Tuple(flags.iter().map(|flag| Value::Bool(*flag)).collect())
}

/// Columns by key, for `n` sub-environments, each with the mask of present values.
struct Group {
    n: usize,
    columns: BTreeMap<String, (Values, Vec<bool>)>,
}

/// The values of one key. A missing value is zero, `false` or `Null`.
enum Values {
    Numbers(Array),
    Flags(Vec<bool>),
    Objects(Vec<Value>),
    Group(Group),
}

impl Group {
    fn new(n: usize) -> Self {
        Self {
            n,
            columns: BTreeMap::new(),
        }
    }

    /// Adds a value to a column; the first value decides the column's type.
    fn add(&mut self, key: &str, index: usize, value: Value) {
        self.add_to(key, index, value, Values::for_value);
    }

    fn add_to(&mut self, key: &str, index: usize, value: Value, new: fn(usize, &Value) -> Values) {
        if let Some((values, is_there)) = self.columns.get_mut(key) {
            is_there[index] = values.set(index, value);
            return;
        }
        let (mut values, mut is_there) = (new(self.n, &value), vec![false; self.n]);
        is_there[index] = values.set(index, value);
        self.columns.insert(key.to_owned(), (values, is_there));
    }

    /// Each key with its values, and `_key` with the mask.
    fn into_entries(self) -> impl Iterator<Item = (String, Value)> {
        self.columns
            .into_iter()
            .flat_map(|(key, (values, is_there))| {
                let mask = (format!("_{key}"), flags(&is_there));
                let values = match values {
                    Values::Numbers(array) => Value::Array(array),
                    Values::Flags(values) => flags(&values),
                    Values::Objects(values) => Value::Tuple(values),
                    Values::Group(group) => Value::Dict(group.into_entries().collect()),
                };
                [(key, values), mask]
            })
    }
}

impl Values {
    fn for_value(n: usize, value: &Value) -> Self {
        match value {
            Value::Bool(_) => Self::Flags(vec![false; n]),
            Value::Int(_) => Self::numbers(n, DType::I64, &[]),
            Value::Float(_) => Self::numbers(n, DType::F64, &[]),
            Value::Array(array) => Self::numbers(n, array.dtype(), array.shape()),
            Value::Dict(_) => Self::Group(Group::new(n)),
            _ => Self::Objects(vec![Value::Null; n]),
        }
    }

    /// A column of zeros; of objects if the numbers do not fit in memory.
    fn numbers(n: usize, dtype: DType, shape: &[usize]) -> Self {
        let column = Array::zeros(dtype, [&[n], shape].concat());
        column.map_or_else(|_| Self::Objects(vec![Value::Null; n]), Self::Numbers)
    }

    /// Sets one value, cast to the type of the column as numpy casts; `false` if the column cannot
    /// hold it.
    fn set(&mut self, index: usize, value: Value) -> bool {
        match (self, value) {
            (Self::Flags(flags), Value::Bool(flag)) => flags[index] = flag,
            (Self::Numbers(array), Value::Int(i)) if array.shape().len() == 1 => {
                set_number(array, index, Number::Int(i.into()));
            }
            (Self::Numbers(array), Value::Float(x)) if array.shape().len() == 1 => {
                set_number(array, index, Number::Float(x));
            }
            (Self::Numbers(array), Value::Array(row)) if array.shape()[1..] == *row.shape() => {
                for i in 0..row.len() {
                    set_number(array, index * row.len() + i, Number::at(row.data(), i));
                }
            }
            (Self::Group(group), Value::Dict(entries)) => {
                entries
                    .into_iter()
                    .for_each(|(key, value)| group.add(&key, index, value));
            }
            (Self::Objects(values), value) => values[index] = value,
            _ => return false,
        }
        true
    }
}

fn set_number(array: &mut Array, index: usize, number: Number) {
    with_type!(array.dtype(), T => {
        if let Some(x) = array.as_mut_slice::<T>().and_then(|numbers| numbers.get_mut(index)) {
            *x = T::cast(number);
        }
    });
}
