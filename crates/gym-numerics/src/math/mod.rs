//! The functions that equations of motion take from a mathematics library, as a parameter.
//!
//! An environment writes its equations once, in plain `f64`, generic over [`Math`]:
//!
//! - with [`Libm`] they are exact: bit for bit what numpy computes, one environment at a time;
//! - with [`Polynomial`] they are a straight line of multiplications, additions and selections,
//!   which the compiler turns into vector instructions when it finds them in a loop over many
//!   environments, as native vectors do.
//!
//! ```
//! use gym_numerics::math::{Libm, Math, Polynomial};
//!
//! /// The acceleration of a pendulum of 1 m at an angle from hanging down.
//! fn acceleration<M: Math>(theta: f64) -> f64 {
//!     -9.8 * M::sin(theta)
//! }
//!
//! let [exact, fast] = [acceleration::<Libm>(0.3), acceleration::<Polynomial>(0.3)];
//! assert!((exact - fast).abs() < 1e-15);
//! ```

mod libm;
mod polynomial;

pub use libm::Libm;
pub use polynomial::Polynomial;

/// Sine, cosine and the like. Implemented by [`Libm`] and [`Polynomial`].
pub trait Math {
    /// The sine and the cosine of an angle in rad.
    fn sin_cos(x: f64) -> (f64, f64);

    /// The sine of an angle in rad.
    #[inline(always)]
    fn sin(x: f64) -> f64 {
        Self::sin_cos(x).0
    }

    /// The cosine of an angle in rad.
    #[inline(always)]
    fn cos(x: f64) -> f64 {
        Self::sin_cos(x).1
    }

    /// Python's `x ** 2`.
    fn square(x: f64) -> f64;

    /// `x ** 2` of a numpy `float32`.
    fn square_f32(x: f32) -> f32;

    /// Python's `a % b` for `b > 0`: in `[0, b)`, or `b` itself where a tiny negative `a` rounds up
    /// to it.
    fn modulo(a: f64, b: f64) -> f64;

    /// An angle brought between ±π by whole turns.
    fn wrap(x: f64) -> f64;
}
