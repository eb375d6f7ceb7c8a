//! Text for messages, and as Python prints it: shapes, strings, and arrays as numpy's `str`, with
//! columns aligned, at most 8 decimals, lines of 75 characters, and only the edges of more than 1000
//! numbers.
//!
//! After numpy's `arrayprint.py` (v2.4.6) with its default `set_printoptions`.

use std::borrow::Cow;
use std::fmt::{self, LowerExp};
use std::str::FromStr;

const PRECISION: usize = 8;
const LINE_WIDTH: usize = 75;
const THRESHOLD: usize = 1000;
const EDGE_ITEMS: usize = 3;

/// The numbers of an array in row-major order.
#[derive(Clone, Copy)]
pub enum Numbers<'a> {
    /// `float32`.
    F32(&'a [f32]),
    /// `float64`.
    F64(&'a [f64]),
    /// Integers of any type: the number at an index.
    Whole(&'a dyn Fn(usize) -> i128),
}

impl fmt::Debug for Numbers<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::F32(_) => "F32",
            Self::F64(_) => "F64",
            Self::Whole(_) => "Whole",
        })
    }
}

impl Numbers<'_> {
    fn get(self, index: usize) -> f64 {
        match self {
            Self::F32(values) => values[index].into(),
            Self::F64(values) => values[index],
            Self::Whole(value) => value(index) as f64,
        }
    }

    fn integer(self, index: usize) -> i128 {
        match self {
            Self::Whole(value) => value(index),
            _ => self.get(index) as i128,
        }
    }
}

/// numpy's `str` of an array.
pub fn array(data: Numbers<'_>, shape: &[usize]) -> String {
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
pub fn shape(shape: &[usize]) -> String {
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
pub fn quoted(text: &str) -> String {
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
pub fn scalar(data: Numbers<'_>, index: usize) -> String {
    // Numbers from `end` on have an exponent. `float32` represents all integers below 10^6; for
    // `float64`, C too writes an exponent from 10^16 on.
    let end = match data {
        Numbers::F32(_) => 1e6,
        Numbers::F64(_) => 1e16,
        _ => return data.integer(index).to_string(),
    };
    let x = data.get(index);
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

/// The common format of the numbers of an array, with which the columns are aligned.
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
    fn of(data: Numbers<'_>, shown: &[usize]) -> Self {
        if let Numbers::Whole(_) = data {
            let width = shown
                .iter()
                .map(|&i| data.integer(i).to_string().len())
                .max();
            return Self::Integer {
                width: width.unwrap_or(0),
            };
        }
        let (finite, other): (Vec<usize>, Vec<usize>) =
            shown.iter().partition(|&&i| data.get(i).is_finite());
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
        // `inf` and `-inf` may be longer than the finite numbers before the point.
        let after_point = if needs_exponent {
            exponent + 2 + right
        } else {
            right
        };
        if let Some(longest) = other.iter().map(|&i| non_finite(data.get(i)).len()).max() {
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

    fn write(&self, data: Numbers<'_>, index: usize) -> String {
        let (left, total) = match *self {
            Self::Integer { width } => return format!("{:>width$}", data.integer(index)),
            Self::Positional { left, right } => (left, left + 1 + right),
            Self::Scientific {
                left,
                digits,
                exponent,
            } => (left, left + 1 + digits + exponent + 2),
        };
        let x = data.get(index);
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

/// Whether numpy prints the numbers with exponents: numbers that are too large or too small, or
/// whose ratio is too large. As numpy does, this computes in the precision of the array.
fn needs_exponent(data: Numbers<'_>, finite: &[usize]) -> bool {
    let sizes = finite.iter();
    match data {
        Numbers::F32(x) => spread(sizes.map(|&i| x[i].abs()), [0.0, 1e6, 0.0001, 1000.0]),
        Numbers::F64(x) => spread(sizes.map(|&i| x[i].abs()), [0.0, 1e8, 0.0001, 1000.0]),
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

/// Formats a number with a decimal point and the fewest digits, at most `places` after the point:
/// `0.1`, `3.`, `-0.41887903`.
fn positional(data: Numbers<'_>, index: usize, places: usize) -> String {
    let text = shortest(data, index);
    let exponent: i32 = split_exponent(&text).1.parse().unwrap_or(0);
    let shortest_places = usize::try_from(fraction_len(&text) as i32 - exponent).unwrap_or(0);
    if shortest_places > places {
        return format!("{:.places$}", data.get(index))
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
fn scientific(data: Numbers<'_>, index: usize, places: usize) -> String {
    let text = shortest(data, index);
    let is_cut = fraction_len(&text) > places;
    let text = if is_cut {
        format!("{:.places$e}", data.get(index))
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
fn shortest(data: Numbers<'_>, index: usize) -> String {
    /// Formats `x` with the shortest digits. If two shortest decimals are equally near to `x`,
    /// numpy takes the decimal with an even last digit: `exact`, rounded to the same number of
    /// digits.
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
        Numbers::F32(values) => even(values[index], values[index].into()),
        _ => even(data.get(index), data.get(index)),
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

/// An array and the format of its numbers.
struct Layout<'a> {
    shape: &'a [usize],
    summarise: bool,
    data: Numbers<'a>,
    style: Style,
}

impl Layout<'_> {
    /// Formats in brackets the part of the array at fixed indices of the first `axis` axes.
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

/// Joins words to lines of at most `width` characters, and indents each line except the first.
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

/// The start of a long text.
pub fn shortened(text: &str) -> Cow<'_, str> {
    const MAX_LENGTH: usize = 200;
    match text.char_indices().nth(MAX_LENGTH) {
        Some((end, _)) => Cow::Owned(format!("{}...", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// A message that may repeat what a user gave: of a long one the start and the end, and numbers of
/// hundreds of digits with an exponent.
///
/// ```
/// use gym_numerics::text::brief;
/// let message = format!("expected a number, not {}, line 1", "x".repeat(100_000));
/// let told = brief(&message);
/// assert!(told.len() < 320 && told.starts_with("expected a number") && told.ends_with("line 1"));
/// assert_eq!(brief("short"), "short");
/// assert_eq!(brief(&format!("{} is not below {}", -2.5e300, 0.75)), "-2.5e300 is not below 0.75");
/// assert_eq!(brief(&format!("{:?}", "1".repeat(30))), format!("{:?}", "1".repeat(30)));
/// ```
pub fn brief(message: &str) -> Cow<'_, str> {
    const MAX_LENGTH: usize = 1000;
    const START: usize = 200;
    const END: usize = 100;
    let message = in_few_digits(message);
    if message.chars().nth(MAX_LENGTH).is_none() {
        return message;
    }
    let at = |i: Option<(usize, char)>| i.map_or(0, |(i, _)| i);
    let start = &message[..at(message.char_indices().nth(START))];
    let end = &message[at(message.char_indices().nth_back(END))..];
    Cow::Owned(format!("{start} ... {end}"))
}

/// A message with its longest numbers as floats are written with an exponent. Digits in quotes or
/// in a word are no number.
fn in_few_digits(message: &str) -> Cow<'_, str> {
    /// More characters than any float has that is usually written without an exponent.
    const MOST: usize = 25;
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let is_long = |part: &str| part.len() > MOST && !part.starts_with('.');
    if !message.split(|c| !is_part(c)).any(is_long) {
        return Cow::Borrowed(message);
    }
    let (mut told, mut rest) = (String::new(), message);
    while let Some(start) = rest.find(is_part) {
        let end = rest[start..].find(|c| !is_part(c));
        let end = end.map_or(rest.len(), |length| start + length);
        told.push_str(&rest[..start]);
        let part = &rest[start..end];
        let before = told.chars().next_back();
        let is_apart = before.is_none_or(|c| !c.is_alphanumeric() && !"_\"'`".contains(c));
        match part.parse::<f64>() {
            Ok(x) if is_apart && is_long(part) && x.is_finite() => told.push_str(&format!("{x:e}")),
            _ => told.push_str(part),
        }
        rest = &rest[end..];
    }
    told.push_str(rest);
    Cow::Owned(told)
}

/// Escapes control characters, marks of text direction and characters that have no glyph. The first
/// two change how a terminal shows the text around them; the last make two texts look alike.
///
/// ```
/// assert_eq!(gym_numerics::text::printable("a\u{1b}[2J\u{202e}b"), "a\\u{1b}[2J\\u{202e}b");
/// assert_eq!(gym_numerics::text::printable("Zürich"), "Zürich");
/// ```
pub fn printable(text: &str) -> Cow<'_, str> {
    // Unicode's property Default_Ignorable_Code_Point, line separators and annotations
    let is_hidden = |c: char| {
        c.is_control()
            || matches!(
                c,
                '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}'
            )
            || matches!(c, '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}')
            || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}')
            || matches!(c, '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}')
            || matches!(c, '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}')
    };
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut printed = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) {
            printed.extend(c.escape_unicode());
        } else {
            printed.push(c);
        }
    }
    Cow::Owned(printed)
}
