//! MuJoCo's physics in safe Rust: robots, their joints, motors, sensors and contacts, described in
//! MJCF and simulated with the bits of the release of libmujoco that you name. It needs no C, and
//! runs in a browser too.
//!
//! A [`Model`] is what is constant: bodies, joints, shapes. A [`Data`] is a state of it, and all
//! that follows from the state. [`step`] advances the data by a timestep of the model.
//!
//! ```
//! use mujoco_engine::{Data, Model, step};
//!
//! let robot = r#"
//!   <mujoco>
//!     <worldbody>
//!       <body name="arm">
//!         <joint name="shoulder" axis="0 1 0"/>
//!         <geom type="capsule" fromto="0 0 0  0.5 0 0" size="0.05"/>
//!       </body>
//!     </worldbody>
//!     <actuator><motor joint="shoulder" gear="20"/></actuator>
//!   </mujoco>"#;
//! let model = Model::from_xml(robot)?;
//! let mut data = Data::new(&model);
//! data.ctrl[0] = -1.0;
//! while data.time < 0.1 {
//!     step(&model, &mut data);
//! }
//! assert!(data.qpos[0] < 0.0);
//! # Ok::<(), mujoco_engine::Error>(())
//! ```
//!
//! Fields and functions have MuJoCo's names, so that its documentation serves: `qpos` are
//! positions, [`forward`] is `mj_forward`, [`CompiledModel`] has the fields of `mjModel`.
//!
//! - **The same numbers.** The engine repeats the Linux x86-64 wheels of libmujoco 3.11 to 3.13,
//!   3.17, 4.0.0 and 4.0.1 to the last bit, on every platform; [`Revision`] selects the release. What
//!   it does not support is an error that names the place, never another result.
//! - **A part of MJCF.** All joints, tendons, equality constraints and sensors of the list in
//!   [`Model::from_xml`]; planes, spheres, capsules, cylinders, boxes, ellipsoids, meshes and
//!   height fields. Flexes and plugins are refused.
//! - **Meshes.** [`mesh::Mesh`] compiles a mesh of an STL, OBJ or MSH file, with its
//!   convex [`hull`], to the arrays of libmujoco.
//! - **Determinism.** No clock, no threads, no global state, no allocation in a step, no `unsafe`.
//! - **Many worlds at once.** [`lanes::Worlds`] steps many worlds of one model, with their states in
//!   columns.

#![warn(clippy::disallowed_methods)]

mod error;
pub mod math;
pub mod model;
pub mod physics;

mod mjcf;

mod compile;

pub use compile::{hull, mesh};
pub use error::{Error, Result};
pub use model::{CompiledModel, Model, Revision};
pub use physics::{Contact, Data, forward, lanes, step, step1, step2};

/// The programs of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
