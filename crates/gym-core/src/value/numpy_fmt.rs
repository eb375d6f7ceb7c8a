//! Arrays as numpy prints them with `str`: columns aligned, at most 8 decimals, lines of 75
//! characters, and only the edges of more than 1000 numbers.
//!
//! After numpy's `arrayprint.py` (v2.4.6) with its default `set_printoptions`.

use std::fmt::LowerExp;
use std::str::FromStr;

use crate::value::data::Data;
use crate::value::number::Number;

const PRECISION: usize = 8;
const LINE_WIDTH: usize = 75;
const THRESHOLD: usize = 1000;
const EDGE_ITEMS: usize = 3;

/// A bound as `Box` prints it: one number if all are equal, else the array.
pub(crate) fn bound(data: &Data, shape: &[usize]) -> String {
    let mut numbers = Number::all(data);
    match numbers.next() {
        Some(first) if numbers.all(|number| number == first) => scalar(data, 0),
        _ => array(data, shape),
    }
}

/// numpy's `str` of an array.
pub(crate) fn array(data: &Data, shape: &[usize]) -> String {
    let len: usize = shape.iter().product();
    match (len, shape) {
        (0, _) => return "[]".to_owned(),
        (_, []) => return scalar(data, 0),
        _ => {}
    }
    let summarise = len > THRESHOLD;
    let mut shown = Vec::new();
    corners(shape, summarise, 0, &mut shown);
    Layout {
        shape,
        summarise,
        data,
        style: Style::of(data, &shown),
    }
    .rows(0, 0, LINE_WIDTH)
}

/// A shape as Python prints a tuple: `()`, `(3,)`, `(2, 3)`.
pub(crate) fn shape(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => format!(
            "({})",
            shape
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        ),
    }
}

/// Text as Python's `repr` quotes it.
pub(crate) fn quoted(text: &str) -> String {
    let quote = if text.contains('\'') && !text.contains('"') {
        '"'
    } else {
        '\''
    };
    let mut out = String::from(quote);
    for c in text.chars() {
        match c {
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            '\\' => out.push_str("\\\\"),
            _ if c == quote => out.extend(['\\', c]),
            _ if c.is_control() => out.push_str(&format!("\\x{:02x}", c as u32)),
            _ => out.push(c),
        }
    }
    out.push(quote);
    out
}

/// numpy's `str` of one number: the fewest digits that distinguish it from its neighbours.
pub(crate) fn scalar(data: &Data, index: usize) -> String {
    // From here on numpy writes an exponent: 10^6 has all the digits that float32 surely holds;
    // 10^16 is the tradition of C for float64.
    let end = match data {
        Data::F32(_) => 1e6,
        Data::F64(_) => 1e16,
        _ => return integer(data, index).to_string(),
    };
    let x = data.get_f64(index);
    if !x.is_finite() {
        return non_finite(x).to_owned();
    }
    if x == 0.0 || (1e-4..end).contains(&x.abs()) {
        let text = positional(data, index, usize::MAX);
        return if text.ends_with('.') {
            text + "0"
        } else {
            text
        };
    }
    let text = scientific(data, index, usize::MAX);
    let (mantissa, exponent) = split_exponent(&text);
    format!(
        "{}{}",
        mantissa.trim_end_matches('.'),
        pad_exponent(exponent, 2)
    )
}

fn integer(data: &Data, index: usize) -> i128 {
    match Number::at(data, index) {
        Number::Int(i) => i,
        Number::Float(x) => x as i128,
    }
}

/// The indices of the numbers that are printed; only these align the columns.
fn corners(shape: &[usize], summarise: bool, start: usize, out: &mut Vec<usize>) {
    let Some((&n, inner)) = shape.split_first() else {
        out.push(start);
        return;
    };
    let stride: usize = inner.iter().product();
    for i in 0..n {
        if !(summarise && is_left_out(i, n)) {
            corners(inner, summarise, start + i * stride, out);
        }
    }
}

fn is_left_out(i: usize, n: usize) -> bool {
    n > 2 * EDGE_ITEMS && (EDGE_ITEMS..n - EDGE_ITEMS).contains(&i)
}

/// The format of the numbers of one array, which aligns them.
enum Style {
    Integer {
        width: usize,
    },
    /// `left` characters before the point, `right` after it.
    Positional {
        left: usize,
        right: usize,
    },
    /// `left` characters before the point, `digits` after it, `exponent` digits in the exponent.
    Scientific {
        left: usize,
        digits: usize,
        exponent: usize,
    },
}

impl Style {
    fn of(data: &Data, shown: &[usize]) -> Self {
        if !data.dtype().is_float() {
            let width = shown
                .iter()
                .map(|&i| integer(data, i).to_string().len())
                .max();
            return Self::Integer {
                width: width.unwrap_or(0),
            };
        }
        let (finite, other): (Vec<usize>, Vec<usize>) =
            shown.iter().partition(|&&i| data.get_f64(i).is_finite());
        let needs_exponent = needs_exponent(data, &finite);
        let parts = |i: &usize| {
            let text = if needs_exponent {
                scientific(data, *i, PRECISION)
            } else {
                positional(data, *i, PRECISION)
            };
            let (number, exponent) = split_exponent(&text);
            let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
            (
                whole.len(),
                fraction.len(),
                pad_exponent(exponent, 2).len() - 2,
            )
        };
        let (mut left, right, exponent) = finite
            .iter()
            .map(parts)
            .fold((0, 0, 0), |a, b| (a.0.max(b.0), a.1.max(b.1), a.2.max(b.2)));
        // `inf` and `-inf` may stick out to the left.
        let after_point = if needs_exponent {
            exponent + 2 + right
        } else {
            right
        };
        if let Some(longest) = other
            .iter()
            .map(|&i| non_finite(data.get_f64(i)).len())
            .max()
        {
            left = left.max(longest.saturating_sub(after_point + 1));
        }
        if needs_exponent {
            Self::Scientific {
                left,
                digits: right,
                exponent,
            }
        } else {
            Self::Positional { left, right }
        }
    }

    fn write(&self, data: &Data, index: usize) -> String {
        let (left, total) = match *self {
            Self::Integer { width } => return format!("{:>width$}", integer(data, index)),
            Self::Positional { left, right } => (left, left + 1 + right),
            Self::Scientific {
                left,
                digits,
                exponent,
            } => (left, left + 1 + digits + exponent + 2),
        };
        let x = data.get_f64(index);
        if !x.is_finite() {
            return format!("{:>total$}", non_finite(x));
        }
        let text = match *self {
            Self::Scientific {
                digits, exponent, ..
            } => {
                let text = shortest(data, index);
                let is_exact = fraction_len(&text) == digits;
                let text = if is_exact {
                    text
                } else {
                    format!("{x:.digits$e}")
                };
                let (mantissa, power) = split_exponent(&text);
                let point = if digits == 0 { "." } else { "" };
                format!("{mantissa}{point}{}", pad_exponent(power, exponent))
            }
            _ => positional(data, index, PRECISION),
        };
        let indent = left.saturating_sub(text.find('.').unwrap_or(text.len()));
        format!("{:<total$}", format!("{:indent$}{text}", ""))
    }
}

/// Whether the numbers spread too far, or are too large or small, for plain decimals. As in numpy,
/// this is reckoned in the precision of the array.
fn needs_exponent(data: &Data, finite: &[usize]) -> bool {
    let sizes = finite.iter();
    match data {
        Data::F32(x) => spread(sizes.map(|&i| x[i].abs()), [0.0, 1e6, 0.0001, 1000.0]),
        Data::F64(x) => spread(sizes.map(|&i| x[i].abs()), [0.0, 1e8, 0.0001, 1000.0]),
        _ => false,
    }
}

/// Whether the largest size other than `zero` is at least `end`, the smallest below `least`, or
/// their ratio above `ratio`.
fn spread<T: Copy + PartialOrd + std::ops::Div<Output = T>>(
    sizes: impl Iterator<Item = T>,
    [zero, end, least, ratio]: [T; 4],
) -> bool {
    let mut range: Option<(T, T)> = None;
    for x in sizes.filter(|&x| x != zero) {
        let (min, max) = range.unwrap_or((x, x));
        range = Some((if x < min { x } else { min }, if x > max { x } else { max }));
    }
    range.is_some_and(|(min, max)| max >= end || min < least || max / min > ratio)
}

fn non_finite(x: f64) -> &'static str {
    if x.is_nan() {
        "nan"
    } else if x < 0.0 {
        "-inf"
    } else {
        "inf"
    }
}

/// With a decimal point and the fewest digits, at most `places` after it: `0.1`, `3.`,
/// `-0.41887903`.
fn positional(data: &Data, index: usize, places: usize) -> String {
    let text = shortest(data, index);
    let exponent: i32 = split_exponent(&text).1.parse().unwrap_or(0);
    let shortest_places = usize::try_from(fraction_len(&text) as i32 - exponent).unwrap_or(0);
    if shortest_places > places {
        return format!("{:.places$}", data.get_f64(index))
            .trim_end_matches('0')
            .to_owned();
    }
    let point = if shortest_places == 0 { "." } else { "" };
    format!(
        "{:.shortest_places$}{point}",
        text.parse::<f64>().unwrap_or(f64::NAN)
    )
}

/// With an exponent and the fewest digits, at most `places` after the point: `1.5e-5`, `3.e10`.
fn scientific(data: &Data, index: usize, places: usize) -> String {
    let text = shortest(data, index);
    let is_cut = fraction_len(&text) > places;
    let text = if is_cut {
        format!("{:.places$e}", data.get_f64(index))
    } else {
        text
    };
    let (mantissa, exponent) = split_exponent(&text);
    let mantissa = if is_cut {
        mantissa.trim_end_matches('0')
    } else {
        mantissa
    };
    let point = if mantissa.contains('.') { "" } else { "." };
    format!("{mantissa}{point}e{exponent}")
}

/// The fewest digits that read back as this number, in the form `-1.5e-5`.
fn shortest(data: &Data, index: usize) -> String {
    /// Of two such decimals that are equally near, numpy takes the even one, as the exact value
    /// rounded to so many digits does.
    fn even<T: LowerExp + FromStr + PartialEq + Copy>(x: T, exact: f64) -> String {
        let text = format!("{x:e}");
        let rounded = format!("{exact:.*e}", fraction_len(&text));
        if rounded.parse().is_ok_and(|rounded: T| rounded == x) {
            rounded
        } else {
            text
        }
    }
    match data {
        Data::F32(values) => even(values[index], values[index].into()),
        _ => even(data.get_f64(index), data.get_f64(index)),
    }
}

/// The number of digits between the point and the exponent.
fn fraction_len(text: &str) -> usize {
    split_exponent(text)
        .0
        .split_once('.')
        .map_or(0, |(_, fraction)| fraction.len())
}

fn split_exponent(text: &str) -> (&str, &str) {
    text.split_once('e').unwrap_or((text, "0"))
}

/// `e-05` for `-5`.
fn pad_exponent(exponent: &str, digits: usize) -> String {
    let (sign, power) = exponent
        .strip_prefix('-')
        .map_or(('+', exponent), |power| ('-', power));
    format!("e{sign}{power:0>digits$}")
}

/// The destination of the numbers.
struct Layout<'a> {
    shape: &'a [usize],
    summarise: bool,
    data: &'a Data,
    style: Style,
}

impl Layout<'_> {
    /// The part of the array below one index per axis passed, in brackets.
    fn rows(&self, axis: usize, start: usize, width: usize) -> String {
        let n = self.shape[axis];
        let stride: usize = self.shape[axis + 1..].iter().product();
        let is_last_axis = axis + 1 == self.shape.len();
        let items = (0..n).filter_map(|i| {
            if !(self.summarise && is_left_out(i, n)) {
                let start = start + i * stride;
                Some(if is_last_axis {
                    self.style.write(self.data, start)
                } else {
                    self.rows(axis + 1, start, width.saturating_sub(1))
                })
            } else {
                (i == EDGE_ITEMS).then(|| "...".to_owned())
            }
        });
        let indent = " ".repeat(axis + 1);
        let body = if is_last_axis {
            fill(items, &indent, width.saturating_sub(1))
        } else {
            let blank_lines = "\n".repeat(self.shape.len() - axis - 1);
            items
                .collect::<Vec<_>>()
                .join(&format!("{blank_lines}{indent}"))
        };
        format!("[{body}]")
    }
}

/// The words in lines of a width, each line but the first indented.
fn fill(words: impl Iterator<Item = String>, indent: &str, width: usize) -> String {
    let mut text = String::new();
    let mut line = indent.to_owned();
    for (i, word) in words.enumerate() {
        if i > 0 {
            line.push(' ');
        }
        if line.len() + word.len() > width && line.len() > indent.len() {
            text.push_str(line.trim_end());
            text.push('\n');
            line = indent.to_owned();
        }
        line.push_str(&word);
    }
    text.push_str(&line);
    text.split_off(indent.len())
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
        // Digits beyond the shortest are those of the exact value.
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
        // Exactly 3077606.25, half way between two decimals of 8 digits.
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
