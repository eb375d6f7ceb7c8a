//! The transcendental functions of the engine, in one place: the same bits on every platform.

pub(crate) use gym_core::math::{atan2, pow, sin_cos, with as wide};
