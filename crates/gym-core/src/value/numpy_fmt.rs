//! Arrays as numpy prints them; see [`gym_numerics::text`].

use gym_numerics::text::{self, Numbers};
pub(crate) use gym_numerics::text::{quoted, shape};

use crate::value::data::Data;
use crate::value::number::Number;

/// Calls `f` with the numbers of an array.
fn with<R>(data: &Data, f: impl FnOnce(Numbers<'_>) -> R) -> R {
    match data {
        Data::F32(values) => f(Numbers::F32(values)),
        Data::F64(values) => f(Numbers::F64(values)),
        _ => f(Numbers::Whole(&|index| {
            Number::at(data, index).to_int().unwrap_or_default()
        })),
    }
}

/// Formats a bound as Gymnasium's `Box` does: one number if all numbers are equal, else the array.
pub(crate) fn bound(data: &Data, shape: &[usize]) -> String {
    let mut numbers = Number::all(data);
    match numbers.next() {
        Some(first) if numbers.all(|number| number == first) => scalar(data, 0),
        _ => array(data, shape),
    }
}

/// numpy's `str` of an array.
pub(crate) fn array(data: &Data, shape: &[usize]) -> String {
    with(data, |numbers| text::array(numbers, shape))
}

/// numpy's `str` of one number.
pub(crate) fn scalar(data: &Data, index: usize) -> String {
    with(data, |numbers| text::scalar(numbers, index))
}

#[cfg(test)]
mod tests {
    use super::{quoted, scalar, shape};
    use crate::value::{Array, Data};

    fn array(array: &Array) -> String {
        super::array(array.data(), array.shape())
    }

    fn bound(array: &Array) -> String {
        super::bound(array.data(), array.shape())
    }

    fn f32s<const N: usize>(values: [f32; N]) -> String {
        array(&Array::from(values))
    }

    fn f64s<const N: usize>(values: [f64; N]) -> String {
        array(&Array::from(values))
    }

    #[test]
    fn real_numbers_align_at_the_point() {
        assert_eq!(
            f32s([-4.8, f32::NEG_INFINITY, -0.418_879_03, f32::NEG_INFINITY]),
            "[-4.8               -inf -0.41887903        -inf]"
        );
        assert_eq!(f64s([-1.0, 10.0]), "[-1. 10.]");
        assert_eq!(f64s([0.1, 0.123_456_789_123]), "[0.1        0.12345679]");
        assert_eq!(f64s([-0.0, 1.0, f64::NAN]), "[-0.  1. nan]");
        assert_eq!(f64s([f64::INFINITY, f64::NEG_INFINITY]), "[ inf -inf]");
        assert_eq!(
            f32s([-f32::INFINITY, 0.0, -1.0, -f32::INFINITY]),
            "[-inf   0.  -1. -inf]"
        );
    }

    #[test]
    fn exponents_where_numbers_spread() {
        assert_eq!(f64s([1e-5, 1.0]), "[1.e-05 1.e+00]");
        assert_eq!(f64s([1e8, -2.5]), "[ 1.0e+08 -2.5e+00]");
        assert_eq!(f32s([1e6, 1e6]), "[1.e+06 1.e+06]");
        assert_eq!(
            f64s([1e100, 2.0, f64::INFINITY]),
            "[1.e+100 2.e+000     inf]"
        );
        // After the shortest digits, numpy prints the digits of the exact value.
        assert_eq!(f32s([4.8, 3_402_823.5]), "[4.8000002e+00 3.4028235e+06]");
    }

    #[test]
    fn integers_align_to_the_right() {
        assert_eq!(array(&Array::from([10i64, -2])), "[10 -2]");
        assert_eq!(array(&Array::from([0u8, 255])), "[  0 255]");
    }

    #[test]
    fn lines_break_at_75_characters() {
        let text = array(&Array::from((0..40).collect::<Vec<i64>>()));
        assert_eq!(
            text,
            "[ 0  1  2  3  4  5  6  7  8  9 10 11 12 13 14 15 16 17 18 19 20 21 22 23\n \
              24 25 26 27 28 29 30 31 32 33 34 35 36 37 38 39]"
        );
    }

    #[test]
    fn axes_and_summaries() {
        let table = Array::from((0..6).collect::<Vec<i64>>());
        assert_eq!(
            array(&table.clone().reshape([2, 3]).unwrap()),
            "[[0 1 2]\n [3 4 5]]"
        );
        assert_eq!(
            array(&table.reshape([2, 1, 3]).unwrap()),
            "[[[0 1 2]]\n\n [[3 4 5]]]"
        );
        let long = Array::from((0..1001).collect::<Vec<i64>>());
        assert_eq!(array(&long), "[   0    1    2 ...  998  999 1000]");
        let wide = Array::from((0..1001).collect::<Vec<i64>>())
            .reshape([7, 143])
            .unwrap();
        assert_eq!(
            array(&wide),
            "[[   0    1    2 ...  140  141  142]\n [ 143  144  145 ...  283  284  285]\n \
             [ 286  287  288 ...  426  427  428]\n ...\n [ 572  573  574 ...  712  713  714]\n \
             [ 715  716  717 ...  855  856  857]\n [ 858  859  860 ...  998  999 1000]]"
        );
    }

    #[test]
    fn single_numbers_are_shortest() {
        let text = |x: f64| scalar(&Data::F64(vec![x]), 0);
        assert_eq!(text(-1.0), "-1.0");
        assert_eq!(text(1e15), "1000000000000000.0");
        assert_eq!(text(1e16), "1e+16");
        assert_eq!(text(1e-5), "1e-05");
        assert_eq!(text(0.0001), "0.0001");
        assert_eq!(text(f64::NEG_INFINITY), "-inf");
        let text = |x: f32| scalar(&Data::F32(vec![x]), 0);
        assert_eq!(text(999_999.0), "999999.0");
        assert_eq!(text(1e6), "1e+06");
        assert_eq!(text(f32::MAX), "3.4028235e+38");
        assert_eq!(text(0.1), "0.1");
        // The exact value is 3077606.25, a tie between two decimals of 8 digits.
        assert_eq!(text(3_077_606.3), "3.0776062e+06");
    }

    #[test]
    fn bounds_collapse() {
        assert_eq!(bound(&Array::from([1.5f32, 1.5])), "1.5");
        assert_eq!(bound(&Array::from([1.5f32, 2.0])), "[1.5 2. ]");
        assert_eq!(bound(&Array::from(Vec::<f32>::new())), "[]");
    }

    #[test]
    fn shapes_and_texts_as_in_python() {
        assert_eq!(shape(&[]), "()");
        assert_eq!(shape(&[3]), "(3,)");
        assert_eq!(shape(&[2, 3]), "(2, 3)");
        assert_eq!(quoted("a"), "'a'");
        assert_eq!(quoted("it's"), "\"it's\"");
        assert_eq!(quoted("'\"\\\n\u{7}"), "'\\'\"\\\\\\n\\x07'");
    }
}
