//! A typed view of the caller's column of observations.

use std::iter::zip;

use gym_core::array::Scalar;
use gym_core::{Element, Value};

/// A type of observations for which [`Columns`](gym_core::vector::Columns) has a column.
pub trait ObservationColumn: Element + Copy {
    /// Slices of the column.
    type Rows<'a>;

    /// The rows of a batch of observations; `None` if the batch has another form.
    fn rows(column: &mut Value) -> Option<Self::Rows<'_>>;

    /// Overwrites rows from `first` on.
    fn write_rows(rows: &mut Self::Rows<'_>, first: usize, observations: &[Self]);
}

fn numbers<T: Scalar>(column: &mut Value) -> Option<&mut [T]> {
    if let Value::Array(array) = column {
        array.as_mut_slice()
    } else {
        None
    }
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
        zip(&mut rows[first..][..observations.len()], observations)
            .for_each(|(row, x)| *row = *x as i64);
    }
}

impl ObservationColumn for (usize, usize, usize) {
    type Rows<'a> = [&'a mut [i64]; 3];

    fn rows(column: &mut Value) -> Option<Self::Rows<'_>> {
        let Value::Tuple(columns) = column else {
            return None;
        };
        let [a, b, c] = columns.as_mut_slice() else {
            return None;
        };
        Some([numbers(a)?, numbers(b)?, numbers(c)?])
    }

    #[inline(always)]
    fn write_rows([a, b, c]: &mut Self::Rows<'_>, first: usize, observations: &[Self]) {
        for (i, (x, y, z)) in observations.iter().enumerate() {
            [a[first + i], b[first + i], c[first + i]] = [*x, *y, *z].map(|x| x as i64);
        }
    }
}
