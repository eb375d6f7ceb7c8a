//! The rows of a batch, one at a time: without allocation if elements are numbers.

use std::ops::Range;

use crate::value::array::{Array, same_shape};
use crate::value::number::{Number, Numeric, can_cast, with_type};
use crate::value::{DType, Result, Value};

use super::Space;
use crate::value::fault::Fault;

impl Space {
    /// Overwrites `element` with element `index` of a [batch](Self::batch). Numbers are converted
    /// to the type of the space.
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if `batch` has another form or no such row.
    pub fn read_row(&self, batch: &Value, index: usize, element: &mut Value) -> Result<()> {
        self.get_at(batch, index, element)
            .map_err(|fault| self.refuse_batch(batch, &fault))
    }

    /// Overwrites element `index` of a [batch](Self::batch).
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if `element` or `batch` has another form, or
    /// there is no such row; the row may then be partly written.
    pub fn write_row(&self, batch: &mut Value, index: usize, element: &Value) -> Result<()> {
        self.put_at(batch, index, element)
            .map_err(|fault| self.refuse(element, &fault))
    }

    /// Copies the rows `rows` of the [batch](Self::batch) `from` to `batch`, to the rows from `to`
    /// on.
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if a batch has another form, or too few
    /// rows.
    pub(crate) fn copy_rows(
        &self,
        from: &Value,
        rows: Range<usize>,
        batch: &mut Value,
        to: usize,
    ) -> Result<()> {
        match (self, from, &mut *batch) {
            (Self::Tuple(space), Value::Tuple(from), Value::Tuple(batch)) => {
                let mut columns = space.spaces().iter().zip(from).zip(batch);
                return columns.try_for_each(|((space, from), batch)| {
                    space.copy_rows(from, rows.clone(), batch, to)
                });
            }
            (Self::Dict(space), Value::Dict(from), Value::Dict(batch)) => {
                let mut columns = space.spaces().iter().zip(from).zip(batch);
                return columns.try_for_each(|(((_, space), (_, from)), (_, batch))| {
                    space.copy_rows(from, rows.clone(), batch, to)
                });
            }
            (_, Value::Tuple(from), Value::Tuple(batch)) => {
                let copied = from
                    .get(rows.clone())
                    .zip(batch.get_mut(to..to + rows.len()));
                if let Some((from, batch)) = copied {
                    batch.clone_from_slice(from);
                    return Ok(());
                }
            }
            (_, Value::Array(from), Value::Array(batch)) if from.dtype() == batch.dtype() => {
                let len = self.shape().map_or(1, |shape| shape.iter().product());
                let [from_numbers, to_numbers] = [rows.start..rows.end, to..to + rows.len()]
                    .map(|rows| rows.start * len..rows.end * len);
                let copied = with_type!(from.dtype(), T => {
                    let from = from.as_slice::<T>().and_then(|from| from.get(from_numbers));
                    let batch = batch.as_mut_slice::<T>().and_then(|batch| batch.get_mut(to_numbers));
                    from.zip(batch).map(|(from, batch)| batch.copy_from_slice(from))
                });
                if copied.is_some() {
                    return Ok(());
                }
            }
            _ => {}
        }
        Err(self.refuse_batch(batch, &Fault::new("the batches differ")))
    }

    /// Whether a value has the form of a batch of `n` elements; their bounds are not checked, and
    /// numbers may be of any type that fits the space's type.
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if not, with the place in the value.
    pub fn check_batch(&self, batch: &Value, n: usize) -> Result<()> {
        self.check_rows(batch, n)
            .map_err(|fault| self.refuse_batch(batch, &fault))
    }

    /// Whether a value has the form of `n` elements, types of numbers included.
    pub fn is_batch(&self, batch: &Value, n: usize) -> bool {
        match (self, batch) {
            (Self::Tuple(space), Value::Tuple(columns)) => {
                columns.len() == space.spaces().len()
                    && space
                        .spaces()
                        .iter()
                        .zip(columns)
                        .all(|(space, column)| space.is_batch(column, n))
            }
            (Self::Dict(space), Value::Dict(columns)) => {
                space.has_keys(columns)
                    && space
                        .spaces()
                        .iter()
                        .zip(columns)
                        .all(|((_, space), (_, column))| space.is_batch(column, n))
            }
            (_, Value::Array(array)) => {
                self.dtype() == Some(array.dtype())
                    && self
                        .shape()
                        .is_some_and(|shape| rows(array, shape) == Some(n))
            }
            (Self::Tuple(_) | Self::Dict(_), _) => false,
            (_, Value::Tuple(items)) => self.dtype().is_none() && items.len() == n,
            _ => false,
        }
    }

    /// A batch of `n` elements to be overwritten: zeros.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if the space has no zero.
    pub fn empty_batch(&self, n: usize) -> Result<Value> {
        Ok(match self {
            Self::Tuple(space) => space.value(|space| space.empty_batch(n))?,
            Self::Dict(space) => space.value(|space| space.empty_batch(n))?,
            _ => match (self.shape(), self.dtype()) {
                (Some(shape), Some(dtype)) => {
                    Value::Array(Array::zeros(dtype, [&[n], shape].concat())?)
                }
                _ => Value::Tuple(vec![self.zero()?; n]),
            },
        })
    }

    /// The smallest number of scalars in an element. A part that is not a number, such as a text,
    /// counts as one.
    pub(crate) fn len_of_row(&self) -> usize {
        match self {
            Self::Tuple(_) | Self::Dict(_) => {
                let lens = self.members().into_iter().map(Self::len_of_row);
                lens.fold(0, usize::saturating_add)
            }
            _ => self.shape().map_or(1, |shape| shape.iter().product()),
        }
    }

    pub(super) fn refuse_batch(&self, batch: &Value, fault: &Fault) -> crate::value::Error {
        super::not_in(batch, &format_args!("a batch of {self}"), fault)
    }

    fn check_rows(&self, batch: &Value, n: usize) -> Result<(), Fault> {
        let count = |actual: usize| match actual == n {
            true => Ok(()),
            false => Err(Fault::new(format!(
                "there are {actual} rows and should be {n}"
            ))),
        };
        match (self, batch) {
            (Self::Tuple(space), _) => {
                space.each(batch, |space, column| space.check_rows(column, n))
            }
            (Self::Dict(space), _) => {
                space.each(batch, |space, column| space.check_rows(column, n))
            }
            _ => match (self.shape(), self.dtype(), batch) {
                (Some(shape), Some(dtype), Value::Array(array)) => {
                    expect_type(array, dtype)?;
                    count(expect_rows(array, shape)?)
                }
                (Some(_), ..) => Err(Fault::kind("an array", batch)),
                (None, _, Value::Tuple(items)) => count(items.len()),
                _ => Err(Fault::kind("a tuple", batch)),
            },
        }
    }

    fn get_at(&self, batch: &Value, index: usize, element: &mut Value) -> Result<(), Fault> {
        match (self, batch) {
            (Self::Tuple(space), Value::Tuple(_)) => {
                let items = space.items_of(element);
                for (i, ((space, column), item)) in space.members(batch)?.zip(items).enumerate() {
                    space
                        .get_at(column, index, item)
                        .map_err(|fault| fault.at(i))?;
                }
                Ok(())
            }
            (Self::Dict(space), Value::Dict(_)) => {
                let entries = space.entries_of(element);
                for ((space, column), (key, item)) in space.members(batch)?.zip(entries) {
                    space
                        .get_at(column, index, item)
                        .map_err(|fault| fault.under(key))?;
                }
                Ok(())
            }
            (Self::Discrete(space), Value::Array(array)) => {
                expect_type(array, space.dtype())?;
                expect_row(expect_rows(array, &[])?, index)?;
                *element = Value::Int(expect_i64(Number::at(array.data(), index))?);
                Ok(())
            }
            (_, Value::Array(array)) => {
                let (Some(shape), Some(dtype)) = (self.shape(), self.dtype()) else {
                    return Err(Fault::kind("a tuple", batch));
                };
                expect_type(array, dtype)?;
                expect_row(expect_rows(array, shape)?, index)?;
                let out = super::array_of(element, dtype, shape);
                let (start, len) = (index * out.len(), out.len());
                with_type!(dtype, T => {
                    let out = out.as_mut_slice::<T>().unwrap_or_default();
                    match array.as_slice::<T>() {
                        Some(numbers) => out.copy_from_slice(&numbers[start..start + len]),
                        None => {
                            for (i, x) in out.iter_mut().enumerate() {
                                *x = T::cast(Number::at(array.data(), start + i));
                            }
                        }
                    }
                });
                Ok(())
            }
            (Self::Tuple(_), _) => Err(Fault::kind("a tuple", batch)),
            (Self::Dict(_), _) => Err(Fault::kind("a dict", batch)),
            (_, Value::Tuple(items)) if self.dtype().is_none() => {
                expect_row(items.len(), index)?;
                element.clone_from(&items[index]);
                Ok(())
            }
            _ if self.dtype().is_some() => Err(Fault::kind("an array", batch)),
            _ => Err(Fault::kind("a tuple", batch)),
        }
    }

    fn put_at(&self, batch: &mut Value, index: usize, element: &Value) -> Result<(), Fault> {
        match (self, batch) {
            (Self::Tuple(space), Value::Tuple(columns))
                if columns.len() == space.spaces().len() =>
            {
                for (i, ((space, item), column)) in space.members(element)?.zip(columns).enumerate()
                {
                    space
                        .put_at(column, index, item)
                        .map_err(|fault| fault.at(i))?;
                }
                Ok(())
            }
            (Self::Dict(space), Value::Dict(columns)) if space.has_keys(columns) => {
                for ((space, item), (key, column)) in space.members(element)?.zip(columns) {
                    space
                        .put_at(column, index, item)
                        .map_err(|fault| fault.under(key))?;
                }
                Ok(())
            }
            (Self::Discrete(_), Value::Array(array)) => {
                let Value::Int(i) = element else {
                    return Err(Fault::kind("a whole number", element));
                };
                expect_row(expect_rows(array, &[])?, index)?;
                with_type!(array.dtype(), T => {
                    array.as_mut_slice::<T>().unwrap_or_default()[index] = T::cast(Number::Int((*i).into()));
                });
                Ok(())
            }
            (_, Value::Array(array)) if self.dtype() == Some(array.dtype()) => {
                let shape = self.shape().unwrap_or_default();
                expect_row(expect_rows(array, shape)?, index)?;
                let row = crate::value::fault::expect_array(element, shape, array.dtype())?;
                let (start, len) = (index * row.len(), row.len());
                with_type!(array.dtype(), T => {
                    let out = &mut array.as_mut_slice::<T>().unwrap_or_default()[start..start + len];
                    match row.as_slice::<T>() {
                        Some(numbers) => out.copy_from_slice(numbers),
                        None => out.iter_mut().zip(Number::all(row.data())).for_each(|(x, y)| *x = T::cast(y)),
                    }
                });
                Ok(())
            }
            (Self::Tuple(_) | Self::Dict(_), _) => Err(other_batch()),
            (_, Value::Tuple(items)) if self.dtype().is_none() => {
                expect_row(items.len(), index)?;
                items[index].clone_from(element);
                Ok(())
            }
            _ => Err(other_batch()),
        }
    }
}

#[cold]
fn other_batch() -> Fault {
    Fault::new("the batch is of another space")
}

/// The number of rows of this shape in an array.
#[inline]
pub(super) fn rows(array: &Array, shape: &[usize]) -> Option<usize> {
    let (&n, inner) = array.shape().split_first()?;
    same_shape(inner, shape).then_some(n)
}

// inline the path of valid rows, not the path of faults

#[inline]
pub(super) fn expect_rows(array: &Array, shape: &[usize]) -> Result<usize, Fault> {
    rows(array, shape).ok_or_else(|| other_shape(array, shape))
}

#[cold]
fn other_shape(array: &Array, shape: &[usize]) -> Fault {
    let [actual, expected] = [array.shape(), shape].map(crate::value::numpy_fmt::shape);
    Fault::new(format!(
        "the shape is {actual} and should be rows of {expected}"
    ))
}

#[inline]
pub(super) fn expect_row(n: usize, index: usize) -> Result<(), Fault> {
    if index < n {
        Ok(())
    } else {
        Err(no_row(n, index))
    }
}

#[cold]
fn no_row(n: usize, index: usize) -> Fault {
    Fault::new(format!("there is no row {index}: there are {n}"))
}

#[inline]
pub(super) fn expect_type(array: &Array, dtype: DType) -> Result<(), Fault> {
    if can_cast(array.dtype(), dtype) {
        Ok(())
    } else {
        Err(other_type(array, dtype))
    }
}

/// A whole number as `i64`.
pub(super) fn expect_i64(number: Number) -> Result<i64, Fault> {
    number
        .to_i64()
        .ok_or_else(|| Fault::new("a number is too large"))
}

#[cold]
fn other_type(array: &Array, dtype: DType) -> Fault {
    Fault::new(format!(
        "the numbers are {} and should be {dtype}",
        array.dtype()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{
        BoxSpace, DictSpace, Discrete, GraphSpace, MultiBinary, MultiDiscrete, OneOfSpace,
        SequenceSpace, TextSpace, TupleSpace,
    };

    #[test]
    fn a_row_has_the_numbers_of_all_members() {
        let pair = TupleSpace::new([
            TextSpace::new(1, 5).unwrap().into(),
            Space::boxed([0.0; 3], [1.0; 3]),
        ]);
        let both = DictSpace::new([
            ("a", Space::discrete(4)),
            ("b", pair.clone().into()),
            ("c", MultiBinary::new([2, 3]).unwrap().into()),
        ])
        .unwrap();
        assert_eq!(Space::from(pair).len_of_row(), 4);
        assert_eq!(Space::from(both).len_of_row(), 1 + 4 + 6);
    }

    fn spaces() -> Vec<Space> {
        let pair = || TupleSpace::new([Space::discrete(3), Space::boxed([0.0; 2], [1.0; 2])]);
        vec![
            Space::discrete(7),
            Discrete::new(3)
                .unwrap()
                .with_dtype(DType::I32)
                .unwrap()
                .into(),
            BoxSpace::uniform(0.0, 9.0, [2, 3], DType::U8)
                .unwrap()
                .into(),
            BoxSpace::uniform(0.0, 1.0, Vec::new(), DType::F64)
                .unwrap()
                .into(),
            MultiBinary::new([2]).unwrap().into(),
            MultiDiscrete::new([3, 4]).unwrap().into(),
            TextSpace::new(0, 4).unwrap().into(),
            DictSpace::new([("a", pair().into()), ("b", Space::discrete(2))])
                .unwrap()
                .into(),
            SequenceSpace::new(pair()).into(),
            GraphSpace::new(Space::discrete(3), None).unwrap().into(),
            OneOfSpace::new([Space::discrete(3), pair().into()])
                .unwrap()
                .into(),
            TupleSpace::new([
                TextSpace::new(1, 2).unwrap().into(),
                SequenceSpace::new(pair()).into(),
            ])
            .into(),
        ]
    }

    #[test]
    fn rows_are_the_elements_of_the_batch() {
        for space in spaces() {
            let mut sampler = space.sampler(1);
            let items: Vec<Value> = (0..2).map(|_| sampler.sample()).collect();
            let mut batch = space.empty_batch(2).unwrap();
            assert!(
                space.is_batch(&batch, 2) && !space.is_batch(&batch, 3),
                "{space}"
            );
            space.check_batch(&batch, 2).unwrap();
            for (i, item) in items.iter().enumerate() {
                space.write_row(&mut batch, i, item).unwrap();
            }
            assert_eq!(batch, space.concatenate(&items).unwrap(), "{space}");
            assert!(space.is_batch(&batch, 2));
            let mut element = Value::Null;
            for (i, item) in items.iter().enumerate() {
                space.read_row(&batch, i, &mut element).unwrap();
                assert_eq!(&element, item, "{space}");
            }
            let before = batch.clone();
            assert!(space.read_row(&batch, 2, &mut element).is_err(), "{space}");
            assert!(
                space.write_row(&mut batch, 2, &items[0]).is_err(),
                "{space}"
            );
            assert!(
                space.check_batch(&batch, 3).is_err()
                    && space.check_batch(&Value::Null, 2).is_err()
            );
            assert_eq!(batch, before);
        }
    }

    #[test]
    fn numbers_take_the_type_of_the_space() {
        let space: Space = BoxSpace::uniform(-1.0, 1.0, [2], DType::F64)
            .unwrap()
            .into();
        let narrow = Value::Array(
            Array::from([0.5f32, 1.0, 0.25, 0.0])
                .reshape([2, 2])
                .unwrap(),
        );
        space.check_batch(&narrow, 2).unwrap();
        assert!(!space.is_batch(&narrow, 2));
        let mut element = Value::Null;
        space.read_row(&narrow, 1, &mut element).unwrap();
        assert_eq!(element, Value::Array([0.25f64, 0.0].into()));
        let mut batch = space.empty_batch(2).unwrap();
        space
            .write_row(&mut batch, 0, &Value::Array([0.5f32, 1.0].into()))
            .unwrap();
        assert_eq!(batch.as_slice::<f64>().unwrap(), [0.5, 1.0, 0.0, 0.0]);
        let error = Space::discrete(3)
            .check_batch(&Value::Array([0.0f32].into()), 1)
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "the numbers are float32 and should be int64: [0.0] is not an element of a batch of Discrete(3)"
        );
    }

    /// A batch has its columns under the names of the space, in their order.
    #[test]
    fn columns_of_other_names_are_no_batch() {
        let space: Space = DictSpace::new([("a", Space::discrete(2)), ("b", Space::discrete(2))])
            .unwrap()
            .into();
        let named = |keys: [&str; 2], value: &Value| {
            Value::Dict(keys.map(|key| (key.to_owned(), value.clone())).into())
        };
        let column = Space::discrete(2).empty_batch(3).unwrap();
        let element = named(["a", "b"], &Value::Int(1));
        let mut batch = named(["a", "b"], &column);
        assert!(space.is_batch(&batch, 3));
        space.write_row(&mut batch, 1, &element).unwrap();
        for keys in [["a", "c"], ["b", "a"]] {
            let mut other = named(keys, &column);
            assert!(!space.is_batch(&other, 3), "{keys:?}");
            assert!(
                space.write_row(&mut other, 1, &element).is_err(),
                "{keys:?}"
            );
            // a buffer with other names is replaced
            let mut read = named(keys, &Value::Int(0));
            space.read_row(&batch, 1, &mut read).unwrap();
            assert_eq!(read, element, "{keys:?}");
        }
    }
}
