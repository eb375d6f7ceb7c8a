//! The space of flat elements: Gymnasium's `flatten_space` and `flatdim`.

use std::iter::{once, repeat_n};

use crate::value::array::{Array, element_count};
use crate::value::number::{Number, collect, result_type};
use crate::value::{DType, Result};

use super::{BoxSpace, GraphSpace, MAX_ELEMENTS, OneOfSpace, SequenceSpace, Space, invalid};

impl Space {
    /// Whether elements flatten to an array of fixed length: all except `Sequence`, `Graph`,
    /// `Mission` and spaces that contain them. Gymnasium's `is_np_flattenable`.
    pub fn is_flattenable(&self) -> bool {
        match self {
            Self::Sequence(_) | Self::Graph(_) | Self::Mission(_) => false,
            _ => self.members().into_iter().all(Self::is_flattenable),
        }
    }

    /// The length of flat elements.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if the space
    /// [does not flatten](Self::is_flattenable) to an array, or to one of more than 2^28 numbers.
    pub fn flatdim(&self) -> Result<usize> {
        if !self.is_flattenable() {
            return invalid(format!(
                "{self} does not flatten to an array: its elements vary in length"
            ));
        }
        let len = self.flat_len().filter(|len| *len <= MAX_ELEMENTS);
        len.map_or_else(|| invalid(format!("{self} is too large to flatten")), Ok)
    }

    /// The space of the flat elements. It is a `Box` if the space is
    /// [flattenable](Self::is_flattenable), else a space of the same kind with flat members.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if an inner tuple or dict has no
    /// members, and so no type of number.
    pub fn flatten_space(&self) -> Result<Self> {
        Ok(match self {
            _ if self.is_flattenable() => self.flat_box()?.into(),
            Self::Tuple(space) => space.map(Self::flatten_space)?.into(),
            Self::Dict(space) => space.map(Self::flatten_space)?.into(),
            Self::Sequence(space) => {
                let build = if space.is_stacked() {
                    SequenceSpace::stacked
                } else {
                    SequenceSpace::new
                };
                build(space.feature_space().flatten_space()?).into()
            }
            Self::Graph(space) => {
                let edge_space = space.edge_space().map(Self::flatten_space).transpose()?;
                GraphSpace::new(space.node_space().flatten_space()?, edge_space)?.into()
            }
            _ => return self.flatdim().map(|_| self.clone()),
        })
    }

    /// [`flatten_space`](Self::flatten_space) of a flattenable space.
    pub(super) fn flat_box(&self) -> Result<BoxSpace> {
        let (dtype, len) = (self.flat_dtype()?, self.flatdim()?);
        let flat = |array: &Array| array.clone().reshape([len]);
        match self {
            Self::Box(space) => BoxSpace::new(flat(space.low())?, flat(space.high())?),
            Self::Discrete(_) | Self::MultiDiscrete(_) | Self::MultiBinary(_) => {
                BoxSpace::uniform(0.0, 1.0, [len], dtype)
            }
            Self::Text(space) => BoxSpace::uniform(0.0, space.charset().len() as f64, [len], dtype),
            Self::OneOf(space) => flat_one_of(space, dtype, len),
            _ => {
                let boxes = self
                    .members()
                    .into_iter()
                    .map(Self::flat_box)
                    .collect::<Result<Vec<_>>>()?;
                let join = |bound: fn(&BoxSpace) -> &Array| {
                    let numbers = boxes
                        .iter()
                        .flat_map(|space| Number::all(bound(space).data()));
                    Array::new([len], collect(dtype, numbers))
                };
                BoxSpace::new(join(BoxSpace::low)?, join(BoxSpace::high)?)
            }
        }
    }

    /// The type of flat elements.
    pub(super) fn flat_dtype(&self) -> Result<DType> {
        if let Some(dtype) = self.dtype() {
            return Ok(dtype);
        }
        if let Self::Text(_) = self {
            return Ok(DType::I32);
        }
        let dtypes = self
            .members()
            .into_iter()
            .map(Self::flat_dtype)
            .collect::<Result<Vec<_>>>()?;
        let Some(dtype) = result_type(dtypes) else {
            return invalid(format!("{self} has no members, so it cannot be flattened"));
        };
        let Self::OneOf(space) = self else {
            return Ok(dtype);
        };
        // The type must represent the index too.
        let last = Number::Int(space.spaces().len() as i128 - 1);
        let index = [DType::U8, DType::U16, DType::U32, DType::U64]
            .into_iter()
            .find(|&index| last.fits(index));
        Ok(result_type(once(dtype).chain(index.filter(|_| !last.fits(dtype)))).unwrap_or(dtype))
    }

    /// The length of flat elements, if the space is flattenable and the length fits `usize`.
    pub(super) fn flat_len(&self) -> Option<usize> {
        match self {
            Self::Box(space) => element_count(space.shape()),
            Self::MultiBinary(space) => element_count(space.shape()),
            Self::Discrete(space) => space.n().try_into().ok(),
            Self::MultiDiscrete(space) => {
                let total = space
                    .nvec()
                    .iter()
                    .try_fold(0, |sum: i64, &n| sum.checked_add(n));
                total?.try_into().ok()
            }
            Self::Text(space) => Some(space.max_length()),
            Self::Mission(_) => None,
            Self::OneOf(space) => {
                let lens = space
                    .spaces()
                    .iter()
                    .map(Self::flat_len)
                    .collect::<Option<Vec<_>>>()?;
                lens.into_iter().max()?.checked_add(1)
            }
            _ => self
                .members()
                .into_iter()
                .try_fold(0, |sum: usize, space| sum.checked_add(space.flat_len()?)),
        }
    }
}

/// Returns the flat space of a `OneOf`: an index, then numbers between the least and the greatest
/// bound of all its spaces.
fn flat_one_of(space: &OneOfSpace, dtype: DType, len: usize) -> Result<BoxSpace> {
    let boxes = space
        .spaces()
        .iter()
        .map(Space::flat_box)
        .collect::<Result<Vec<_>>>()?;
    // an element without numbers is filled up with zeros (Gymnasium raises)
    let filling = boxes
        .iter()
        .any(|space| space.low().is_empty())
        .then_some(Number::Int(0));
    let lows = boxes
        .iter()
        .flat_map(|space| Number::all(space.low().data()))
        .chain(filling);
    let highs = boxes
        .iter()
        .flat_map(|space| Number::all(space.high().data()))
        .chain(filling);
    let low = lows
        .reduce(|a, b| if b < a { b } else { a })
        .unwrap_or(Number::Int(0));
    let high = highs
        .reduce(|a, b| if b > a { b } else { a })
        .unwrap_or(Number::Int(0));
    let bounds = |index: usize, bound: Number| {
        let index = Number::Int(index as i128);
        Array::new(
            [len],
            collect(dtype, once(index).chain(repeat_n(bound, len - 1))),
        )
    };
    BoxSpace::new(bounds(0, low)?, bounds(boxes.len() - 1, high)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{Discrete, MultiBinary, MultiDiscrete, TextSpace, TupleSpace};

    fn flat(space: impl Into<Space>) -> String {
        space.into().flatten_space().unwrap().to_string()
    }

    fn discrete(n: i64, dtype: DType) -> Space {
        Discrete::new(n).unwrap().with_dtype(dtype).unwrap().into()
    }

    #[test]
    fn flat_spaces_are_gymnasiums() {
        let square = || Space::from(BoxSpace::uniform(-1.0, 1.0, [2, 2], DType::F32).unwrap());
        assert_eq!(flat(square()), "Box(-1.0, 1.0, (4,), float32)");
        assert_eq!(
            flat(BoxSpace::uniform(0.0, 1.0, [], DType::U8).unwrap()),
            "Box(0, 1, (1,), uint8)"
        );
        assert_eq!(flat(Space::discrete(5)), "Box(0, 1, (5,), int64)");
        assert_eq!(
            flat(MultiDiscrete::new([2, 3]).unwrap()),
            "Box(0, 1, (5,), int64)"
        );
        assert_eq!(
            flat(MultiBinary::new([2, 3]).unwrap()),
            "Box(0, 1, (6,), int8)"
        );
        let text = || Space::from(TextSpace::new(1, 4).unwrap().with_charset("ab").unwrap());
        assert_eq!(flat(text()), "Box(0, 2, (4,), int32)");
        assert_eq!(
            flat(TupleSpace::new([Space::discrete(2), square()])),
            "Box([ 0.  0. -1. -1. -1. -1.], 1.0, (6,), float64)"
        );
        assert_eq!(
            flat(OneOfSpace::new([text(), discrete(3, DType::I8)]).unwrap()),
            "Box(0, [1 2 2 2 2], (5,), int32)"
        );
        assert_eq!(
            flat(SequenceSpace::stacked(Space::discrete(2))),
            "Sequence(Box(0, 1, (2,), int64), stack=True)"
        );
        let graph = GraphSpace::new(square(), Some(Space::discrete(2))).unwrap();
        assert_eq!(
            flat(TupleSpace::new([graph.into(), text()])),
            "Tuple(Graph(Box(-1.0, 1.0, (4,), float32), Box(0, 1, (2,), int64)), Box(0, 2, (4,), int32))"
        );
    }

    #[test]
    fn the_type_of_one_of_holds_the_index() {
        let of = |n| Space::from(OneOfSpace::new(vec![discrete(2, DType::I8); n]).unwrap());
        assert_eq!(of(128).flat_dtype().unwrap(), DType::I8);
        assert_eq!(of(129).flat_dtype().unwrap(), DType::I16);
    }

    #[test]
    fn varying_lengths_do_not_flatten_to_an_array() {
        let sequence = Space::from(SequenceSpace::new(Space::discrete(2)));
        assert!(!sequence.is_flattenable());
        assert!(
            sequence
                .flatdim()
                .unwrap_err()
                .to_string()
                .contains("vary in length")
        );
        let one_of = Space::from(OneOfSpace::new([sequence]).unwrap());
        assert!(!one_of.is_flattenable() && one_of.flatten_space().is_err());
        let empty = Space::from(TupleSpace::new([]));
        assert!(empty.is_flattenable() && empty.flatten_space().is_err());
        assert_eq!(empty.flatdim().unwrap(), 0);
        let huge = MultiDiscrete::new([i64::MAX, i64::MAX]).unwrap();
        assert!(Space::from(huge).flatdim().is_err());
    }
}
