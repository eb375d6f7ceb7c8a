//! Batches of actions as slices of one type.

use crate::spaces::Space;
use crate::value::{Array, Continuous, Data, Element, Result, Value};

/// A type of action that can be read from a batch. [`discrete!`](crate::discrete) implements it.
pub trait ActionColumn: Element + Copy {
    /// The form of an action in a batch.
    type Item: Element + Copy + Default + Sync;

    /// The actions of a batch.
    type Items<'a>: Copy;

    /// The actions of a batch of `n`; `None` if the batch has another form.
    fn items(batch: &Value, n: usize) -> Option<Self::Items<'_>>;

    /// A single action.
    fn item(items: Self::Items<'_>, index: usize) -> Self::Item;

    /// The `len` actions from `first` on: a part of the batch, or a copy in `room`.
    fn block<'r, 'a: 'r, const LEN: usize>(
        items: Self::Items<'a>,
        first: usize,
        len: usize,
        room: &'r mut [Self::Item; LEN],
    ) -> &'r [Self::Item; LEN];

    /// Whether all `n` actions can be executed.
    fn all_valid(items: Self::Items<'_>, n: usize) -> bool;

    /// Whether an action can be executed.
    fn is_valid(item: Self::Item) -> bool;

    /// The action; an arbitrary one if the item is not valid.
    fn from_item(item: Self::Item) -> Self;

    /// Refuses an action that cannot be executed. Most types have no such actions.
    #[inline(always)]
    fn check(&self, space: impl Fn() -> Space) -> Result<()> {
        let _ = space;
        Ok(())
    }
}

/// A block of a slice: a part of the slice, or a copy in `room` if the block is the last and not
/// full.
#[inline(always)]
#[doc(hidden)]
pub fn block_of<'r, 'a: 'r, T: Copy, const LEN: usize>(
    items: &'a [T],
    first: usize,
    len: usize,
    room: &'r mut [T; LEN],
) -> &'r [T; LEN] {
    items[first..].first_chunk().unwrap_or_else(|| {
        room[..len].copy_from_slice(&items[first..][..len]);
        room
    })
}

/// A batch of actions: rows of one type, or actions one by one.
#[derive(Clone, Copy, Debug)]
pub enum Actions<'a, const N: usize> {
    /// `float32`.
    Single(&'a [[f32; N]]),
    /// `float64`.
    Double(&'a [[f64; N]]),
    /// A list with one value per action.
    Each(&'a [Value]),
}

/// Numbers that need only be finite. Gymnasium lets NaN through, and every later state is then NaN.
/// A finite number beyond the bounds is left to the environment.
impl<const N: usize> ActionColumn for Continuous<N> {
    type Item = Self;
    type Items<'a> = Actions<'a, N>;

    fn items(batch: &Value, n: usize) -> Option<Actions<'_, N>> {
        match batch {
            Value::Array(array) if array.shape() == [n, N] => rows_of(array),
            Value::Tuple(items) if items.len() == n => {
                let fits = items.iter().all(|item| Self::from_value(item).is_some());
                fits.then_some(Actions::Each(items))
            }
            _ => None,
        }
    }

    fn item(items: Actions<'_, N>, index: usize) -> Self {
        match items {
            Actions::Single(rows) => Self::from(rows[index]),
            Actions::Double(rows) => Self::from(rows[index]),
            Actions::Each(items) => Self::from_value(&items[index]).unwrap_or_default(),
        }
    }

    #[inline(always)]
    fn block<'r, 'a: 'r, const LEN: usize>(
        items: Actions<'a, N>,
        first: usize,
        len: usize,
        room: &'r mut [Self; LEN],
    ) -> &'r [Self; LEN] {
        match items {
            Actions::Single(rows) => fill(room, &rows[first..][..len]),
            Actions::Double(rows) => fill(room, &rows[first..][..len]),
            Actions::Each(_) => {
                room.iter_mut()
                    .zip(first..first + len)
                    .for_each(|(x, i)| *x = Self::item(items, i));
            }
        }
        room
    }

    #[inline(always)]
    fn all_valid(items: Actions<'_, N>, n: usize) -> bool {
        match items {
            Actions::Single(rows) => rows
                .as_flattened()
                .iter()
                .fold(true, |valid, x| valid & x.is_finite()),
            Actions::Double(rows) => rows
                .as_flattened()
                .iter()
                .fold(true, |valid, x| valid & x.is_finite()),
            Actions::Each(_) => (0..n).all(|i| Self::item(items, i).is_finite()),
        }
    }

    #[inline(always)]
    fn is_valid(item: Self) -> bool {
        item.is_finite()
    }

    #[inline(always)]
    fn from_item(item: Self) -> Self {
        item
    }

    #[inline(always)]
    fn check(&self, space: impl Fn() -> Space) -> Result<()> {
        if self.is_finite() {
            Ok(())
        } else {
            Err(space().refuse_action(self))
        }
    }
}

/// The rows of an array of a real type.
fn rows_of<const N: usize>(array: &Array) -> Option<Actions<'_, N>> {
    match array.data() {
        Data::F32(numbers) => Some(Actions::Single(numbers.as_chunks().0)),
        Data::F64(numbers) => Some(Actions::Double(numbers.as_chunks().0)),
        _ => None,
    }
}

#[inline(always)]
fn fill<T: Copy, const N: usize, const LEN: usize>(room: &mut [Continuous<N>; LEN], rows: &[[T; N]])
where
    Continuous<N>: From<[T; N]>,
{
    room.iter_mut()
        .zip(rows)
        .for_each(|(x, row)| *x = Continuous::from(*row));
}

/// The numbers of a batch of `n` elements of a `Discrete`.
#[doc(hidden)]
pub fn indices(batch: &Value, n: usize) -> Option<&[i64]> {
    batch
        .as_array()
        .filter(|array: &&Array| array.shape() == [n])?
        .as_slice()
}
