//! Typed views of the caller's columns.

use std::fmt;
use std::iter::zip;

use crate::array::{Array, Scalar};
use crate::{Element, Error, Result, Space, Value};

/// A type of observation that has a column in [`Columns`](crate::vector::Columns).
pub trait ObservationColumn: Element + Copy {
    /// The column, as slices.
    type Rows<'a>;

    /// The rows of a batch of observations; `None` if it has another form.
    fn rows(column: &mut Value) -> Option<Self::Rows<'_>>;

    /// Overwrites rows from `first` on.
    fn write_rows(rows: &mut Self::Rows<'_>, first: usize, observations: &[Self]);
}

fn numbers<T: Scalar>(column: &mut Value) -> Option<&mut [T]> {
    if let Value::Array(array) = column { array.as_mut_slice() } else { None }
}

impl<T: Scalar, const N: usize> ObservationColumn for [T; N] {
    type Rows<'a> = &'a mut [Self];

    fn rows(column: &mut Value) -> Option<Self::Rows<'_>> {
        numbers(column).map(|numbers| numbers.as_chunks_mut().0)
    }

    #[inline(always)]
    fn write_rows(rows: &mut Self::Rows<'_>, first: usize, observations: &[Self]) {
        rows[first..][..observations.len()].copy_from_slice(observations);
    }
}

impl ObservationColumn for usize {
    type Rows<'a> = &'a mut [i64];

    fn rows(column: &mut Value) -> Option<Self::Rows<'_>> {
        numbers(column)
    }

    #[inline(always)]
    fn write_rows(rows: &mut Self::Rows<'_>, first: usize, observations: &[Self]) {
        zip(&mut rows[first..][..observations.len()], observations).for_each(|(row, x)| *row = *x as i64);
    }
}

impl ObservationColumn for (usize, usize, usize) {
    type Rows<'a> = [&'a mut [i64]; 3];

    fn rows(column: &mut Value) -> Option<Self::Rows<'_>> {
        let Value::Tuple(columns) = column else { return None };
        let [a, b, c] = columns.as_mut_slice() else { return None };
        Some([numbers(a)?, numbers(b)?, numbers(c)?])
    }

    #[inline(always)]
    fn write_rows([a, b, c]: &mut Self::Rows<'_>, first: usize, observations: &[Self]) {
        for (i, (x, y, z)) in observations.iter().enumerate() {
            [a[first + i], b[first + i], c[first + i]] = [*x, *y, *z].map(|x| x as i64);
        }
    }
}

/// A type of action that can be read from a batch. [`discrete!`](crate::discrete) implements it.
pub trait ActionColumn: Element + Copy {
    /// What an action is in a batch.
    type Item: Copy + Default + fmt::Debug + Send + Sync + 'static;

    /// The actions of a batch of `n`; `None` if it has another form.
    fn items(batch: &Value, n: usize) -> Option<&[Self::Item]>;

    /// Whether that action can be executed.
    fn is_valid(item: Self::Item) -> bool;

    /// The action; an arbitrary one if the item is not valid.
    fn from_item(item: Self::Item) -> Self;

    /// Refuses an action that cannot be executed: most types have none.
    ///
    /// # Errors
    /// [`Error::InvalidAction`].
    #[inline(always)]
    fn check(&self, space: impl Fn() -> Space) -> Result<()> {
        let _ = space;
        Ok(())
    }
}

/// Numbers that need only be finite. Gymnasium lets NaN through, and every later state is then NaN. A finite number beyond
/// the bounds is left to the environment.
impl<const N: usize> ActionColumn for [f32; N]
where
    [f32; N]: Default,
{
    type Item = Self;

    fn items(batch: &Value, n: usize) -> Option<&[Self]> {
        let array = batch.as_array()?;
        (array.shape() == [n, N]).then(|| array.as_slice().map(|numbers| numbers.as_chunks().0))?
    }

    #[inline(always)]
    fn is_valid(item: Self) -> bool {
        item.iter().fold(true, |valid, x| valid & x.is_finite())
    }

    #[inline(always)]
    fn from_item(item: Self) -> Self {
        item
    }

    #[inline(always)]
    fn check(&self, space: impl Fn() -> Space) -> Result<()> {
        if Self::is_valid(*self) {
            return Ok(());
        }
        Err(Error::InvalidAction {
            action: format!("{self:?}"),
            space: space().to_string(),
            hint: "; it must be a finite number".into(),
        })
    }
}

/// The numbers of a batch of `n` elements of a `Discrete`.
pub fn indices(batch: &Value, n: usize) -> Option<&[i64]> {
    batch.as_array().filter(|array: &&Array| array.shape() == [n])?.as_slice()
}
