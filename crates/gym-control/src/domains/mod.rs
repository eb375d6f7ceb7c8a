//! The domains: a module for each.
//!
//! Source: dm_control 1.0.45, `suite`.

pub mod acrobot;
pub mod ball_in_cup;
pub mod cartpole;
pub mod cheetah;
pub mod dog;
pub mod finger;
pub mod fish;
pub mod hopper;
pub mod humanoid;
pub mod humanoid_cmu;
pub mod lqr;
pub mod manipulator;
pub mod pendulum;
pub mod point_mass;
pub mod quadruped;
pub mod reacher;
pub mod stacker;
pub mod swimmer;
pub mod walker;

mod arm;
mod figure;

use gym_core::{Error, Result};

/// Defines a domain's struct of arguments, `Config`: its own arguments, and those that all tasks
/// share.
macro_rules! config {
    ($seconds:expr; $($arguments:tt)*) => {
        gym_core::arguments! {
            /// Arguments.
            pub struct Config {
                $($arguments)*
                /// The arguments that all tasks share.
                #[flatten]
                pub common: $crate::Common = $crate::Common::lasting($seconds),
            }
        }
    };
}
pub(crate) use config;

/// Indices into a rotation matrix. The first letter is the world's axis, the second the body's.
mod axis {
    pub(super) const XX: usize = 0;
    pub(super) const XZ: usize = 2;
    pub(super) const ZX: usize = 6;
    pub(super) const ZY: usize = 7;
    pub(super) const ZZ: usize = 8;
}

/// Returns an error for an argument outside the range from `low` to `high`.
fn check(name: &'static str, x: f64, low: f64, high: f64) -> Result<()> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    Err(Error::argument(
        name,
        format!("{x} is not from {low} to {high}"),
    ))
}

/// Returns `a - b`.
fn minus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// Returns `np.linalg.norm(v)`, as numpy computes it on a CPU with AVX-512.
fn norm<const N: usize>(v: [f64; N]) -> f64 {
    gym_sim::numpy::norm(5, &v)
}

/// numpy's operations on a CPU for which OpenBLAS has a kernel with AVX2, but none with AVX-512: what
/// the domains were recorded on that came last.
mod avx2 {
    /// Returns `np.linalg.norm(v)`.
    pub(super) fn norm<const N: usize>(v: [f64; N]) -> f64 {
        gym_sim::numpy::norm_avx2(&v)
    }

    /// Returns the vector `v` times the row-major matrix `m`: numpy's `v.dot(m)`.
    pub(super) fn times(v: [f64; 3], m: &[f64; 9]) -> [f64; 3] {
        std::array::from_fn(|j| v[0] * m[j] + v[1] * m[3 + j] + v[2] * m[6 + j])
    }
}

/// Returns the vector `v` times the row-major matrix `m`: numpy's `v.dot(m)`, which uses fused
/// multiply-add.
#[expect(
    clippy::disallowed_methods,
    reason = "a fused product is the same on every platform"
)]
fn times(v: [f64; 3], m: &[f64; 9]) -> [f64; 3] {
    std::array::from_fn(|j| (0..3).fold(0.0_f64, |sum, i| v[i].mul_add(m[3 * i + j], sum)))
}
