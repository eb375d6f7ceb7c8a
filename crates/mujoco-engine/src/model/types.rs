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
    /// The integrator of accelerations to velocities and positions.
    pub integrator: Integrator,
    /// The solver of constraint forces.
    pub solver: Solver,
    /// Largest number of solver iterations.
    pub iterations: usize,
    /// Largest number of evaluations in a line search of the Newton solver.
    pub ls_iterations: usize,
    /// Improvement below which the solver stops.
    pub tolerance: f64,
    /// Tolerance of the line search, relative to `tolerance`.
    pub ls_tolerance: f64,
    /// The type of friction cones.
    pub cone: Cone,
    /// Ratio of frictional to normal constraint impedance, for elliptic cones.
    pub impratio: f64,
    /// Number of no-slip iterations after the solver.
    pub noslip_iterations: usize,
    /// Improvement below which the no-slip iterations stop.
    pub noslip_tolerance: f64,
    /// Largest number of iterations of a search for the contact of convex shapes.
    pub ccd_iterations: usize,
    /// The precision of such a search.
    pub ccd_tolerance: f64,
    /// The velocity below which a tree may fall asleep.
    pub sleep_tolerance: f64,
    /// The magnetic field.
    pub magnetic: [f64; 3],
    /// Disabled parts: bits of MuJoCo's `mjtDisableBit`, see [`Disable`].
    pub disableflags: u32,
    /// Enabled parts: bits of MuJoCo's `mjtEnableBit`.
    pub enableflags: u32,
    /// Disabled groups of actuators, as bits.
    pub disableactuator: u32,
    /// How MuJoCo stores Jacobians (0 dense, 1 sparse, 2 automatic: sparse from 60 degrees of
    /// freedom on). It decides in which order sums are added, and so their last bits.
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
            ccd_iterations: 35,
            ccd_tolerance: 1e-6,
            sleep_tolerance: 1e-3,
            magnetic: [0.0, -0.5, 0.0],
            disableflags: 0,
            enableflags: 0,
            disableactuator: 0,
            jacobian: 2,
        }
    }
}

impl Options {
    /// MuJoCo's `mjENBL_ENERGY`.
    pub(crate) const ENERGY: u32 = 1 << 1;
    /// MuJoCo's `mjENBL_INVDISCRETE`.
    pub(crate) const INVDISCRETE: u32 = 1 << 3;
    /// MuJoCo's `mjENBL_SLEEP`.
    pub(crate) const SLEEP: u32 = 1 << 4;

    /// Whether trees of bodies may fall asleep.
    #[must_use]
    pub fn sleeps(&self) -> bool {
        self.enables(Self::SLEEP)
    }

    /// Whether a part is enabled, given by its bit.
    pub(crate) fn enables(&self, part: u32) -> bool {
        self.enableflags & part != 0
    }
}

/// The numbers of MuJoCo's `mjtSleepPolicy`.
pub(crate) mod sleep_policy {
    pub(crate) const AUTO: u8 = 0;
    pub(crate) const AUTO_NEVER: u8 = 1;
    pub(crate) const AUTO_ALLOWED: u8 = 2;
    pub(crate) const NEVER: u8 = 3;
    pub(crate) const ALLOWED: u8 = 4;
    pub(crate) const INIT: u8 = 5;
}

/// Parts of a simulation that can be disabled, as bits of [`Options::disableflags`]: MuJoCo's
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
    /// Clamping of controls to their ranges.
    ClampCtrl = 1 << 8,
    /// Warm starts of the solver.
    WarmStart = 1 << 9,
    /// The rule that a body does not collide with its parent.
    FilterParent = 1 << 10,
    /// Actuators.
    Actuation = 1 << 11,
    /// The lower bound of twice the timestep on a constraint's time constant.
    RefSafe = 1 << 12,
    /// Sensors.
    Sensor = 1 << 13,
    /// The middle phase of collision detection.
    MidPhase = 1 << 14,
    /// The implicit treatment of damping by Euler's integrator.
    EulerDamp = 1 << 15,
    /// The reset of a state that diverges.
    AutoReset = 1 << 16,
    /// MuJoCo's native collision routine for convex shapes.
    NativeCcd = 1 << 17,
    /// Division of constraints into islands.
    Island = 1 << 18,
    /// Several contacts per pair of convex shapes.
    MultiCcd = 1 << 19,
}

impl Options {
    /// Whether a part is disabled.
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

/// Parameters of an actuator's dynamics, gain or bias: ten numbers. A serialised list may be
/// shorter; the missing numbers are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<f64>")]
pub struct Parameters(pub [f64; 10]);

impl From<Vec<f64>> for Parameters {
    fn from(numbers: Vec<f64>) -> Self {
        Self(padded(&numbers))
    }
}

/// The first `N` numbers of a list; zeros after its end.
pub(crate) fn padded<const N: usize>(numbers: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0.0))
}

/// Fluid coefficients of a geom: 1 for the ellipsoid model (else 0), five coefficients, virtual
/// masses and virtual moments. A serialised list may be shorter; the missing numbers are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Numbers")]
pub struct Fluid(pub [f64; 12]);

/// The largest number of iterations of a solver: with a tolerance of 0, a step takes them all.
pub(crate) const MAX_ITERATIONS: usize = 100_000;

/// The limit, for messages.
pub(crate) fn most_iterations() -> String {
    format!("{MAX_ITERATIONS}, with which a step may take seconds")
}

/// A number or a list of numbers.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number or a list of numbers")]
enum Numbers {
    One(f64),
    Several(Vec<f64>),
}

impl From<Numbers> for Fluid {
    fn from(numbers: Numbers) -> Self {
        Self(match numbers {
            Numbers::One(number) => padded(&[number]),
            Numbers::Several(numbers) => padded(&numbers),
        })
    }
}
