//! The C library's functions, with the bits of glibc on x86-64 with fused multiply-add, as in
//! Python and numpy there, on every platform.
//!
//! ```
//! use gym_numerics::math;
//!
//! assert_eq!(math::sin(0.5), 0.479425538604203);
//! assert_eq!(math::pow(1.1, 2.0), 1.2100000000000002);
//! ```
//!
//! Sine, cosine and squares are also there for several numbers at once, see [`Real`].

mod arc;
mod exp;
mod fma;
mod hyperbolic;
mod lanes;
mod log;
mod numpy;
mod pow;
mod real;
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
pub use numpy::sin_cos as numpy_sin_cos_f32;
pub use real::{One, Real};
pub use trig_f32::sin_cos as sin_cos_f32;

/// A computation with numbers of any kind.
pub trait Kernel {
    /// The result.
    type Output;

    /// Does it. Mark it `#[inline(always)]`, with all that it calls.
    fn run<R: Real>(self, token: R::Token) -> Self::Output;
}

/// Runs a kernel with as many numbers at once as a CPU of this level computes with; one by one if
/// it has no fused multiply-add.
#[inline]
pub fn widest<K: Kernel>(level: Level, kernel: K) -> K::Output {
    if cfg!(feature = "emulate-fma") {
        return kernel.run::<One<Emulated>>(());
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))]
    macro_rules! run {
        ($simd:expr) => {{
            let simd = $simd;
            return simd.vectorize(
                #[inline(always)]
                || kernel.run::<Lanes<_>>(simd),
            );
        }};
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(simd) = level.as_avx512() {
        run!(simd)
    } else if let Some(simd) = level.as_avx2() {
        run!(simd)
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(simd) = level.as_neon() {
        run!(simd)
    }
    // other CPUs compute one number at a time
    let _ = level;
    kernel.run::<One<Emulated>>(())
}

/// Calls the first function, compiled for a CPU with fused multiply-adds, if this is one, else the
/// second. Both must be `#[inline(always)]` closures that differ only in [`Hardware`] and
/// [`Emulated`].
///
/// Put it around a whole step, not inside: arguments and results pass through memory.
#[inline(always)]
pub fn with<A, T>(arguments: A, hardware: impl FnOnce(A) -> T, emulated: impl FnOnce(A) -> T) -> T {
    if cfg!(feature = "emulate-fma") {
        return emulated(arguments);
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return match Level::new().as_avx2() {
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

/// Calls a function without inlining it: it is long, and most CPUs never need it.
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

    /// The angle of a point from the positive x axis, in rad within ±π: computed with more digits
    /// than the result has, and rounded once. glibc's is the number next to it for 1 argument in
    /// 1100.
    fn atan2(y: f64, x: f64) -> f64 = |F| arc::atan2::<F>(y, x);

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

    /// `pow(x, 2.0)`, which is not `x * x` for about one argument in a thousand.
    fn square(x: f64) -> f64 = |F| pow::square(One::<F>::new(x)).value();
}

functions! {
    /// `powf(x, 2.0)`, which is not `x * x` for about one argument in 1400.
    fn square_f32(x: f32) -> f32 = |F| pow::powf_2::<F>(x);

    /// The natural logarithm of 1 + x, correctly rounded, as glibc 2.41 has it. (That of 2.36 is
    /// another one.)
    fn ln_1p_f32(x: f32) -> f32 = |F| log::ln_1p::<F>(f64::from(x)) as f32;
}
