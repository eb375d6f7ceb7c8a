//! Numbers and colours in text formats.

use std::fmt;

use gym_core::canvas::{Color, Point};

/// A number rounded to `N` decimals, without trailing zeros and without a sign on zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decimal<const N: usize>(pub(crate) f64);

impl<const N: usize> fmt::Display for Decimal<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.N$}", self.0);
        let text = if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.')
        } else {
            &text
        };
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

/// `x,y` with 3 decimals.
pub(crate) struct Pair(pub(crate) Point);

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", Decimal::<3>(self.0[0]), Decimal::<3>(self.0[1]))
    }
}

/// `#rrggbb`.
pub(crate) struct Rgb(pub(crate) Color);

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0.r, self.0.g, self.0.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_short() {
        let text = |number| Decimal::<3>(number).to_string();
        assert_eq!(text(100.0), "100");
        assert_eq!(text(0.1235), "0.123");
        assert_eq!(text(-0.0001), "0");
        assert_eq!(text(-2.5), "-2.5");
        assert_eq!(text(f64::NAN), "NaN");
        assert_eq!(Decimal::<0>(120.4).to_string(), "120");
    }

    #[test]
    fn colours_are_hexadecimal() {
        assert_eq!(Rgb(Color::rgb(1, 171, 255)).to_string(), "#01abff");
    }
}
