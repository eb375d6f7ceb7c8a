//! Actions of a `Box` of real numbers, and batches of them: they keep their precision.

use super::Space;
use super::rows::{expect_row, expect_rows, rows};
use crate::value::array::Array;
use crate::value::number::Number;
use crate::value::{DType, Data, Result, Value};

impl Space {
    /// As [`read_row`](Self::read_row), for actions: an action of a `Box` of real numbers keeps its
    /// precision, as in [`Continuous`](crate::Continuous).
    ///
    /// # Errors
    /// As [`read_row`](Self::read_row).
    pub fn read_action(&self, batch: &Value, index: usize, action: &mut Value) -> Result<()> {
        match (self.shape_of_reals(), batch) {
            (Some(shape), Value::Array(array)) if self.dtype() != Some(array.dtype()) => {
                let row = expect_rows(array, shape).and_then(|n| expect_row(n, index));
                row.map_err(|fault| self.refuse_batch(batch, &fault))?;
                let out = super::array_of(action, DType::F64, shape);
                let start = index * out.len();
                for (i, x) in out
                    .as_mut_slice::<f64>()
                    .unwrap_or_default()
                    .iter_mut()
                    .enumerate()
                {
                    *x = Number::at(array.data(), start + i).to_f64();
                }
                Ok(())
            }
            (Some(_), Value::Tuple(items)) if index < items.len() => {
                action.clone_from(&items[index]);
                Ok(())
            }
            _ => self.read_row(batch, index, action),
        }
    }

    /// Writes the numbers of an action (with `n`, of a batch of `n` actions) to `out`, as
    /// `np.asarray` converts them: in the type of the space if they have it, otherwise in
    /// `float64`. The space must be a `Box` of real numbers.
    ///
    /// # Errors
    /// [`Error::InvalidAction`](crate::Error::InvalidAction) for numbers in another shape.
    pub fn real_action(&self, action: &Value, n: Option<usize>, out: &mut Value) -> Result<()> {
        let refuse = || self.refuse_action(action);
        let (Some(row), Some(own)) = (self.shape_of_reals(), self.dtype()) else {
            return Err(refuse());
        };
        let fits = |shape: &[usize]| match n {
            Some(n) => shape.split_first() == Some((&n, row)),
            None => shape == row,
        };
        match action {
            Value::Array(array) if fits(array.shape()) => {
                let dtype = if array.dtype() == own {
                    own
                } else {
                    DType::F64
                };
                super::array_of(out, dtype, array.shape()).assign_cast(array)
            }
            Value::Tuple(items) if n.is_none_or(|n| n == items.len()) => {
                let mut numbers = Vec::new();
                flatten(action, &mut numbers).ok_or_else(refuse)?;
                let shape = n.into_iter().chain(row.iter().copied()).collect::<Vec<_>>();
                *out = Value::Array(Array::new(shape, Data::F64(numbers)).map_err(|_| refuse())?);
                Ok(())
            }
            _ => Err(refuse()),
        }
    }

    /// As [`check_batch`](Self::check_batch), for actions: the batch of a `Box` of real numbers may
    /// have any type, and may be a tuple of actions.
    ///
    /// # Errors
    /// As [`check_batch`](Self::check_batch).
    pub fn check_actions(&self, batch: &Value, n: usize) -> Result<()> {
        match (self.shape_of_reals(), batch) {
            (Some(shape), Value::Array(array)) if rows(array, shape) == Some(n) => Ok(()),
            (Some(_), Value::Tuple(items)) if items.len() == n => Ok(()),
            _ => self.check_batch(batch, n),
        }
    }

    /// The shape of a `Box` of real numbers.
    fn shape_of_reals(&self) -> Option<&[usize]> {
        if let Self::Box(space) = self {
            space.dtype().is_float().then(|| space.shape())
        } else {
            None
        }
    }
}

/// Appends the numbers of `value`; `None` if `value` contains anything but numbers.
fn flatten(value: &Value, numbers: &mut Vec<f64>) -> Option<()> {
    match value {
        Value::Array(array) => numbers.extend(array),
        Value::Tuple(items) => items.iter().try_for_each(|item| flatten(item, numbers))?,
        _ => numbers.push(value.as_float()?),
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_keep_their_precision() {
        let space = Space::boxed([-1.0; 2], [1.0; 2]);
        let rows = |data: Data| Value::Array(Array::new([2, 2], data).unwrap());
        let tenths: [f64; 4] = [0.1, 0.2, 0.3, 0.4];
        let one_by_one = Value::Tuple(vec![
            Value::Int(1),
            Value::Tuple(vec![Value::Float(0.3); 2]),
        ]);
        for (batch, expected) in [
            (
                rows(Data::F64(tenths.to_vec())),
                Value::Array([0.3, 0.4].into()),
            ),
            (
                rows(Data::F32(tenths.map(|x| x as f32).to_vec())),
                Value::Array([0.3_f32, 0.4].into()),
            ),
            (
                rows(Data::I64(vec![1, 2, 3, 4])),
                Value::Array([3.0, 4.0].into()),
            ),
            (one_by_one, Value::Tuple(vec![Value::Float(0.3); 2])),
        ] {
            space.check_actions(&batch, 2).unwrap();
            assert!(space.check_actions(&batch, 3).is_err());
            let mut action = Value::Null;
            space.read_action(&batch, 1, &mut action).unwrap();
            assert_eq!(action, expected);
            assert!(space.read_action(&batch, 2, &mut action).is_err());
        }
    }
}
