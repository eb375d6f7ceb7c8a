//! The element of a space that is nearest to zero: Gymnasium's `create_zero_array`.

use super::{MultiBinary, Space};
use crate::value::array::Array;
use crate::value::number::{Number, Numeric, with_type};
use crate::value::{GraphInstance, Result, Value};

impl Space {
    /// The element nearest to zero: zeros where the bounds allow, texts and sequences of the
    /// shortest length, one node without features, the first of several spaces.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) for a stacked sequence or a graph whose
    /// elements do not batch.
    pub fn zero(&self) -> Result<Value> {
        Ok(match self {
            Self::Box(space) => {
                let mut array = Array::zeros(space.dtype(), space.shape())?;
                with_type!(space.dtype(), T => {
                    let bounds = space.low().as_slice::<T>().zip(space.high().as_slice::<T>());
                    if let (Some(values), Some((low, high))) = (array.as_mut_slice::<T>(), bounds) {
                        nearest_to_zero(values, low, high);
                    }
                });
                Value::Array(array)
            }
            Self::Discrete(space) => Value::Int(space.start()),
            Self::MultiDiscrete(space) => Value::Array(space.array(space.start())),
            Self::MultiBinary(space) => {
                Value::Array(Array::zeros(MultiBinary::DTYPE, space.shape())?)
            }
            Self::Text(space) => {
                let first = space.charset().first().copied().unwrap_or_default();
                Value::Text(std::iter::repeat_n(first, space.min_length()).collect())
            }
            Self::Mission(space) => space.corner(false),
            Self::Tuple(space) => space.value(Self::zero)?,
            Self::Dict(space) => space.value(Self::zero)?,
            Self::Sequence(space) if space.is_stacked() => {
                space.feature_space().batch(0)?.zero()?
            }
            Self::Sequence(_) => Value::Tuple(Vec::new()),
            Self::Graph(space) => {
                let row = |space: &Self| space.batch(1)?.zero();
                let edges = space.edge_space().map(row).transpose()?;
                let edge_links = edges
                    .as_ref()
                    .map(|_| Array::zeros(crate::value::DType::I32, [1, 2]))
                    .transpose()?;
                let nodes = row(space.node_space())?;
                Value::Graph(Box::new(GraphInstance {
                    nodes,
                    edges,
                    edge_links,
                }))
            }
            Self::OneOf(space) => match space.spaces().first() {
                Some(first) => Value::OneOf(0, Box::new(first.zero()?)),
                None => Value::Null,
            },
        })
    }
}

fn nearest_to_zero<T: Numeric>(values: &mut [T], low: &[T], high: &[T]) {
    let zero = T::cast(Number::Int(0));
    for (x, (low, high)) in values.iter_mut().zip(low.iter().zip(high)) {
        *x = if *low > zero {
            *low
        } else if *high < zero {
            *high
        } else {
            zero
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{Discrete, TextSpace, TupleSpace};

    #[test]
    fn zeros_are_elements() {
        let space: Space = TupleSpace::new([
            Space::boxed([-1.0, 0.5, -3.0], [1.0, 2.0, -2.0]),
            Discrete::new(3).unwrap().with_start(4).unwrap().into(),
            TextSpace::new(2, 5).unwrap().into(),
        ])
        .into();
        let zero = space.zero().unwrap();
        assert!(space.contains(&zero), "{zero}");
        assert_eq!(
            zero.as_tuple().unwrap()[0],
            Value::Array([0.0f32, 0.5, -2.0].into())
        );
        assert_eq!(zero.as_tuple().unwrap()[1], Value::Int(4));
    }
}
