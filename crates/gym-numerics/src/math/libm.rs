//! The platform's C library, which numpy calls too.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;

use super::Math;

/// The C library's functions: numpy's results, bit for bit where numpy's library is the same (on
/// Linux, glibc).
#[derive(Clone, Copy, Debug)]
pub struct Libm;

impl Math for Libm {
    #[inline]
    fn sin_cos(x: f64) -> (f64, f64) {
        x.sin_cos()
    }

    #[inline]
    fn sin(x: f64) -> f64 {
        x.sin()
    }

    #[inline]
    fn cos(x: f64) -> f64 {
        x.cos()
    }

    /// The C library's `pow`, which is not `x * x` for about one argument in a thousand. The exponent
    /// is hidden from the compiler, which would multiply.
    #[inline]
    fn square(x: f64) -> f64 {
        x.powf(black_box(2.0))
    }

    #[inline]
    fn square_f32(x: f32) -> f32 {
        x.powf(black_box(2.0))
    }

    #[inline]
    fn modulo(a: f64, b: f64) -> f64 {
        let rest = a % b;
        if rest < 0.0 { rest + b } else { rest.abs() }
    }

    /// Turn by turn, as Gymnasium does it, for the same rounding, unless `x` is so large that this
    /// would take forever.
    #[inline]
    fn wrap(mut x: f64) -> f64 {
        if x.abs() > 1e4 {
            return Self::modulo(x + PI, TAU) - PI;
        }
        while x > PI {
            x -= TAU;
        }
        while x < -PI {
            x += TAU;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modulo_has_the_sign_of_the_divisor() {
        assert_eq!(Libm::modulo(-1.0, 4.0), 3.0);
        assert_eq!(Libm::modulo(5.0, 4.0), 1.0);
        assert!(Libm::modulo(-4.0, 4.0).is_sign_positive());
    }
}
