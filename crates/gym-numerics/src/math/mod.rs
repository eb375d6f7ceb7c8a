//! The C library's functions with the bits of glibc on x86-64 with FMA, on every platform. Python
//! and numpy use these functions there.
//!
//! ```
//! use gym_numerics::math;
//!
//! assert_eq!(math::sin(0.5), 0.479425538604203);
//! assert_eq!(math::pow(1.1, 2.0), 1.2100000000000002);
//! ```
//!
//! Sine, cosine and squares also work on several numbers at once, see [`Real`].
//!
//! Scalars are `f64`, in Gymnasium's order of operations, which gives its numbers bit for bit;
//! where numpy 2 computes in `float32`, so do the environments. A lint (`clippy.toml`) forbids the
//! platform's own functions. A CPU without FMA emulates it, with equal results; [`level`] tells how to
//! see that on any CPU.
//!
//! # Why so many functions are `#[inline(always)]`
//!
//! [`with`] and [`widest`] call a function that is compiled for the CPU's level, and a CPU's
//! instructions are a property of a *function*. Code that is inlined into that function may use
//! them; a function that is called from there was compiled for the oldest CPU, and is slow: without
//! FMA, and with every SIMD operation a call. The compiler's own heuristics decide otherwise from
//! version to version, so every function that is called inside `with`, `widest` or
//! `Simd::vectorize` is `#[inline(always)]`, closures included, down to the single operation.
//! Results do not depend on it; a test that counts the instructions of a step finds a function that
//! was forgotten. A function that ten places call, and that would be copied to each of them, is the
//! exception: it is `#[inline(never)]`, and calls `vectorize` itself if it needs those instructions.
//!
//! Rust takes an attribute on a closure where the closure is an element of a list, such as an
//! argument, but not after `let f =`. A closure that is called twice is therefore the element of a
//! tuple of one:
//!
//! ```
//! let (square,) = (
//!     #[inline(always)]
//!     |x: f64| x * x,
//! );
//! assert_eq!(square(2.0) + square(3.0), 13.0);
//! ```

mod arc;
mod exp;
mod fma;
mod hyperbolic;
mod lanes;
mod level;
mod log;
mod numpy;
mod pow;
mod real;
mod sum;
mod svml;
mod tables;
#[cfg(test)]
mod tests;
mod trig;
mod trig_f32;

use fearless_simd::Level;
#[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))]
use fearless_simd::Simd;

pub use fma::{Emulated, Fma, Hardware};
pub use lanes::Lanes;
pub use level::{level, requested_level};
pub use numpy::sin_cos as numpy_sin_cos_f32;
pub use real::{One, Real};
pub use sum::pairwise_sum;
pub use trig_f32::sin_cos as sin_cos_f32;

/// A computation that is generic over the number type.
pub trait Kernel {
    /// The result.
    type Output;

    /// Computes the result. Mark this function and all functions that it calls `#[inline(always)]`.
    fn run<R: Real>(self, token: R::Token) -> Self::Output;
}

/// Runs `kernel` with the widest registers of a CPU of this level; with single numbers if the CPU
/// has no FMA.
#[inline]
pub fn widest<K: Kernel>(level: Level, kernel: K) -> K::Output {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(simd) = level.as_avx512() {
        return in_lanes(simd, kernel);
    } else if let Some(simd) = level.as_avx2() {
        return in_lanes(simd, kernel);
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(simd) = level.as_neon() {
        return in_lanes(simd, kernel);
    }
    // other CPUs compute one number at a time
    let _ = level;
    kernel.run::<One<Emulated>>(())
}

/// Runs `kernel` with the registers of `simd`.
#[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))]
#[inline(always)]
fn in_lanes<S: Simd, K: Kernel>(simd: S, kernel: K) -> K::Output {
    simd.vectorize(
        #[inline(always)]
        || kernel.run::<Lanes<S>>(simd),
    )
}

/// Calls `hardware`, compiled with FMA, if the [`level`] has it, otherwise `emulated`. Both must be
/// `#[inline(always)]` closures that differ only in [`Hardware`] and [`Emulated`].
///
/// Use it around a whole step, not inside: arguments and results pass through memory.
#[inline(always)]
pub fn with<A, T>(arguments: A, hardware: impl FnOnce(A) -> T, emulated: impl FnOnce(A) -> T) -> T {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return match level().as_avx2() {
        Some(avx2) => avx2.vectorize(
            #[inline(always)]
            || hardware(arguments),
        ),
        None => apart(
            #[inline(always)]
            || emulated(arguments),
        ),
    };
    #[cfg(target_arch = "aarch64")]
    return hardware(arguments);
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
    {
        drop(hardware);
        emulated(arguments)
    }
}

/// Calls `f` and does not inline `f`, whose code is long and unused on most CPUs.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[cold]
#[inline(never)]
fn apart<T>(f: impl FnOnce() -> T) -> T {
    f()
}

macro_rules! functions {
    ($($(#[$doc:meta])* fn $name:ident($($x:ident: $type:ty),+) -> $result:ty = |$F:ident| $body:expr;)+) => {
        $(
            $(#[$doc])*
            #[inline]
            #[must_use]
            pub fn $name($($x: $type),+) -> $result {
                with(
                    ($($x,)+),
                    #[inline(always)]
                    |($($x,)+)| { type $F = Hardware; $body },
                    #[inline(always)]
                    |($($x,)+)| { type $F = Emulated; $body },
                )
            }
        )+
    };
}

functions! {
    /// The sine of an angle in rad.
    fn sin(x: f64) -> f64 = |F| trig::sin(One::<F>::new(x)).value();

    /// The cosine of an angle in rad.
    fn cos(x: f64) -> f64 = |F| trig::cos(One::<F>::new(x)).value();

    /// The sine and the cosine of an angle in rad.
    fn sin_cos(x: f64) -> (f64, f64) = |F| {
        let (sin, cos) = trig::sin_cos(One::<F>::new(x));
        (sin.value(), cos.value())
    };

    /// The angle of the point from the positive x axis, in rad between -π and π. The result is
    /// computed with extra precision and rounded once; glibc's result is an adjacent number for 1
    /// argument in 1100.
    fn atan2(y: f64, x: f64) -> f64 = |F| arc::atan2::<F>(y, x);

    /// The arc cosine, in rad; NaN outside of ±1. Computed with extra precision and rounded once.
    fn acos(x: f64) -> f64 = |F| arc::acos::<F>(x);

    /// The arc sine, in rad; NaN outside of ±1. Computed with extra precision and rounded once.
    fn asin(x: f64) -> f64 = |F| arc::asin::<F>(x);

    /// e^x.
    fn exp(x: f64) -> f64 = |F| exp::exp::<F>(x);

    /// e^x - 1.
    fn exp_m1(x: f64) -> f64 = |F| hyperbolic::exp_m1::<F>(x);

    /// The natural logarithm.
    fn ln(x: f64) -> f64 = |F| log::ln::<F>(x);

    /// The natural logarithm of 1 + x.
    fn ln_1p(x: f64) -> f64 = |F| log::ln_1p::<F>(x);

    /// The hyperbolic tangent.
    fn tanh(x: f64) -> f64 = |F| hyperbolic::tanh::<F>(x);

    /// x^y.
    fn pow(x: f64, y: f64) -> f64 = |F| pow::pow::<F>(x, y);

    /// `np.exp` of a float64 on a CPU with AVX-512, where numpy does not use the C library.
    fn numpy_exp(x: f64) -> f64 = |F| svml::exp::<F>(x);

    /// `np.arctan2` of float64s on a CPU with AVX-512.
    fn numpy_atan2(y: f64, x: f64) -> f64 = |F| svml::atan2::<F>(y, x);

    /// `np.arccos` of a float64 on a CPU with AVX-512; NaN outside of ±1. For one argument in a
    /// thousand, the result depends on the CPU.
    fn numpy_acos(x: f64) -> f64 = |F| svml::acos::<F>(x);

    /// `np.log1p` of a float64 on a CPU with AVX-512.
    fn numpy_ln_1p(x: f64) -> f64 = |F| svml::ln_1p::<F>(x);

    /// `pow(x, 2.0)`, which differs from `x * x` for about one argument in a thousand.
    fn square(x: f64) -> f64 = |F| pow::square(One::<F>::new(x)).value();
}

functions! {
    /// `powf(x, 2.0)`, which differs from `x * x` for about one argument in 1400.
    fn square_f32(x: f32) -> f32 = |F| pow::powf_2::<F>(x);

    /// The natural logarithm of 1 + x, correctly rounded, as in glibc 2.41. (glibc 2.36 differs.)
    fn ln_1p_f32(x: f32) -> f32 = |F| log::ln_1p::<F>(f64::from(x)) as f32;
}
