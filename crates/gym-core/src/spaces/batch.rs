//! Several elements of a space as one value: Gymnasium's `batch_space`, `concatenate` and
//! `iterate`.
//!
//! Arrays of one shape, and integers, become one array with a new first axis; members of tuples and
//! dicts are batched one by one; all else becomes a tuple of the elements.

use super::rows::{expect_i64, expect_type};
use super::{BoxSpace, MultiBinary, MultiDiscrete, Space, TupleSpace, element_count, invalid};
use crate::value::array::Array;
use crate::value::fault::{Fault, expect_array};
use crate::value::number::{Number, collect, into_data, with_type};
use crate::value::{Data, Error, Result, Value, numpy_fmt};

impl Space {
    /// The space of `n` elements as one value: Gymnasium's `batch_space`.
    ///
    /// ```
    /// use gym_core::Space;
    /// let batch = Space::discrete(3).batch(4)?;
    /// assert_eq!(batch.to_string(), "MultiDiscrete([3 3 3 3])");
    /// # Ok::<(), gym_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the batch would have more elements than memory has addresses.
    pub fn batch(&self, n: usize) -> Result<Self> {
        let shape = [&[n], self.shape().unwrap_or_default()].concat();
        element_count(&shape).map_err(|fault| Error::InvalidSpace(fault.to_string()))?;
        Ok(match self {
            Self::Box(_) | Self::Discrete(_) | Self::MultiDiscrete(_) | Self::MultiBinary(_) => {
                batch_space(self, n)?
            }
            Self::Tuple(space) => space.map(|space| space.batch(n))?.into(),
            Self::Dict(space) => space.map(|space| space.batch(n))?.into(),
            _ => TupleSpace::new(vec![self.clone(); n]).into(),
        })
    }

    /// Elements of this space as one element of its [batch](Self::batch): Gymnasium's
    /// `concatenate`.
    ///
    /// ```
    /// use gym_core::{Space, Value};
    /// let space = Space::discrete(3);
    /// let batch = space.concatenate(&[Value::Int(2), Value::Int(0)])?;
    /// assert_eq!(batch, Value::Array([2i64, 0].into()));
    /// assert!(space.iterate(&batch)?.eq([Value::Int(2), Value::Int(0)]));
    /// # Ok::<(), gym_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotInSpace`] if a value has not the form of this space's elements.
    pub fn concatenate(&self, elements: &[Value]) -> Result<Value> {
        concatenate(self, &elements.iter().collect::<Vec<_>>())
            .map_err(|fault| super::not_in(&Value::Tuple(elements.to_vec()), self, &fault))
    }

    /// The elements of this space that an element of its [batch](Self::batch) is made of, in order:
    /// Gymnasium's `iterate`.
    ///
    /// # Errors
    /// [`Error::NotInSpace`] if the value has not the form of a batch.
    pub fn iterate(&self, batch: &Value) -> Result<impl ExactSizeIterator<Item = Value> + use<>> {
        iterate(self, batch)
            .map(Vec::into_iter)
            .map_err(|fault| self.refuse_batch(batch, &fault))
    }
}

/// The space of `n` elements in one array, for the spaces whose elements are arrays or integers.
pub(super) fn batch_space(space: &Space, n: usize) -> Result<Space> {
    let tile = |array: &Array| {
        let data = with_type!(numbers array.data(), values => into_data(values.repeat(n)));
        Array::new(batch_shape(n, array.shape()), data)
    };
    Ok(match space {
        Space::Box(space) => BoxSpace::new(tile(space.low())?, tile(space.high())?)?.into(),
        Space::Discrete(space) => MultiDiscrete::new(vec![space.n(); n])?
            .with_start(vec![space.start(); n])?
            .with_dtype(space.dtype())?
            .into(),
        Space::MultiDiscrete(space) => {
            let bound = |pick: fn((i64, i64)) -> i64| {
                let numbers = space.ranges().map(pick);
                tile(&Array::new(
                    space.shape(),
                    Data::from_i64(space.dtype(), numbers),
                )?)
            };
            BoxSpace::new(bound(|(start, _)| start)?, bound(|(_, last)| last)?)?.into()
        }
        Space::MultiBinary(space) => {
            BoxSpace::uniform(0.0, 1.0, batch_shape(n, space.shape()), MultiBinary::DTYPE)?.into()
        }
        _ => return invalid(format!("elements of {space} do not batch into one array")),
    })
}

fn batch_shape(n: usize, shape: &[usize]) -> Vec<usize> {
    [&[n], shape].concat()
}

/// Elements of a space as one value.
pub(super) fn concatenate(space: &Space, items: &[&Value]) -> Result<Value, Fault> {
    if let (Some(shape), Some(dtype)) = (space.shape(), space.dtype()) {
        let mut numbers = Vec::new();
        for (i, item) in items.iter().enumerate() {
            match item {
                Value::Int(i) if shape.is_empty() => numbers.push(Number::Int((*i).into())),
                _ => {
                    let array = expect_array(item, shape, dtype).map_err(|fault| fault.at(i))?;
                    numbers.extend(Number::all(array.data()));
                }
            }
        }
        let array = Array::new(batch_shape(items.len(), shape), collect(dtype, numbers));
        return array
            .map(Value::Array)
            .map_err(|error: Error| Fault::new(error.to_string()));
    }
    /// The batch of member `j`, whose values are the column `j` of `rows`.
    fn column(space: &Space, rows: &[Vec<(&Space, &Value)>], j: usize) -> Result<Value, Fault> {
        concatenate(space, &rows.iter().map(|row| row[j].1).collect::<Vec<_>>())
    }
    Ok(match space {
        Space::Tuple(tuple) => {
            let rows = items.iter().map(|item| Ok(tuple.members(item)?.collect()));
            let rows = rows.collect::<Result<Vec<Vec<_>>, Fault>>()?;
            let columns = tuple
                .spaces()
                .iter()
                .enumerate()
                .map(|(j, space)| column(space, &rows, j));
            Value::Tuple(columns.collect::<Result<_, _>>()?)
        }
        Space::Dict(dict) => {
            let rows = items.iter().map(|item| Ok(dict.members(item)?.collect()));
            let rows = rows.collect::<Result<Vec<Vec<_>>, Fault>>()?;
            let columns = dict.spaces().iter().enumerate();
            let columns =
                columns.map(|(j, (key, space))| Ok((key.clone(), column(space, &rows, j)?)));
            Value::Dict(columns.collect::<Result<_, _>>()?)
        }
        _ => Value::Tuple(items.iter().map(|&item| item.clone()).collect()),
    })
}

/// The elements that a value was [concatenated](concatenate) from. Their numbers keep their type.
pub(super) fn iterate(space: &Space, value: &Value) -> Result<Vec<Value>, Fault> {
    match (space, value) {
        (Space::Tuple(space), _) => {
            let mut columns = Vec::new();
            space.each(value, |space, column| {
                columns.push(iterate(space, column)?.into_iter());
                Ok(())
            })?;
            rows(columns).map(|rows| rows.into_iter().map(Value::Tuple).collect())
        }
        (Space::Dict(space), _) => {
            let mut columns = Vec::new();
            space.each(value, |space, column| {
                columns.push(iterate(space, column)?.into_iter());
                Ok(())
            })?;
            let keys = || space.spaces().iter().map(|(key, _)| key.clone());
            let name = |row: Vec<Value>| Value::Dict(keys().zip(row).collect());
            rows(columns).map(|rows| rows.into_iter().map(name).collect())
        }
        (_, Value::Array(array)) if space.dtype().is_some() => iterate_array(space, array),
        _ if space.dtype().is_some() => Err(Fault::kind("an array", value)),
        (_, Value::Tuple(items)) => Ok(items.clone()),
        _ => Err(Fault::kind("a tuple", value)),
    }
}

/// Transposes columns of equal lengths to rows.
fn rows(mut columns: Vec<std::vec::IntoIter<Value>>) -> Result<Vec<Vec<Value>>, Fault> {
    let n = columns.first().map_or(0, ExactSizeIterator::len);
    if columns.iter().any(|column| column.len() != n) {
        return Err(Fault::new("the members hold different numbers of elements"));
    }
    Ok((0..n)
        .map(|_| columns.iter_mut().filter_map(Iterator::next).collect())
        .collect())
}

/// [`iterate`] for a space whose elements are arrays or integers.
fn iterate_array(space: &Space, array: &Array) -> Result<Vec<Value>, Fault> {
    let (Some(shape), Some(dtype)) = (space.shape(), space.dtype()) else {
        return Err(Fault::new("the elements do not batch into an array"));
    };
    let (n, len) = match array.shape().split_first() {
        Some((&n, inner)) if inner == shape => (n, inner.iter().product::<usize>()),
        _ => {
            let [actual, expected] = [array.shape(), shape].map(numpy_fmt::shape);
            return Err(Fault::new(format!(
                "the shape is {actual} and should be elements of {expected}"
            )));
        }
    };
    if let Space::Discrete(_) = space {
        expect_type(array, dtype)?;
        return Number::all(array.data())
            .map(|x| expect_i64(x).map(Value::Int))
            .collect();
    }
    let row = |i: usize| {
        let data = with_type!(numbers array.data(), values => into_data(values[i * len..(i + 1) * len].to_vec()));
        Array::new(shape, data)
            .map(Value::Array)
            .map_err(|error| Fault::new(error.to_string()))
    };
    (0..n).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{DictSpace, TextSpace, TupleSpace};
    use crate::value::DType;

    #[test]
    fn elements_return_from_a_batch() {
        let text: Space = TextSpace::new(0, 3).unwrap().into();
        let grid: Space = MultiDiscrete::new([3, 4]).unwrap().into();
        let pair = TupleSpace::new([Space::discrete(3), Space::boxed([0.0; 2], [1.0; 2])]);
        let dict = DictSpace::new([("a", pair.clone().into()), ("b", text.clone())]).unwrap();
        for space in [
            text,
            grid,
            pair.into(),
            dict.into(),
            MultiBinary::new([2, 2]).unwrap().into(),
        ] {
            let mut sampler = space.sampler(7);
            for n in [0, 1, 4] {
                let items: Vec<Value> = (0..n).map(|_| sampler.sample()).collect();
                let batch = concatenate(&space, &items.iter().collect::<Vec<_>>()).unwrap();
                assert_eq!(iterate(&space, &batch).unwrap(), items, "{space}");
            }
        }
    }

    #[test]
    fn arrays_gain_a_first_axis() {
        let space = Space::discrete(3);
        let batch = concatenate(&space, &[&Value::Int(1), &Value::Int(2)]).unwrap();
        assert_eq!(batch, Value::Array([1i64, 2].into()));
        assert!(concatenate(&space, &[&Value::Text("a".into())]).is_err());
        assert!(iterate(&space, &Value::Array([1.0f64].into())).is_err());
        assert!(iterate(&space, &Value::Tuple(vec![])).is_err());
        let square = Space::boxed([0.0; 2], [1.0; 2]);
        assert!(
            iterate(
                &square,
                &Value::Array(Array::zeros(DType::F32, [4]).unwrap())
            )
            .is_err()
        );
        assert_eq!(
            iterate(
                &square,
                &Value::Array(Array::zeros(DType::F32, [3, 2]).unwrap())
            )
            .unwrap()
            .len(),
            3
        );
    }

    #[test]
    fn batch_spaces_are_gymnasiums() {
        let batch = |space: Space| batch_space(&space, 2).unwrap().to_string();
        assert_eq!(
            batch(Space::boxed([0.0], [1.0])),
            "Box(0.0, 1.0, (2, 1), float32)"
        );
        assert_eq!(batch(Space::discrete(3)), "MultiDiscrete([3 3])");
        let grid = MultiDiscrete::new([3, 4])
            .unwrap()
            .with_start([1, 0])
            .unwrap();
        assert_eq!(batch(grid.into()), "Box([[1 0]\n [1 0]], 3, (2, 2), int64)");
        assert_eq!(
            batch(MultiBinary::new([3]).unwrap().into()),
            "Box(0, 1, (2, 3), int8)"
        );
        assert!(batch_space(&TupleSpace::new([]).into(), 2).is_err());
    }

    /// Printed forms and samples by numpy 2.4.6 and Gymnasium 1.4.0: `batch_space(space, 2)`,
    /// seeded with 17.
    #[test]
    fn batches_print_and_sample_as_gymnasiums() {
        use crate::spaces::{Discrete, OneOfSpace, SequenceSpace};
        use serde_json::json;
        let bits = Space::from(MultiBinary::new([2]).unwrap());
        let from_2 = Space::from(Discrete::new(4).unwrap().with_start(2).unwrap());
        let text = TextSpace::new(1, 3).unwrap().with_charset("ab").unwrap();
        let cases: [(Space, &str, serde_json::Value); 6] = [
            (
                DictSpace::new([("b", from_2), ("a", bits)]).unwrap().into(),
                "Dict('a': Box(0, 1, (2, 2), int8), 'b': MultiDiscrete([4 4], start=[2 2]))",
                json!([{"a": [[1, 1], [0, 1]], "b": [4, 2]}, {"a": [[1, 0], [0, 0]], "b": [3, 2]}]),
            ),
            (
                text.into(),
                "Tuple(Text(1, 3, charset=ab), Text(1, 3, charset=ab))",
                json!([["b", "aa"], ["abb", "ab"]]),
            ),
            (
                SequenceSpace::new(Space::discrete(3)).into(),
                "Tuple(Sequence(Discrete(3), stack=False), Sequence(Discrete(3), stack=False))",
                json!([
                    [[0, 2, 1, 0, 2, 2], [0, 1, 2]],
                    [[0, 2, 2, 0, 2, 0, 1, 2, 0, 2, 2, 2, 1, 0, 0, 1, 2], [1]]
                ]),
            ),
            (
                OneOfSpace::new([Space::discrete(3), Space::discrete(5)])
                    .unwrap()
                    .into(),
                "Tuple(OneOf(Discrete(3), Discrete(5)), OneOf(Discrete(3), Discrete(5)))",
                json!([[[0, 0], [1, 3]], [[1, 3], [1, 2]]]),
            ),
            (
                MultiDiscrete::new([3, 4]).unwrap().into(),
                "Box(0, [[2 3]\n [2 3]], (2, 2), int64)",
                json!([[[2, 0], [1, 1]], [[0, 1], [1, 2]]]),
            ),
            (
                Discrete::new(5)
                    .unwrap()
                    .with_dtype(DType::I32)
                    .unwrap()
                    .into(),
                "MultiDiscrete([5 5])",
                json!([[4, 0], [2, 1]]),
            ),
        ];
        for (space, printed, samples) in cases {
            let batch = space.batch(2).unwrap();
            assert_eq!(batch.to_string(), printed);
            let mut sampler = batch.sampler(17);
            for sample in samples.as_array().unwrap() {
                let drawn = sampler.sample();
                assert_eq!(&drawn.to_json(), sample, "{space}");
                let singles: Vec<Value> = space.iterate(&drawn).unwrap().collect();
                assert_eq!(space.concatenate(&singles).unwrap(), drawn, "{space}");
                assert!(
                    singles.iter().all(|single| space.contains(single)),
                    "{space}"
                );
            }
        }
        assert!(Space::discrete(3).concatenate(&[Value::Null]).is_err());
        assert!(Space::discrete(3).iterate(&Value::Int(1)).is_err());
    }
}
