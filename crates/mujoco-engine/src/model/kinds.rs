//! Types of a model's objects, with MuJoCo's numbers.

use serde::{Deserialize, Serialize};

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

pub(super) use numbered;

numbered! {
    /// The kinds of joint: MuJoCo's `mjtJoint`.
    JointType, "joint type" {
        /// Any motion: 7 positions (position, quaternion), 6 velocities (linear in the world's
        /// frame, angular in the body's).
        Free = 0,
        /// Any rotation about the anchor: a quaternion, and an angular velocity in the body's
        /// frame.
        Ball = 1,
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
        /// A height field, with its heights along the z axis.
        Hfield = 1,
        /// A sphere.
        Sphere = 2,
        /// A cylinder along z with half spheres at its ends.
        Capsule = 3,
        /// An ellipsoid.
        Ellipsoid = 4,
        /// A cylinder along z.
        Cylinder = 5,
        /// A box.
        Box = 6,
        /// A mesh of the model, in its principal frame.
        Mesh = 7,
    }
}

numbered! {
    /// The integrator of accelerations to velocities and positions: MuJoCo's `mjtIntegrator`.
    Integrator, "integrator" {
        /// Semi-implicit Euler, implicit in joint damping.
        Euler = 0,
        /// Runge-Kutta of fourth order.
        RK4 = 1,
        /// Implicit in the velocities, with the derivatives of all smooth forces.
        Implicit = 2,
        /// Implicit in the velocities, without the derivatives of Coriolis and centrifugal forces.
        ImplicitFast = 3,
    }
}

numbered! {
    /// The solver of constraint forces: MuJoCo's `mjtSolver`.
    Solver, "solver" {
        /// Projected Gauss-Seidel.
        PGS = 0,
        /// Conjugate gradients.
        CG = 1,
        /// Newton's method.
        Newton = 2,
    }
}

numbered! {
    /// The type of friction cones: MuJoCo's `mjtCone`.
    Cone, "cone" {
        /// Pyramids; a contact has one row for each edge.
        Pyramidal = 0,
        /// Elliptic cones.
        Elliptic = 1,
    }
}

numbered! {
    /// The types of equality constraint: MuJoCo's `mjtEq`.
    EqualityType, "equality type" {
        /// Two bodies at a point.
        Connect = 0,
        /// Position and orientation of two bodies.
        Weld = 1,
        /// The positions of two joints, by a polynomial.
        Joint = 2,
        /// The lengths of two tendons, by a polynomial.
        Tendon = 3,
    }
}

numbered! {
    /// The parts of a tendon's path: MuJoCo's `mjtWrap`.
    WrapType, "wrap type" {
        /// A joint of a fixed tendon.
        Joint = 1,
        /// A pulley: the lengths after the pulley are divided by its divisor.
        Pulley = 2,
        /// A site that the tendon passes through.
        Site = 3,
        /// A sphere around which the tendon runs.
        Sphere = 4,
        /// A cylinder around which the tendon runs.
        Cylinder = 5,
    }
}

numbered! {
    /// The transmission of an actuator: MuJoCo's `mjtTrn`.
    TransmissionType, "transmission type" {
        /// A joint.
        Joint = 0,
        /// A joint; the axis of a ball or free joint is given in the parent's frame.
        JointInParent = 1,
        /// A site that is the pin of a crank, whose rod moves a slider.
        SliderCrank = 2,
        /// A tendon.
        Tendon = 3,
        /// A site.
        Site = 4,
        /// A body, which adheres to what it touches.
        Body = 5,
    }
}

numbered! {
    /// The activation dynamics: MuJoCo's `mjtDyn`.
    DynamicsType, "dynamics type" {
        /// No activation.
        None = 0,
        /// The control is the rate of change.
        Integrator = 1,
        /// First-order filter of the control.
        Filter = 2,
        /// First-order filter of the control, integrated exactly.
        FilterExact = 3,
        /// Muscle activation.
        Muscle = 4,
    }
}

numbered! {
    /// The gain, which multiplies the control or activation: MuJoCo's `mjtGain`.
    GainType, "gain type" {
        /// A constant.
        Fixed = 0,
        /// An affine function of length and velocity.
        Affine = 1,
        /// A muscle's active force.
        Muscle = 2,
    }
}

numbered! {
    /// The bias, which is added to the force: MuJoCo's `mjtBias`.
    BiasType, "bias type" {
        /// None.
        None = 0,
        /// An affine function of length and velocity.
        Affine = 1,
        /// A muscle's passive force.
        Muscle = 2,
    }
}

numbered! {
    /// The types of a sensor's object: MuJoCo's `mjtObj`.
    ObjectType, "object type" {
        /// None.
        Unknown = 0,
        /// A body, at its centre of mass.
        Body = 1,
        /// A body, at its frame.
        XBody = 2,
        /// A joint.
        Joint = 3,
        /// A geom.
        Geom = 5,
        /// A site.
        Site = 6,
        /// A camera.
        Camera = 7,
        /// A tendon.
        Tendon = 18,
        /// An actuator.
        Actuator = 19,
    }
}

impl JointType {
    /// Whether a joint of this type has one position and one velocity: a slide or a hinge.
    #[must_use]
    pub fn is_scalar(self) -> bool {
        matches!(self, Self::Slide | Self::Hinge)
    }

    /// The number of positions of a joint of this type.
    #[must_use]
    pub fn nq(self) -> usize {
        match self {
            Self::Free => 7,
            Self::Ball => 4,
            Self::Slide | Self::Hinge => 1,
        }
    }

    /// The number of degrees of freedom of a joint of this type.
    #[must_use]
    pub fn nv(self) -> usize {
        match self {
            Self::Free => 6,
            Self::Ball => 3,
            Self::Slide | Self::Hinge => 1,
        }
    }
}

impl EqualityType {
    /// The number of rows of a constraint of this type.
    #[must_use]
    pub fn rows(self) -> usize {
        match self {
            Self::Connect => 3,
            Self::Weld => 6,
            Self::Joint | Self::Tendon => 1,
        }
    }
}
