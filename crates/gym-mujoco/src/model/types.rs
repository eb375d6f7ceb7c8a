//! Options, kinds and names of a compiled model.

use serde::{Deserialize, Serialize};

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
            jacobian: 2,
        }
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
}

/// An enum that is serialised as the number that MuJoCo gives it.
macro_rules! numbered {
    ($(#[$doc:meta])* $name:ident, $what:literal { $($(#[$variant_doc:meta])* $variant:ident = $number:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(try_from = "u8", into = "u8")]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$variant_doc])* $variant = $number,)+
        }

        impl TryFrom<u8> for $name {
            type Error = String;

            fn try_from(number: u8) -> Result<Self, String> {
                match number {
                    $($number => Ok(Self::$variant),)+
                    _ => Err(format!(
                        concat!("unsupported ", $what, " {}: supported are ", $(stringify!($number), " (", stringify!($variant), ") ",)+),
                        number
                    )),
                }
            }
        }

        impl From<$name> for u8 {
            fn from(value: $name) -> u8 {
                value as u8
            }
        }
    };
}

numbered! {
    /// The kinds of joint: MuJoCo's `mjtJoint`.
    JointType, "joint type" {
        /// Any motion: 7 positions (position, quaternion), 6 velocities (linear in the world's
        /// frame, angular in the body's).
        Free = 0,
        /// Translation along an axis.
        Slide = 2,
        /// Rotation about an axis.
        Hinge = 3,
    }
}

numbered! {
    /// The shape of a geom: MuJoCo's `mjtGeom`.
    GeomType, "geom type" {
        /// An infinite plane, with the z axis as its normal.
        Plane = 0,
        /// A sphere.
        Sphere = 2,
        /// A cylinder along z with half spheres at its ends.
        Capsule = 3,
        /// A cylinder along z.
        Cylinder = 5,
    }
}

numbered! {
    /// How velocities and positions follow from accelerations: MuJoCo's `mjtIntegrator`.
    Integrator, "integrator" {
        /// Semi-implicit Euler, implicit in joint damping.
        Euler = 0,
        /// Runge-Kutta of fourth order.
        RK4 = 1,
    }
}

numbered! {
    /// How constraint forces are found: MuJoCo's `mjtSolver`.
    Solver, "solver" {
        /// Projected Gauss-Seidel.
        PGS = 0,
        /// Newton's method.
        Newton = 2,
    }
}
