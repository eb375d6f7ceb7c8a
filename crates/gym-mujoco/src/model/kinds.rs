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
        /// A mesh. Meshes have no size and no contacts here.
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
        /// A tendon.
        Tendon = 3,
        /// A site.
        Site = 4,
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

/// Declares the sensors: name in MJCF, variant, MuJoCo's number, object, number of values, and the
/// stage after which they can be computed.
macro_rules! sensors {
    ($($(#[$doc:meta])* $name:literal $variant:ident = $number:literal, $object:ident, $dim:literal, $stage:ident;)+) => {
        numbered! {
            /// The kinds of sensor: MuJoCo's `mjtSensor`.
            SensorType, "sensor type" {
                $($(#[$doc])* $variant = $number,)+
            }
        }

        impl SensorType {
            /// All types, with their names in MJCF.
            pub(crate) const ALL: &[(&str, Self)] = &[$(($name, Self::$variant),)+];

            /// The kind of object that the sensor measures.
            pub(crate) fn about(self) -> About {
                match self {
                    $(Self::$variant => About::$object,)+
                }
            }

            /// The number of values.
            #[must_use]
            pub fn dim(self) -> usize {
                match self {
                    $(Self::$variant => $dim,)+
                }
            }

            /// The stage after which the sensor can be computed.
            pub(crate) fn stage(self) -> Stage {
                match self {
                    $(Self::$variant => Stage::$stage,)+
                }
            }
        }
    };
}

/// The kind of object that a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum About {
    Nothing,
    Site,
    Joint,
    Ball,
    Tendon,
    Actuator,
    Body,
    /// A body, geom, site or camera.
    Frame,
    /// A body, geom, site or camera, optionally in the frame of another.
    Relative,
}

/// A stage of a forward call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Position,
    Velocity,
    Acceleration,
}

sensors! {
    /// Sum of the normal forces of contacts within a site.
    "touch" Touch = 0, Site, 1, Acceleration;
    /// Acceleration of a site, with gravity, in its frame.
    "accelerometer" Accelerometer = 1, Site, 3, Acceleration;
    /// Velocity of a site, in its frame.
    "velocimeter" Velocimeter = 2, Site, 3, Velocity;
    /// Angular velocity of a site, in its frame.
    "gyro" Gyro = 3, Site, 3, Velocity;
    /// Force between a site's body and its parent, in the site's frame.
    "force" Force = 4, Site, 3, Acceleration;
    /// Torque between a site's body and its parent, in the site's frame.
    "torque" Torque = 5, Site, 3, Acceleration;
    /// The magnetic field in a site's frame.
    "magnetometer" Magnetometer = 6, Site, 3, Position;
    /// Distance from a site along its z axis to the nearest geom; -1 if there is none.
    "rangefinder" Rangefinder = 7, Site, 1, Position;
    /// Position of a slide or hinge.
    "jointpos" JointPos = 9, Joint, 1, Position;
    /// Velocity of a slide or hinge.
    "jointvel" JointVel = 10, Joint, 1, Velocity;
    /// Length of a tendon.
    "tendonpos" TendonPos = 11, Tendon, 1, Position;
    /// Velocity of a tendon.
    "tendonvel" TendonVel = 12, Tendon, 1, Velocity;
    /// Length of an actuator.
    "actuatorpos" ActuatorPos = 13, Actuator, 1, Position;
    /// Velocity of an actuator.
    "actuatorvel" ActuatorVel = 14, Actuator, 1, Velocity;
    /// Force of an actuator.
    "actuatorfrc" ActuatorFrc = 15, Actuator, 1, Acceleration;
    /// Force of all actuators on a slide or hinge.
    "jointactuatorfrc" JointActFrc = 16, Joint, 1, Acceleration;
    /// Force of all actuators on a tendon.
    "tendonactuatorfrc" TendonActFrc = 17, Tendon, 1, Acceleration;
    /// Quaternion of a ball joint.
    "ballquat" BallQuat = 18, Ball, 4, Position;
    /// Angular velocity of a ball joint.
    "ballangvel" BallAngVel = 19, Ball, 3, Velocity;
    /// Distance of a joint to its limit, if the limit is active.
    "jointlimitpos" JointLimitPos = 20, Joint, 1, Position;
    /// Velocity of a joint towards its limit, if the limit is active.
    "jointlimitvel" JointLimitVel = 21, Joint, 1, Velocity;
    /// Force of a joint's limit.
    "jointlimitfrc" JointLimitFrc = 22, Joint, 1, Acceleration;
    /// Distance of a tendon to its limit, if the limit is active.
    "tendonlimitpos" TendonLimitPos = 23, Tendon, 1, Position;
    /// Velocity of a tendon towards its limit, if the limit is active.
    "tendonlimitvel" TendonLimitVel = 24, Tendon, 1, Velocity;
    /// Force of a tendon's limit.
    "tendonlimitfrc" TendonLimitFrc = 25, Tendon, 1, Acceleration;
    /// Position of an object.
    "framepos" FramePos = 26, Relative, 3, Position;
    /// Orientation of an object.
    "framequat" FrameQuat = 27, Relative, 4, Position;
    /// The x axis of an object.
    "framexaxis" FrameXAxis = 28, Relative, 3, Position;
    /// The y axis of an object.
    "frameyaxis" FrameYAxis = 29, Relative, 3, Position;
    /// The z axis of an object.
    "framezaxis" FrameZAxis = 30, Relative, 3, Position;
    /// Velocity of an object.
    "framelinvel" FrameLinVel = 31, Relative, 3, Velocity;
    /// Angular velocity of an object.
    "frameangvel" FrameAngVel = 32, Relative, 3, Velocity;
    /// Acceleration of an object.
    "framelinacc" FrameLinAcc = 33, Frame, 3, Acceleration;
    /// Angular acceleration of an object.
    "frameangacc" FrameAngAcc = 34, Frame, 3, Acceleration;
    /// Centre of mass of a body with its descendants.
    "subtreecom" SubtreeCom = 35, Body, 3, Position;
    /// Velocity of the centre of mass of a body with its descendants.
    "subtreelinvel" SubtreeLinVel = 36, Body, 3, Velocity;
    /// Angular momentum of a body with its descendants about their centre of mass.
    "subtreeangmom" SubtreeAngMom = 37, Body, 3, Velocity;
    /// Potential energy.
    "e_potential" EPotential = 43, Nothing, 1, Position;
    /// Kinetic energy.
    "e_kinetic" EKinetic = 44, Nothing, 1, Velocity;
    /// Time.
    "clock" Clock = 45, Nothing, 1, Position;
}

impl SensorType {
    /// Whether the cutoff clamps the values: on both sides, or only above if they are never
    /// negative. Axes and quaternions are not clamped.
    #[must_use]
    pub fn has_cutoff(self) -> bool {
        let axes = [Self::FrameXAxis, Self::FrameYAxis, Self::FrameZAxis];
        !axes.contains(&self) && !self.is_quaternion()
    }

    /// Whether the sensor returns a quaternion.
    #[must_use]
    pub fn is_quaternion(self) -> bool {
        matches!(self, Self::FrameQuat | Self::BallQuat)
    }

    /// Whether the values are never negative.
    #[must_use]
    pub fn is_positive(self) -> bool {
        matches!(self, Self::Touch | Self::Rangefinder)
    }
}
