//! Spaces that differ only in their bounds: Gymnasium's `is_space_dtype_shape_equiv` and
//! `batch_differing_spaces`.

use super::batch::batch_space;
use super::{BoxSpace, DictSpace, Discrete, MultiDiscrete, Space, TupleSpace, invalid};
use crate::value::number::{Number, can_cast, collect};
use crate::value::{Array, Result};

impl Space {
    /// Whether elements of both spaces have the same form, so that one buffer fits either: the same
    /// kinds, shapes, types of numbers, keys and charsets; bounds may differ. Gymnasium's
    /// `is_space_dtype_shape_equiv`.
    pub fn has_form_of(&self, other: &Self) -> bool {
        let all = |a: &[Self], b: &[Self]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.has_form_of(b))
        };
        match (self, other) {
            (Self::Box(_), Self::Box(_))
            | (Self::Discrete(_), Self::Discrete(_))
            | (Self::MultiDiscrete(_), Self::MultiDiscrete(_))
            | (Self::MultiBinary(_), Self::MultiBinary(_)) => {
                self.shape() == other.shape() && self.dtype() == other.dtype()
            }
            (Self::Text(a), Self::Text(b)) => {
                a.max_length() == b.max_length() && a.charset() == b.charset()
            }
            (Self::Mission(a), Self::Mission(b)) => a == b,
            (Self::Tuple(a), Self::Tuple(b)) => all(a.spaces(), b.spaces()),
            (Self::OneOf(a), Self::OneOf(b)) => all(a.spaces(), b.spaces()),
            (Self::Dict(a), Self::Dict(b)) => {
                let (a, b) = (a.spaces(), b.spaces());
                a.len() == b.len()
                    && a.iter()
                        .zip(b)
                        .all(|(a, b)| a.0 == b.0 && a.1.has_form_of(&b.1))
            }
            (Self::Sequence(a), Self::Sequence(b)) => {
                a.is_stacked() == b.is_stacked() && a.feature_space().has_form_of(b.feature_space())
            }
            (Self::Graph(a), Self::Graph(b)) => {
                let edges = match (a.edge_space(), b.edge_space()) {
                    (Some(a), Some(b)) => a.has_form_of(b),
                    (a, b) => a.is_none() && b.is_none(),
                };
                edges && a.node_space().has_form_of(b.node_space())
            }
            _ => false,
        }
    }

    /// The space of one element of each of these spaces as one value, as [`batch`](Self::batch) is
    /// of elements of one space: Gymnasium's `batch_differing_spaces`.
    ///
    /// ```
    /// use gym_core::Space;
    /// let batch = Space::batch_differing(&[Space::discrete(3), Space::discrete(5)])?;
    /// assert_eq!(batch.to_string(), "MultiDiscrete([3 5])");
    /// # Ok::<(), gym_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::InvalidSpace`](crate::Error::InvalidSpace) if there are none, or if their kinds,
    /// shapes, keys or types of numbers differ. `Discrete`s may be of several types: the batch is
    /// of the largest.
    pub fn batch_differing(spaces: &[Self]) -> Result<Self> {
        let Some(first) = spaces.first() else {
            return invalid("there are no spaces to batch");
        };
        let kind = std::mem::discriminant(first);
        let is_array = first.dtype().is_some() && !matches!(first, Self::Discrete(_));
        let batches_with_first = |space: &&Self| {
            std::mem::discriminant(*space) == kind && (!is_array || space.has_form_of(first))
        };
        if let Some(other) = spaces.iter().find(|space| !batches_with_first(space)) {
            return invalid(format!(
                "{first} and {other} differ in more than their bounds"
            ));
        }
        Ok(match first {
            Self::Discrete(_) => {
                let discretes = || {
                    spaces.iter().filter_map(|space| match space {
                        Self::Discrete(space) => Some(space),
                        _ => None,
                    })
                };
                let widest = discretes().map(Discrete::dtype);
                let widest = widest.reduce(|a, b| if can_cast(b, a) { a } else { b });
                let batch = MultiDiscrete::new(discretes().map(Discrete::n).collect::<Vec<_>>())?
                    .with_start(discretes().map(Discrete::start).collect::<Vec<_>>())?;
                widest
                    .map_or(Ok(batch.clone()), |dtype| batch.with_dtype(dtype))?
                    .into()
            }
            Self::Tuple(tuple) => {
                let tuples = || {
                    spaces.iter().filter_map(|space| match space {
                        Self::Tuple(space) => Some(space.spaces()),
                        _ => None,
                    })
                };
                if tuples().any(|members| members.len() != tuple.spaces().len()) {
                    return invalid("the tuples have different numbers of members");
                }
                let member = |j: usize| {
                    Self::batch_differing(
                        &tuples().map(|spaces| spaces[j].clone()).collect::<Vec<_>>(),
                    )
                };
                TupleSpace::new(
                    (0..tuple.spaces().len())
                        .map(member)
                        .collect::<Result<Vec<_>>>()?,
                )
                .into()
            }
            Self::Dict(dict) => {
                let keys = |dict: &DictSpace| {
                    dict.spaces()
                        .iter()
                        .map(|(key, _)| key.clone())
                        .collect::<Vec<_>>()
                };
                let dicts = || {
                    spaces.iter().filter_map(|space| match space {
                        Self::Dict(space) => Some(space),
                        _ => None,
                    })
                };
                if dicts().any(|other| keys(other) != keys(dict)) {
                    return invalid("the dicts have different keys");
                }
                let member = |key: String| {
                    let members = dicts().filter_map(|dict| dict.get(&key).cloned());
                    Ok((
                        key.clone(),
                        Self::batch_differing(&members.collect::<Vec<_>>())?,
                    ))
                };
                DictSpace::in_order(
                    keys(dict)
                        .into_iter()
                        .map(member)
                        .collect::<Result<Vec<_>>>()?,
                )?
                .into()
            }
            _ => match first.shape().zip(first.dtype()) {
                Some((shape, dtype)) => {
                    let rows = spaces
                        .iter()
                        .map(|space| batch_space(space, 1))
                        .collect::<Result<Vec<_>>>()?;
                    let bound = |pick: fn(&BoxSpace) -> &Array| {
                        let arrays = rows.iter().filter_map(|row| match row {
                            Self::Box(space) => Some(pick(space)),
                            _ => None,
                        });
                        let numbers = arrays.flat_map(|array| Number::all(array.data()));
                        Array::new([&[spaces.len()], shape].concat(), collect(dtype, numbers))
                    };
                    BoxSpace::new(bound(BoxSpace::low)?, bound(BoxSpace::high)?)?.into()
                }
                None => TupleSpace::new(spaces.to_vec()).into(),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{MultiBinary, SequenceSpace, TextSpace};
    use crate::value::DType;

    /// The results of Gymnasium 1.4.0.
    #[test]
    fn spaces_with_other_bounds_batch() {
        let narrow = |n: i64| {
            Discrete::new(n)
                .unwrap()
                .with_dtype(DType::I32)
                .unwrap()
                .into()
        };
        let multi = |n: [i64; 2]| Space::from(MultiDiscrete::new(n).unwrap());
        let bits = || Space::from(MultiBinary::new([2]).unwrap());
        let text = |n| Space::from(TextSpace::new(1, n).unwrap());
        let pair = |n, high| {
            Space::from(TupleSpace::new([
                Space::discrete(n),
                Space::boxed([0.0], [high]),
            ]))
        };
        let dict = |n| {
            Space::from(
                DictSpace::new([("a", Space::discrete(n)), ("b", text(n as usize))]).unwrap(),
            )
        };
        for (spaces, batch) in [
            (vec![Space::discrete(3), narrow(5)], "MultiDiscrete([3 5])"),
            (vec![narrow(3), narrow(5)], "MultiDiscrete([3 5])"),
            (
                vec![
                    Space::boxed([0.0, -1.0], [1.0, 1.0]),
                    Space::boxed([-2.0, 0.0], [2.0, 3.0]),
                ],
                "Box([[ 0. -1.]\n [-2.  0.]], [[1. 1.]\n [2. 3.]], (2, 2), float32)",
            ),
            (
                vec![multi([2, 3]), multi([4, 5])],
                "Box(0, [[1 2]\n [3 4]], (2, 2), int64)",
            ),
            (vec![bits(), bits(), bits()], "Box(0, 1, (3, 2), int8)"),
            (
                vec![pair(2, 1.0), pair(4, 2.0)],
                "Tuple(MultiDiscrete([2 4]), Box(0.0, [[1.]\n [2.]], (2, 1), float32))",
            ),
            (
                vec![dict(2), dict(3)],
                "Dict('a': MultiDiscrete([2 3]), 'b': Tuple(Text(1, 2, charset=\
                 0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz), Text(1, 3, charset=\
                 0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz)))",
            ),
        ] {
            assert_eq!(Space::batch_differing(&spaces).unwrap().to_string(), batch);
        }
        let dtype = |spaces: &[Space]| Space::batch_differing(spaces).unwrap().dtype();
        assert_eq!(dtype(&[narrow(3), narrow(5)]), Some(DType::I32));
        assert_eq!(dtype(&[narrow(3), Space::discrete(5)]), Some(DType::I64));
        // one space as often as you like is an ordinary batch
        for space in [
            multi([2, 3]),
            bits(),
            text(3),
            pair(2, 1.0),
            dict(2),
            Space::discrete(4),
        ] {
            assert_eq!(
                Space::batch_differing(&vec![space.clone(); 3]).unwrap(),
                space.batch(3).unwrap()
            );
        }
        for spaces in [
            vec![],
            vec![Space::discrete(2), bits()],
            vec![Space::boxed([0.0], [1.0]), Space::boxed([0.0; 2], [1.0; 2])],
            vec![pair(2, 1.0), TupleSpace::new([Space::discrete(2)]).into()],
            vec![
                dict(2),
                DictSpace::new([("a", Space::discrete(2))]).unwrap().into(),
            ],
        ] {
            assert!(Space::batch_differing(&spaces).is_err(), "{spaces:?}");
        }
    }

    #[test]
    fn the_form_is_all_but_the_bounds() {
        let sequence = |high| Space::from(SequenceSpace::new(Space::boxed([0.0], [high])));
        assert!(sequence(1.0).has_form_of(&sequence(2.0)));
        assert!(
            !sequence(1.0).has_form_of(&SequenceSpace::stacked(Space::boxed([0.0], [1.0])).into())
        );
        assert!(Space::discrete(3).has_form_of(&Space::discrete(9)));
        assert!(!Space::discrete(3).has_form_of(&MultiDiscrete::new([3]).unwrap().into()));
        assert!(!Space::boxed([0.0], [1.0]).has_form_of(&Space::boxed([0.0; 2], [1.0; 2])));
        let double = BoxSpace::uniform(0.0, 1.0, [1], DType::F64).unwrap();
        assert!(!Space::boxed([0.0], [1.0]).has_form_of(&double.into()));
        let text = |n| Space::from(TextSpace::new(1, n).unwrap());
        assert!(text(2).has_form_of(&text(2)) && !text(2).has_form_of(&text(3)));
    }
}
