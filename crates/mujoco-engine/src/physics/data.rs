//! A state, and everything computed from it.

mod ahead;
mod asleep;
mod check;
mod keyframe;

use gym_numerics::exact::Exact;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::math::spatial::IDENTITY;
use crate::physics::lanes::most_len;
use crate::physics::{
    Call, Constraints, Work, inverse, rne_post_constraint, start_asleep, step1, step2,
};
use crate::{Model, forward, step};

/// A state of a model, and the results of the last forward call: MuJoCo's `mjData`.
///
/// After [`step`], `time`, `qpos` and `qvel` are new; everything else belongs to the last forward
/// call that the step made, as in MuJoCo. With the integrator Euler this is the state before the
/// step, with RK4 its last stage.
///
/// Frames and vectors are in the world's axes. Rotation matrices are row-major. Six-dimensional
/// vectors are rotation, then translation, about the centre of mass of the kinematic tree
/// (`subtree_com` of the body's root).
///
/// A clone, or data that was serialised and read again, continues bit for bit. Two states are
/// serialised: the current one, and the one from which the last step or forward call started.
/// [`resume`](Self::resume) computes everything else from them.
#[derive(Clone, Debug, Default)]
pub struct Data {
    /// Time, in seconds.
    pub time: f64,
    /// Positions (nq).
    pub qpos: Vec<f64>,
    /// Velocities (nv).
    pub qvel: Vec<f64>,
    /// Controls (nu), not clamped: the engine clamps a copy.
    pub ctrl: Vec<f64>,
    /// Activations of the actuators (na).
    pub act: Vec<f64>,
    /// Forces that are applied to the degrees of freedom (nv).
    pub qfrc_applied: Vec<f64>,
    /// Forces and torques that are applied at the centres of mass of the bodies, in the world's
    /// axes.
    pub xfrc_applied: Vec<[f64; 6]>,
    /// Positions of the mocap bodies.
    pub mocap_pos: Vec<[f64; 3]>,
    /// Orientations of the mocap bodies.
    pub mocap_quat: Vec<[f64; 4]>,
    /// The solver's starting point: the accelerations of the previous step (nv).
    pub qacc_warmstart: Vec<f64>,
    /// Accelerations (nv).
    pub qacc: Vec<f64>,
    /// For each tree of bodies, if trees may sleep: the next tree of those that sleep together, or -1
    /// minus the number of steps after which it may fall asleep.
    pub tree_asleep: Vec<i32>,
    /// Positions at which trees sleep, and those of mocap bodies.
    pub(crate) asleep_qpos: Vec<f64>,
    /// Numbers of the user, of any length: the engine stores and clones them, and
    /// [`reset`](Self::reset) removes them.
    pub userdata: Vec<f64>,

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
    /// Inertia of each body about the tree's centre of mass: xx, yy, zz, xy, xz, yz, mass times
    /// offset (3), mass.
    pub cinert: Vec<[f64; 10]>,
    /// Motion axis of each degree of freedom.
    pub cdof: Vec<[f64; 6]>,
    /// Velocity of each body.
    pub cvel: Vec<[f64; 6]>,
    /// Time derivative of `cdof`.
    pub cdof_dot: Vec<[f64; 6]>,
    /// Changes of the activations per second (na).
    pub act_dot: Vec<f64>,
    /// The values of the sensors, in their order.
    pub sensordata: Vec<f64>,
    /// Potential and kinetic energy, for models with the flag `energy` or energy sensors.
    pub energy: [f64; 2],
    /// Velocity of the centre of mass of each body with its descendants, for models whose sensors
    /// read it.
    pub subtree_linvel: Vec<[f64; 3]>,
    /// Angular momentum of each body with its descendants about their centre of mass, for models
    /// whose sensors read it.
    pub subtree_angmom: Vec<[f64; 3]>,
    /// Accelerations of the bodies, with gravity; current after [`rne_post_constraint`].
    pub cacc: Vec<[f64; 6]>,
    /// Forces between bodies and their parents; current after [`rne_post_constraint`].
    pub cfrc_int: Vec<[f64; 6]>,
    /// Lengths of the actuators, for models that need them.
    pub actuator_length: Vec<f64>,
    /// Velocities of the actuators, for models that need them.
    pub actuator_velocity: Vec<f64>,
    /// Jacobians of the tendons: sparse rows over the degrees of freedom that move each tendon.
    pub ten_j: Vec<f64>,
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
    /// Sum of all forces except constraint forces (nv).
    pub qfrc_smooth: Vec<f64>,
    /// Accelerations without constraints (nv).
    pub qacc_smooth: Vec<f64>,
    /// Forces of constraints (nv).
    pub qfrc_constraint: Vec<f64>,
    /// Forces that cause `qacc`; current after [`inverse`].
    pub qfrc_inverse: Vec<f64>,
    /// External force on each body by contacts; current after [`rne_post_constraint`].
    pub cfrc_ext: Vec<[f64; 6]>,

    /// The inertia matrix: rows of the lower triangle. Each row has the columns of the ancestors of
    /// a degree of freedom, root first, and of itself. A row starts at a multiple of four.
    pub qm: Vec<f64>,
    /// Factors of the inertia matrix, `L' D L`, with the same sparsity. Numbers between rows are
    /// unspecified.
    pub qld: Vec<f64>,
    /// Inverse of the factors' diagonal.
    pub qld_diag_inv: Vec<f64>,
    /// Clamped controls: forces of the motors, before gears.
    pub actuator_force: Vec<f64>,

    /// Contacts.
    pub contact: Vec<Contact>,
    /// Rows of the constraints.
    pub efc: Constraints,
    /// Iterations of the solver, by island.
    pub solver_niter: Vec<usize>,

    /// The call that computed the derived arrays, and the state from which the call started; `None`
    /// before the first call.
    pub(crate) last: Option<Call>,
    before: State,
    /// Whether `cfrc_ext` belongs to the last call.
    pub(crate) contact_forces: bool,
    /// Whether the derived arrays are older than the state: the last step ran in lanes, which store
    /// only the arrays that the task reads.
    stale: bool,
    /// Whether `energy` was computed since the last reset.
    pub(crate) knows_energy: bool,
    /// The result of a step that was computed ahead of its call: the state, and the state at the
    /// start of the last timestep.
    ahead: Vec<f64>,
    is_ahead: bool,
    /// Buffers.
    pub(crate) work: Work,
}

/// The inputs of a step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct State {
    time: f64,
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    ctrl: Vec<f64>,
    qacc_warmstart: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    act: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    mocap_pos: Vec<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    mocap_quat: Vec<[f64; 4]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    qfrc_applied: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    xfrc_applied: Vec<[f64; 6]>,
    /// The accelerations from which inverse dynamics started; empty for other calls.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    qacc: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tree_asleep: Vec<i32>,
    /// What is not computed anew while trees sleep: positions, forces, accelerations and sensors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    asleep: Vec<f64>,
}

/// Copies a state, with empty arrays of applied forces unless the last argument is true; or some of
/// its arrays. (A function could not copy to a field of the data that it reads.)
macro_rules! copy_state {
    ($from:expr => $to:expr, $pushed:expr) => {{
        $to.time = $from.time;
        copy_state!(qpos qvel ctrl qacc_warmstart: $from => $to);
        // most models have none of these arrays
        let some = [$from.act.len(), $from.mocap_pos.len(), $to.act.len(), $to.mocap_pos.len()];
        if some != [0; 4] {
            copy_state!(act mocap_pos mocap_quat: $from => $to);
        }
        copy_state!(forces: $from => $to, $pushed);
    }};
    (forces: $from:expr => $to:expr, $pushed:expr) => {
        if $pushed {
            copy_state!(qfrc_applied xfrc_applied: $from => $to);
        } else {
            $to.qfrc_applied.clear();
            $to.xfrc_applied.clear();
        }
    };
    ($($array:ident)+: $from:expr => $to:expr) => {
        $($to.$array.clone_from(&$from.$array);)+
    };
}

/// The serialised form of [`Data`].
#[derive(Serialize, Deserialize)]
#[serde(rename = "Data")]
struct Stored {
    #[serde(deserialize_with = "Option::deserialize")]
    last: Option<Call>,
    contact_forces: bool,
    state: State,
    /// The state from which the last call started, if it differs from the current one.
    #[serde(deserialize_with = "Option::deserialize")]
    before: Option<State>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    userdata: Vec<f64>,
}

impl Serialize for Data {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        self.stored().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Data {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        Self::read(&mut <dyn erased_serde::Deserializer<'_>>::erase(
            deserializer,
        ))
        .map_err(D::Error::custom)
    }
}

/// The serialised form, with the format behind a pointer: otherwise each crate that stores data
/// would compile it again.
impl Data {
    fn stored(&self) -> Box<dyn erased_serde::Serialize> {
        let state = self.state();
        let before = (self.last.is_some() && self.before != state).then(|| self.before.clone());
        Box::new(Exact(Stored {
            last: self.last,
            contact_forces: self.contact_forces,
            state,
            before,
            userdata: self.userdata.clone(),
        }))
    }

    fn read(deserializer: &mut dyn erased_serde::Deserializer<'_>) -> erased_serde::Result<Self> {
        let Exact(Stored {
            last,
            contact_forces,
            state,
            before,
            userdata,
        }) = Exact::deserialize(deserializer)?;
        let before = before.unwrap_or_else(|| state.clone());
        let mut data = Self {
            last,
            contact_forces,
            before,
            userdata,
            ..Self::default()
        };
        data.set(&state);
        Ok(data)
    }
}

/// A contact of two geoms: MuJoCo's `mjContact`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Contact {
    /// Distance between the nearest points; negative where the geoms overlap.
    pub dist: f64,
    /// Midpoint between the nearest points.
    pub pos: [f64; 3],
    /// Rows: the normal, from the first geom to the second, and two tangents.
    pub frame: [f64; 9],
    /// The constraint acts if `dist` is below this value.
    pub includemargin: f64,
    /// Friction: slide twice, spin, roll twice.
    pub friction: [f64; 5],
    /// Reference: time constant, damping ratio.
    pub solref: [f64; 2],
    /// Impedance: dmin, dmax, width, midpoint, power.
    pub solimp: [f64; 5],
    /// Friction of the regularised cone; 0 for a frictionless contact.
    pub mu: f64,
    /// Dimensions: 1 or 3.
    pub dim: u8,
    /// The two geoms.
    pub geom: [usize; 2],
    /// First constraint row; -1 if it has none.
    pub efc_address: i32,
    /// The index of the pair of geoms in the model.
    pub(crate) pair: usize,
}

/// Calls `$do` for each array of `Data`, or for the arrays listed, with length and initial value.
macro_rules! arrays {
    ($d:ident, $m:ident, $do:path) => {
        arrays! { $d, $do:
            $m.nq(), 0.0 => qpos;
            $m.nv(), 0.0 => qvel qacc_warmstart qacc qfrc_applied qfrc_passive qfrc_bias
            qfrc_actuator qfrc_smooth qacc_smooth qfrc_constraint qfrc_inverse qld_diag_inv;
            $m.nu(), 0.0 => ctrl actuator_force actuator_length actuator_velocity;
            $m.na(), 0.0 => act act_dot;
            $m.nmocap(), [0.0; 3] => mocap_pos;
            $m.nmocap(), UNTURNED => mocap_quat;
            $m.nsensordata(), 0.0 => sensordata;
            $m.ntendon(), 0.0 => ten_length ten_velocity;
            $m.plan().paths.columns.len(), 0.0 => ten_j;
            $m.plan().m_colind.len(), 0.0 => qm qld;
            $m.nbody(), [0.0; 3] => xpos xipos subtree_com subtree_linvel subtree_angmom;
            $m.nbody(), UNTURNED => xquat;
            $m.nbody(), IDENTITY => xmat ximat;
            $m.nbody(), [0.0; 10] => cinert;
            $m.nbody(), [0.0; 6] => cvel cacc cfrc_int cfrc_ext xfrc_applied;
            $m.njnt(), [0.0; 3] => xanchor xaxis;
            $m.ngeom(), [0.0; 3] => geom_xpos;
            $m.ngeom(), IDENTITY => geom_xmat;
            $m.nsite(), [0.0; 3] => site_xpos;
            $m.nsite(), IDENTITY => site_xmat;
            $m.nv(), [0.0; 6] => cdof cdof_dot;
            if $m.plan().sleeps { $m.ntree() } else { 0 }, $crate::physics::AWAKE => tree_asleep;
            if $m.plan().sleeps { $m.nq() + 7 * $m.nmocap() } else { 0 }, 0.0 => asleep_qpos;
        }
    };
    ($d:ident, $do:path: $($length:expr, $value:expr => $($array:ident)+;)+) => {
        $($($do(&mut $d.$array, $length, $value);)+)+
    };
}
pub(crate) use arrays;

/// Fills an array with a value.
fn fill<T: Clone>(array: &mut [T], _length: usize, value: T) {
    array.fill(value);
}

pub(super) const UNTURNED: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

impl Data {
    /// The data of a model in its initial configuration. It allocates everything that a step needs.
    ///
    /// Positions are `qpos0`, velocities and controls zero. Nothing is computed yet: call
    /// [`forward`] to see positions of bodies.
    #[must_use]
    pub fn new(m: &Model) -> Self {
        let mut data = Self::default();
        data.reset(m);
        data
    }

    /// The values of a sensor.
    ///
    /// # Panics
    /// If the model has no such sensor.
    #[must_use]
    pub fn sensor(&self, m: &Model, id: usize) -> &[f64] {
        let first = m.sensor_adr[id];
        &self.sensordata[first..first + m.sensor_dim[id]]
    }

    /// Resets to the initial configuration: MuJoCo's `mj_resetData`.
    pub fn reset(&mut self, m: &Model) {
        self.clear(m);
        (self.last, self.contact_forces) = (None, false);
        (self.stale, self.is_ahead) = (false, false);
        self.userdata.clear();
    }

    /// [`reset`](Self::reset) without clearing the record of the last call.
    pub(crate) fn clear(&mut self, m: &Model) {
        self.resize_for(m);
        let d = &mut *self;
        d.time = 0.0;
        arrays!(d, m, fill);
        d.qpos.copy_from_slice(&m.qpos0);
        for b in 0..m.nbody() {
            if let Ok(id) = usize::try_from(m.body_mocapid[b]) {
                (d.mocap_pos[id], d.mocap_quat[id]) = (m.body_pos[b], m.body_quat[b]);
            }
        }
        d.contact.clear();
        d.efc.clear();
        d.work.clear();
        d.solver_niter.clear();
        (d.energy, d.knows_energy) = ([0.0; 2], false);
        if m.plan().sleeps {
            start_asleep(m, d);
        }
    }

    /// Whether derived arrays were computed from the state; [`resume`](Self::resume) computes them
    /// again.
    #[must_use]
    pub fn is_computed(&self) -> bool {
        self.last.is_some()
    }

    /// Whether the last call was [`step`].
    #[must_use]
    pub fn is_stepped(&self) -> bool {
        self.last == Some(Call::Step)
    }

    /// The state from which the last call started, as pairs of an `mjData` field name and its
    /// values. MuJoCo can repeat the call from it. `None` if nothing was computed yet.
    #[must_use]
    pub fn start(&self) -> Option<[(&'static str, &[f64]); 10]> {
        let from = self.last.map(|_| &self.before)?;
        Some([
            ("time", std::slice::from_ref(&from.time)),
            ("qpos", &from.qpos),
            ("qvel", &from.qvel),
            ("ctrl", &from.ctrl),
            ("qacc_warmstart", &from.qacc_warmstart),
            ("act", &from.act),
            ("mocap_pos", from.mocap_pos.as_flattened()),
            ("mocap_quat", from.mocap_quat.as_flattened()),
            ("qfrc_applied", &from.qfrc_applied),
            ("xfrc_applied", from.xfrc_applied.as_flattened()),
        ])
    }

    /// Repeats the last call to compute the arrays that are not serialised, or that a step taken
    /// together with other worlds [left out](Self::has_stale_arrays). Not needed before a step or a
    /// forward call.
    ///
    /// # Panics
    /// If the data is of another model; see [`check`](Self::check).
    pub fn resume(&mut self, m: &Model) {
        self.resize_for(m);
        if self.rewind() {
            step(m, self);
            step1(m, self);
            return;
        }
        let Some(last) = self.last else { return };
        let (now, contact_forces) = (self.state(), self.contact_forces);
        let mut before = std::mem::take(&mut self.before);
        before.qfrc_applied.resize(m.nv(), 0.0);
        before.xfrc_applied.resize(m.nbody(), [0.0; 6]);
        self.set(&before);
        match last {
            Call::Forward => forward(m, self),
            Call::Step => step(m, self),
            Call::Step1 => step1(m, self),
            Call::Step2 => {
                step1(m, self);
                step2(m, self);
            }
            Call::Inverse => {
                self.qacc.copy_from_slice(&before.qacc);
                inverse(m, self);
            }
        }
        if contact_forces {
            rne_post_constraint(m, self);
        }
        self.set(&now);
        self.qfrc_applied.resize(m.nv(), 0.0);
        self.xfrc_applied.resize(m.nbody(), [0.0; 6]);
    }

    fn state(&self) -> State {
        let mut state = State::default();
        copy_state!(self => state, self.is_pushed());
        self.put_asleep(&mut state);
        state
    }

    /// Whether an external force is applied.
    pub(crate) fn is_pushed(&self) -> bool {
        let applied = [&self.qfrc_applied[..], self.xfrc_applied.as_flattened()];
        // the bits of all numbers, without signs: a loop without an early exit vectorises
        let numbers = applied.into_iter().flatten();
        let bits = numbers.fold(0, |bits, x| bits | x.to_bits());
        bits << 1 != 0
    }

    fn set(&mut self, state: &State) {
        copy_state!(state => self, true);
        self.take_asleep(state);
    }

    /// Stores the state from which a call starts.
    #[inline]
    pub(crate) fn begin_call(&mut self, m: &Model, call: Call) {
        self.begin_substep(m);
        self.work.skips = false;
        self.last = Some(call);
        copy_state!(self => self.before, self.work.pushed);
        // data may have served a model with sleep
        if m.plan().sleeps || !self.before.tree_asleep.is_empty() {
            let mut before = std::mem::take(&mut self.before);
            self.put_asleep(&mut before);
            self.before = before;
        }
        self.before.qacc.clear();
        if call == Call::Inverse {
            self.before.qacc.clone_from(&self.qacc);
        }
    }

    /// Prepares a timestep that neither stores its initial state nor computes the geom and site
    /// frames that no stage of the timestep reads.
    #[inline]
    pub(crate) fn begin_substep(&mut self, m: &Model) {
        self.resize_for(m);
        (self.last, self.contact_forces) = (None, false);
        (self.stale, self.is_ahead) = (false, false);
        self.work.pushed = self.is_pushed();
        self.work.skips = true;
    }

    /// Stores the state from which the second half of a step starts, in addition to the state of
    /// the first half.
    pub(crate) fn continue_step(&mut self, m: &Model) {
        if !matches!(self.last, Some(Call::Step1 | Call::Forward)) {
            return self.begin_call(m, Call::Step2);
        }
        (self.last, self.contact_forces) = (Some(Call::Step2), false);
        self.work.pushed = self.is_pushed();
        copy_state!(ctrl act qacc_warmstart: self => self.before);
        copy_state!(forces: self => self.before, self.work.pushed);
    }

    /// Resizes every array to the sizes of the model. Arrays of the right length do not change.
    pub(crate) fn resize_for(&mut self, m: &Model) {
        if self.work.fits(m) {
            return;
        }
        let d = &mut *self;
        arrays!(d, m, Vec::resize);
        self.ahead.reserve(most_len(m));
        self.work = Work::new(m);
        let bounds = m.plan().bounds();
        self.contact.reserve(bounds.contacts);
        self.efc.reserve(&bounds, m.nv(), m.plan().sparse);
        self.solver_niter.reserve(m.ntree());
    }
}
