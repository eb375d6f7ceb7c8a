//! A state, and everything computed from it.

use serde::{Deserialize, Serialize};

use crate::Model;

/// A state of a model, and what the last forward call computed from it: MuJoCo's `mjData`.
///
/// After [`step`](crate::step), `time`, `qpos` and `qvel` are new; everything else belongs to the last forward call that the
/// step made, as in MuJoCo. With the integrator Euler this is the state before the step, with RK4 its last stage.
///
/// Frames and vectors are in the world's axes. Rotation matrices are row-major. Six-dimensional vectors are rotation, then
/// translation, about the centre of mass of the kinematic tree (`subtree_com` of the body's root).
///
/// A clone, or data that was serialised and read again, continues bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Data {
    /// Time, in seconds.
    pub time: f64,
    /// Positions (nq).
    pub qpos: Vec<f64>,
    /// Velocities (nv).
    pub qvel: Vec<f64>,
    /// Controls (nu); the engine clamps what it uses, not these.
    pub ctrl: Vec<f64>,
    /// Where the solver starts: the accelerations of the step before (nv).
    pub qacc_warmstart: Vec<f64>,
    /// Accelerations (nv).
    pub qacc: Vec<f64>,

    /// Positions of the bodies.
    pub xpos: Vec<[f64; 3]>,
    /// Orientations of the bodies.
    pub xquat: Vec<[f64; 4]>,
    /// Orientations of the bodies.
    pub xmat: Vec<[f64; 9]>,
    /// Centres of mass of the bodies.
    pub xipos: Vec<[f64; 3]>,
    /// Principal axes of inertia of the bodies.
    pub ximat: Vec<[f64; 9]>,
    /// Anchors of the joints.
    pub xanchor: Vec<[f64; 3]>,
    /// Axes of the joints.
    pub xaxis: Vec<[f64; 3]>,
    /// Positions of the geoms.
    pub geom_xpos: Vec<[f64; 3]>,
    /// Orientations of the geoms.
    pub geom_xmat: Vec<[f64; 9]>,
    /// Positions of the sites.
    pub site_xpos: Vec<[f64; 3]>,
    /// Orientations of the sites.
    pub site_xmat: Vec<[f64; 9]>,

    /// Centre of mass of each body with its descendants.
    pub subtree_com: Vec<[f64; 3]>,
    /// Inertia of each body about the tree's centre of mass: xx, yy, zz, xy, xz, yz, mass times offset (3), mass.
    pub cinert: Vec<[f64; 10]>,
    /// Motion axis of each degree of freedom.
    pub cdof: Vec<[f64; 6]>,
    /// Velocity of each body.
    pub cvel: Vec<[f64; 6]>,
    /// Time derivative of `cdof`.
    pub cdof_dot: Vec<[f64; 6]>,
    /// Lengths of the tendons.
    pub ten_length: Vec<f64>,
    /// Velocities of the tendons.
    pub ten_velocity: Vec<f64>,

    /// Forces of springs, dampers and fluid (nv).
    pub qfrc_passive: Vec<f64>,
    /// Coriolis, centrifugal and gravitational forces (nv).
    pub qfrc_bias: Vec<f64>,
    /// Forces of the actuators (nv).
    pub qfrc_actuator: Vec<f64>,
    /// Sum of all forces but those of constraints (nv).
    pub qfrc_smooth: Vec<f64>,
    /// Accelerations without constraints (nv).
    pub qacc_smooth: Vec<f64>,
    /// Forces of constraints (nv).
    pub qfrc_constraint: Vec<f64>,
    /// External force on each body by contacts; current after [`rne_post_constraint`](crate::physics::rne_post_constraint).
    pub cfrc_ext: Vec<[f64; 6]>,

    /// Contacts.
    pub contact: Vec<Contact>,
}

/// A contact of two geoms: MuJoCo's `mjContact`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Contact {
    /// Distance between the nearest points; negative where the geoms overlap.
    pub dist: f64,
    /// Midpoint between the nearest points.
    pub pos: [f64; 3],
    /// Rows: the normal, from the first geom to the second, and two tangents.
    pub frame: [f64; 9],
    /// The constraint acts where `dist` is below.
    pub includemargin: f64,
    /// Friction: slide twice, spin, roll twice.
    pub friction: [f64; 5],
    /// Reference: time constant, damping ratio.
    pub solref: [f64; 2],
    /// Impedance: dmin, dmax, width, midpoint, power.
    pub solimp: [f64; 5],
    /// Friction of the regularised cone; 0 without friction.
    pub mu: f64,
    /// Dimensions: 1 or 3.
    pub dim: u8,
    /// The two geoms.
    pub geom: [usize; 2],
    /// First constraint row; -1 if it has none.
    pub efc_address: i32,
}

impl Data {
    /// The data of a model in its initial configuration, with everything allocated that a step needs.
    ///
    /// Positions are `qpos0`, velocities and controls zero. Nothing is computed yet: call [`forward`](crate::forward) to see
    /// positions of bodies.
    #[must_use]
    pub fn new(m: &Model) -> Self {
        let mut data = Self::default();
        data.reset(m);
        data
    }

    /// Back to the initial configuration: MuJoCo's `mj_resetData`.
    pub fn reset(&mut self, m: &Model) {
        self.time = 0.0;
        self.qpos.clone_from(&m.qpos0);
        fill(&mut self.qvel, m.nv());
        fill(&mut self.ctrl, m.nu());
        fill(&mut self.qacc_warmstart, m.nv());
        fill(&mut self.cfrc_ext, m.nbody());
    }
}

/// Makes a vector have so many zeros.
fn fill<T: Copy + Zero>(vector: &mut Vec<T>, length: usize) {
    vector.clear();
    vector.resize(length, T::ZERO);
}

trait Zero {
    const ZERO: Self;
}

impl Zero for f64 {
    const ZERO: Self = 0.0;
}

impl<const N: usize> Zero for [f64; N] {
    const ZERO: Self = [0.0; N];
}
