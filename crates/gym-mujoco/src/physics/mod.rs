//! The engine: one file per stage of a step, in the order in which MuJoCo runs them.

use crate::{Data, Model};

/// Computes everything that follows from time, `qpos`, `qvel` and `ctrl`: MuJoCo's `mj_forward`.
pub fn forward(_m: &Model, _d: &mut Data) {}

/// Advances the state by a timestep: MuJoCo's `mj_step`.
pub fn step(_m: &Model, _d: &mut Data) {}

/// Computes `cfrc_ext` from the contacts of the last forward call: the part of MuJoCo's `mj_rnePostConstraint` that tasks read.
pub fn rne_post_constraint(_m: &Model, _d: &mut Data) {}
