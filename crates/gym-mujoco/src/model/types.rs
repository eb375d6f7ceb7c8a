//! Options, statistics and names of a compiled model.

use serde::{Deserialize, Serialize};

use super::kinds::{Cone, Integrator, Solver};

/// How a model is simulated: MuJoCo's `mjOption`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Options {
    /// Length of a step, in seconds.
    pub timestep: f64,
    /// Acceleration of gravity.
    pub gravity: [f64; 3],
    /// Velocity of the medium.
    pub wind: [f64; 3],
    /// Density of the medium.
    pub density: f64,
    /// Viscosity of the medium.
    pub viscosity: f64,
    /// How velocities and positions follow from accelerations.
    pub integrator: Integrator,
    /// How constraint forces are found.
    pub solver: Solver,
    /// Most iterations of the solver.
    pub iterations: usize,
    /// Most evaluations of a line search of Newton's solver.
    pub ls_iterations: usize,
    /// Improvement below which the solver stops.
    pub tolerance: f64,
    /// Tolerance of the line search, relative to `tolerance`.
    pub ls_tolerance: f64,
    /// The form of the cones of friction.
    pub cone: Cone,
    /// How much stiffer elliptic cones are against sliding than along the normal.
    pub impratio: f64,
    /// Iterations that remove slip afterwards.
    pub noslip_iterations: usize,
    /// Improvement below which these stop.
    pub noslip_tolerance: f64,
    /// The magnetic field.
    pub magnetic: [f64; 3],
    /// What is switched off: bits of MuJoCo's `mjtDisableBit`, see [`Disable`].
    pub disableflags: u32,
    /// What is switched on: bits of MuJoCo's `mjtEnableBit`.
    pub enableflags: u32,
    /// Groups of actuators that are switched off, as bits.
    pub disableactuator: u32,
    /// How MuJoCo stores Jacobians (0 dense, 1 sparse, 2 as it sees fit); without effect here.
    pub jacobian: u8,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            timestep: 0.002,
            gravity: [0.0, 0.0, -9.81],
            wind: [0.0; 3],
            density: 0.0,
            viscosity: 0.0,
            integrator: Integrator::Euler,
            solver: Solver::Newton,
            iterations: 100,
            ls_iterations: 50,
            tolerance: 1e-8,
            ls_tolerance: 0.01,
            cone: Cone::Pyramidal,
            impratio: 1.0,
            noslip_iterations: 0,
            noslip_tolerance: 1e-6,
            magnetic: [0.0, -0.5, 0.0],
            disableflags: 0,
            enableflags: 0,
            disableactuator: 0,
            jacobian: 2,
        }
    }
}

/// Parts of a simulation that can be switched off, as bits of [`Options::disableflags`]: MuJoCo's
/// `mjtDisableBit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Disable {
    /// All constraints.
    Constraint = 1,
    /// Equality constraints.
    Equality = 1 << 1,
    /// Friction loss of joints and tendons.
    FrictionLoss = 1 << 2,
    /// Limits of joints and tendons.
    Limit = 1 << 3,
    /// Contacts.
    Contact = 1 << 4,
    /// Springs.
    Spring = 1 << 5,
    /// Dampers.
    Damper = 1 << 6,
    /// Gravity.
    Gravity = 1 << 7,
    /// Ranges of controls.
    ClampCtrl = 1 << 8,
    /// Warm starts of the solver.
    WarmStart = 1 << 9,
    /// The rule that a body does not collide with its parent.
    FilterParent = 1 << 10,
    /// Actuators.
    Actuation = 1 << 11,
    /// The least time constant of a constraint, twice the timestep.
    RefSafe = 1 << 12,
    /// Sensors.
    Sensor = 1 << 13,
    /// A search that changes no result.
    MidPhase = 1 << 14,
    /// The implicit treatment of damping by Euler's integrator.
    EulerDamp = 1 << 15,
    /// Resets of states that diverge.
    AutoReset = 1 << 16,
    /// MuJoCo's own routine for convex shapes.
    NativeCcd = 1 << 17,
    /// Islands.
    Island = 1 << 18,
    /// Further contacts of convex shapes.
    MultiCcd = 1 << 19,
}

impl Options {
    /// Whether a part is switched off.
    #[must_use]
    pub fn disables(&self, part: Disable) -> bool {
        self.disableflags & part as u32 != 0
    }
}

/// Statistics of a model: MuJoCo's `mjStatistic`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Statistics {
    /// Mean of the diagonal of the inertia matrix in the initial configuration.
    pub meaninertia: f64,
    /// Mean mass of the bodies.
    pub meanmass: f64,
    /// Mean size of the bodies.
    pub meansize: f64,
    /// Extent of the model.
    pub extent: f64,
    /// Centre of the model.
    pub center: [f64; 3],
}

/// The names of a model's objects, by id; `None` for an object without a name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Names {
    /// Bodies.
    pub body: Vec<Option<String>>,
    /// Joints.
    pub joint: Vec<Option<String>>,
    /// Geoms.
    pub geom: Vec<Option<String>>,
    /// Sites.
    pub site: Vec<Option<String>>,
    /// Cameras.
    pub camera: Vec<Option<String>>,
    /// Actuators.
    pub actuator: Vec<Option<String>>,
    /// Tendons.
    pub tendon: Vec<Option<String>>,
    /// Sensors.
    pub sensor: Vec<Option<String>>,
    /// Equality constraints.
    pub equality: Vec<Option<String>>,
    /// Keyframes.
    pub key: Vec<Option<String>>,
}
