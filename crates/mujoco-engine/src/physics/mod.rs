//! The engine: one file per stage of a step, in the order in which MuJoCo runs them.
//!
//! | file | stage |
//! |---|---|
//! | `kinematics` | frames of bodies, geoms and sites |
//! | `com` | inertias and motion axes about the trees' centres of mass |
//! | `tendon`, `wrap`, `transmission` | lengths and moment arms of tendons and actuators |
//! | `inertia` | the inertia matrix and its factors |
//! | `collision` | contacts |
//! | `rows`, `bias`, `constraint` | rows of constraints by their cause; their arrays, islands |
//! | `velocity` | velocities of bodies, and the forces that follow from them |
//! | `passive`, `fluid`, `adhesion` | springs, dampers, forces of a medium, geoms that stick |
//! | `actuation`, `muscle` | actuators |
//! | `solver` | constraint forces: Newton's method, conjugate gradients, projected Gauss-Seidel |
//! | `sensor` and files named `..._sensor`, `ray`, `energy`, `post_constraint` | sensors, and what they need |
//! | `sleep` | which trees of bodies rest, and what wakes them |
//! | `integrate`, `implicit`, `free`, `fluid_slopes` | Euler, Runge-Kutta, implicit integrators |
//! | `inverse` | forces from accelerations |
//!
//! `data` has the arrays that stages write, `work` their buffers, and `lanes` the stages of several
//! worlds at once.
//!
//! All stages are compiled into one function, for the CPU that runs it. Functions that several
//! stages call are `inline(never)`: copies of them would not fit in the instruction cache, and
//! cache misses cost more than calls.
//!
//! Functions have MuJoCo's names without the prefix `mj_`, and take a model and its data:
//!
//! ```
//! use mujoco_engine::{Data, Model, step};
//!
//! let m = Model::from_xml(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom type="plane" size="5 5 1"/>
//!            <body name="ball" pos="0 0 1"><freejoint/><geom type="sphere" size="0.1"/></body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let mut d = Data::new(&m);
//! while d.time < 2.0 {
//!     step(&m, &mut d);
//! }
//! let ball = m.body_id("ball").expect("the ball");
//! assert!((d.xpos[ball][2] - 0.1).abs() < 1e-3, "it rests on the plane");
//! # Ok::<(), mujoco_engine::Error>(())
//! ```

#![expect(
    clippy::needless_range_loop,
    reason = "indices are those of the formulas"
)]

mod actuation;
mod adhesion;
mod bias;
mod collision;
mod com;
mod constraint;
mod contact_force;
mod contact_sensor;
mod data;
mod distance_sensor;
mod energy;
mod fluid;
mod fluid_slopes;
mod free;
mod implicit;
mod inertia;
mod integrate;
mod inverse;
mod jacobian;
mod kinematics;
#[cfg_attr(
    not(all(feature = "lanes", any(target_arch = "x86", target_arch = "x86_64"))),
    allow(
        dead_code,
        reason = "other processors have no lanes yet, and the feature may be off"
    )
)]
pub mod lanes;
mod muscle;
mod passive;
mod post_constraint;
mod range_sensor;
mod ray;
mod rows;
mod sensor;
mod sleep;
mod solver;
mod surface;
mod tendon;
mod transmission;
mod velocity;
mod work;
mod wrap;

pub use actuation::fwd_actuation;
pub use collision::collision;
pub use com::com_pos;
pub use constraint::{Constraints, reference_constraint};
pub use contact_force::contact_force;
pub(crate) use data::arrays;
pub use data::{Contact, Data};
pub use energy::energy;
pub use inertia::{crb, factor_m, full_m, mul_m, solve_m};
pub use integrate::{euler, integrate_pos, runge_kutta};
use kinematics::find_frames;
pub use kinematics::kinematics;
pub use passive::passive;
pub use post_constraint::rne_post_constraint;
pub use ray::{ray, ray_among, ray_shape};
pub use rows::make_constraint;
use sensor::sensors;
pub(crate) use sleep::{AWAKE, start as start_asleep, trees_of_tendon};
pub use solver::fwd_constraint;
pub use tendon::{tendon, tendon_velocity};
pub(crate) use transmission::moment;
pub use transmission::{transmission, transmission_velocity};
pub use velocity::{com_vel, rne};
pub(crate) use work::Work;

use serde::{Deserialize, Serialize};

use crate::Model;
use crate::math::MAXVAL;
use crate::math::libm::wide;
use crate::model::{Integrator, Options, Stage};

/// The functions that compute everything that follows from a state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Call {
    Forward,
    Step,
    Step1,
    Step2,
    Inverse,
}

/// Advances the state by a timestep: MuJoCo's `mj_step`.
///
/// A state that diverged (a number that is not finite, or beyond 1e10) is reset to the initial
/// configuration first, as in MuJoCo.
///
/// # Panics
/// If the data is of another model.
pub fn step(m: &Model, d: &mut Data) {
    d.begin_call(m, Call::Step);
    advance(m, d, true);
}

/// A timestep that another follows: it computes only what the next one needs. Unlike [`step`], it
/// does not store its start, so a snapshot taken after it holds only the state; and sensors and
/// frames of geoms and sites that no stage reads keep their old values. (Where bodies may fall
/// asleep, sensors are measured, because those of sleeping bodies keep what was measured last.)
///
/// # Panics
/// If the data is of another model.
pub fn substep(m: &Model, d: &mut Data) {
    d.begin_substep(m);
    let measures = m.plan().sleeps;
    d.work.skips = !measures;
    advance(m, d, measures);
}

fn advance(m: &Model, d: &mut Data, measures: bool) {
    reset_diverged(m, d);
    let in_stages = m.opt.integrator == Integrator::RK4;
    let skips = d.work.skips;
    // RK4 computes further stages below, and the frames of the last stage remain
    d.work.skips |= in_stages && !(measures && m.plan().measures);
    evaluate(m, d);
    if diverged(&d.qacc) {
        d.clear(m);
        evaluate(m, d);
    }
    d.work.skips = skips;
    if measures {
        measure(m, d, &ALL);
    } else {
        energy::update(m, d);
    }
    if in_stages {
        runge_kutta(m, d);
    } else {
        euler(m, d);
    }
}

/// The first half of a step, which does not depend on controls: MuJoCo's `mj_step1`. Controls can
/// be computed from its results.
///
/// # Panics
/// If the data is of another model.
pub fn step1(m: &Model, d: &mut Data) {
    d.begin_call(m, Call::Step1);
    reset_diverged(m, d);
    first_stages(m, d);
    measure(m, d, &[Stage::Position, Stage::Velocity]);
}

/// The second half of a step, after [`step1`]: MuJoCo's `mj_step2`. As in MuJoCo, it uses Euler's
/// method in place of RK4.
///
/// If nothing was computed before, inertia and moment arms are zero, as in MuJoCo, and so are all
/// accelerations.
///
/// # Panics
/// If the data is of another model.
pub fn step2(m: &Model, d: &mut Data) {
    finish_step(m, d, true);
}

/// [`step2`] of a timestep that another follows: sensors keep their old values, as in [`substep`].
///
/// # Panics
/// If the data is of another model.
pub fn substep2(m: &Model, d: &mut Data) {
    finish_step(m, d, m.plan().sleeps);
}

fn finish_step(m: &Model, d: &mut Data, measures: bool) {
    d.continue_step(m);
    last_stages(m, d);
    if measures {
        measure(m, d, &[Stage::Acceleration]);
    }
    if diverged(&d.qacc) {
        d.clear(m);
        evaluate(m, d);
        measure(m, d, &ALL);
    }
    euler(m, d);
}

/// Computes everything that follows from time, `qpos`, `qvel` and `ctrl`: MuJoCo's `mj_forward`.
///
/// # Panics
/// If the data is of another model.
pub fn forward(m: &Model, d: &mut Data) {
    d.begin_call(m, Call::Forward);
    evaluate(m, d);
    measure(m, d, &ALL);
}

/// [`forward`] as with the flag `actuation` disabled.
///
/// # Panics
/// If the data is of another model.
pub fn forward_without_actuators(m: &Model, d: &mut Data) {
    d.work.unactuated = true;
    forward(m, d);
    d.work.unactuated = false;
}

/// Computes `qfrc_inverse`, the forces that cause the accelerations `qacc`: MuJoCo's `mj_inverse`.
///
/// With the flag `invdiscrete`, `qacc` is the change of the velocity by a timestep, divided by the
/// timestep; except for the integrator RK4, for which the flag has no effect.
///
/// # Panics
/// If the data is of another model.
pub fn inverse(m: &Model, d: &mut Data) {
    d.begin_call(m, Call::Inverse);
    first_stages(m, d);
    if m.opt.enables(Options::INVDISCRETE) {
        let given = d.qacc.clone();
        inverse::make_continuous(m, d);
        finish_inverse(m, d);
        d.qacc = given;
    } else {
        finish_inverse(m, d);
    }
}

fn finish_inverse(m: &Model, d: &mut Data) {
    inverse::forces(m, d);
    measure(m, d, &ALL);
}

fn reset_diverged(m: &Model, d: &mut Data) {
    if diverged(&d.qpos) || diverged(&d.qvel) {
        d.clear(m);
    }
}

const ALL: [Stage; 3] = [Stage::Position, Stage::Velocity, Stage::Acceleration];

/// Computes the results that no later stage reads: sensors and energy.
#[inline]
fn measure(m: &Model, d: &mut Data, stages: &[Stage]) {
    if m.plan().measures {
        sensors(m, d, stages);
        if stages.contains(&Stage::Position) {
            energy::update(m, d);
        }
    }
}

/// Compiles stages for the CPU that runs them. The stages must be closures: the compiler does not
/// inline a function here, and would compile it for the oldest CPU.
macro_rules! compiled {
    ($(#[$doc:meta])* $name:ident: $($stage:ident)+) => {
        $(#[$doc])*
        fn $name(m: &Model, d: &mut Data) {
            wide(
                (m, d),
                #[inline(always)]
                |(m, d)| {
                    $($stage(m, d);)+
                },
                #[inline(always)]
                |(m, d)| {
                    $($stage(m, d);)+
                },
            );
        }
    };
}

compiled! {
    /// All stages of a forward call.
    evaluate: fwd_position fwd_velocity fwd_actuation fwd_acceleration fwd_constraint
}
compiled! {
    /// The stages that do not depend on controls.
    first_stages: fwd_position fwd_velocity
}
compiled! {
    /// The stages that depend on controls.
    last_stages: fwd_actuation fwd_acceleration fwd_constraint
}

/// The stages that depend on positions: MuJoCo's `mj_fwdPosition`.
#[inline(always)]
fn fwd_position(m: &Model, d: &mut Data) {
    let sleeps = m.plan().sleeps;
    if sleeps {
        sleep::wake_disturbed(m, d);
    }
    find_frames(m, d);
    com_pos(m, d);
    tendon(m, d);
    if sleeps {
        sleep::leave_out_tendons(m, d);
        sleep::wake_by_tendons(m, d);
    }
    crb(m, d);
    factor_m(m, d);
    collision(m, d);
    if sleeps {
        sleep::wake_by_constraints(m, d);
    }
    make_constraint(m, d);
    if m.plan().transmits {
        transmission(m, d);
    }
}

/// The stages that depend on velocities: MuJoCo's `mj_fwdVelocity`.
#[inline(always)]
fn fwd_velocity(m: &Model, d: &mut Data) {
    com_vel(m, d);
    tendon_velocity(m, d);
    if m.plan().transmits {
        transmission_velocity(m, d);
    }
    passive(m, d);
    reference_constraint(m, d);
    rne(m, d);
    if m.plan().tendon_armature {
        let mut forces = std::mem::take(&mut d.qfrc_bias);
        tendon::add_bias(m, d, &mut forces);
        d.qfrc_bias = forces;
    }
}

/// Computes the accelerations without constraints: MuJoCo's `mj_fwdAcceleration`.
#[inline(always)]
fn fwd_acceleration(m: &Model, d: &mut Data) {
    let sleeps = m.plan().sleeps;
    if sleeps {
        sleep::keep_forces(d);
    }
    let inner = d.qfrc_passive.iter().zip(&d.qfrc_bias);
    let outer = d.qfrc_applied.iter().zip(&d.qfrc_actuator);
    let forces = inner.zip(outer);
    for (sum, ((passive, bias), (applied, actuator))) in d.qfrc_smooth.iter_mut().zip(forces) {
        *sum = (passive - bias) + applied + actuator;
    }
    if d.work.pushed {
        push_bodies(m, d);
    }
    d.qacc_smooth.copy_from_slice(&d.qfrc_smooth);
    let (inverses, way) = (&d.qld_diag_inv, &mut d.work.way);
    inertia::solve(m, &d.qld, inverses, way, &mut d.qacc_smooth);
    if sleeps {
        sleep::restore_forces(m, d);
    }
}

/// Adds `xfrc_applied`, the external forces on bodies.
#[cold]
fn push_bodies(m: &Model, d: &mut Data) {
    for b in 1..m.nbody() {
        let [x, y, z, roll, pitch, yaw] = d.xfrc_applied[b];
        if d.xfrc_applied[b] != [0.0; 6] {
            let mut sum = std::mem::take(&mut d.qfrc_smooth);
            let (force, torque) = ([x, y, z], [roll, pitch, yaw]);
            jacobian::apply(m, d, force, torque, (b, d.xipos[b]), &mut sum);
            d.qfrc_smooth = sum;
        }
    }
}

/// Whether one of the numbers is not finite or exceeds [`MAXVAL`].
fn diverged(numbers: &[f64]) -> bool {
    // a loop without an early exit vectorises
    (numbers.iter()).fold(false, |bad, x| bad | x.is_nan() | (x.abs() > MAXVAL))
}
