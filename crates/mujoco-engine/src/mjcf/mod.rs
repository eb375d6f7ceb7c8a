//! MJCF, MuJoCo's model format: a strict reader and compiler of the part that the engine supports.
//!
//! The reader turns a text into a tree of elements ([`xml`]), and the tree into a [`spec`].
//! [`compile`] turns the `spec` into a compiled model. Anything outside the supported part is an
//! error that names element, attribute and line; nothing is skipped silently.
//!
//! | section | supported |
//! |---|---|
//! | all | `include`; `default` classes and `childclass`; orientations by quat, axisangle, xyaxes, zaxis and euler |
//! | `compiler` | angle, eulerseq, autolimits, inertiafromgeom, inertiagrouprange, balanceinertia, boundmass, boundinertia, settotalmass, strippath, coordinate="local" |
//! | `option` | timestep, gravity, wind, magnetic, density, viscosity, cone, impratio, solver, iterations, ls_iterations, tolerance, noslip_iterations, noslip_tolerance, integrator, `flag` |
//! | bodies | `body` (mocap, gravcomp), `frame`, `replicate`, `inertial`; all joints with springs, dampers, dry friction, limits; sites, cameras, lights |
//! | `geom` | plane, sphere, capsule, ellipsoid, cylinder, box; fluidshape; all contact parameters; meshes without mass and contacts |
//! | `contact` | pair, exclude |
//! | `equality` | connect, weld, joint, tendon |
//! | `tendon` | fixed, spatial (sites, pulleys, spheres and cylinders with side sites) |
//! | `actuator` | general, motor, position, velocity, intvelocity, damper, cylinder, muscle; on joints, tendons and sites |
//! | `sensor` | those of joints, tendons, actuators, sites, frames, subtrees, and the clock; touch, rangefinder, magnetometer |
//! | `keyframe` | key |
//!
//! `asset` gives the colours of materials; `statistic` and `size` are read as in MuJoCo; `visual`,
//! `custom`, `user`, `group`, textures and skins are ignored. A mesh without mass and contacts is a
//! geom without size, and its file is not read. The position of such a geom is its frame, not the
//! centre of the mesh as in MuJoCo. Meshes with mass or contacts, height fields as geoms,
//! composites, flexes and plugins are errors.

mod bodies;
mod defaults;
pub(crate) mod files;
pub(crate) mod orientation;
pub(crate) mod reader;
pub(crate) mod spec;
pub(crate) mod xml;

/// The largest number of bodies, geoms and degrees of freedom (the engine's matrices are dense),
/// and of each kind of object that is looked up by name.
pub(crate) const MOST: usize = 1000;
