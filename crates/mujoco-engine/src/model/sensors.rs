//! The kinds of sensor, and what the engine must know of each.

use serde::{Deserialize, Serialize};

use super::kinds::numbered;

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
    /// A body, geom, site or camera, and a site.
    Inside,
    /// A site and a camera.
    Projection,
    /// A geom, a body's geoms, bodies or a site, or anything, and another.
    Contact,
    /// Two geoms or bodies.
    Pair,
    /// A site or a camera.
    Ray,
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
    "rangefinder" Rangefinder = 7, Ray, 1, Position;
    /// The place of a site in a camera's picture, in pixels.
    "camprojection" CamProjection = 8, Projection, 2, Position;
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
    /// 1 if an object's position is within a site, else 0.
    "insidesite" InsideSite = 38, Inside, 1, Position;
    /// The distance of two geoms, or of the geoms of bodies, at most the cutoff.
    "distance" GeomDist = 39, Pair, 1, Position;
    /// The direction from the first to the second of two geoms nearer than the cutoff.
    "normal" GeomNormal = 40, Pair, 3, Position;
    /// The nearest points of two geoms nearer than the cutoff.
    "fromto" GeomFromTo = 41, Pair, 6, Position;
    /// Contacts.
    "contact" Contact = 42, Contact, 1, Acceleration;
    /// Potential energy.
    "e_potential" EPotential = 43, Nothing, 1, Position;
    /// Kinetic energy.
    "e_kinetic" EKinetic = 44, Nothing, 1, Position;
    /// Time.
    "clock" Clock = 45, Nothing, 1, Position;
}

/// The values of a ray, and their numbers.
pub(crate) const RAY: [(&str, usize); 6] = [
    ("dist", 1),
    ("dir", 3),
    ("origin", 3),
    ("point", 3),
    ("normal", 3),
    ("depth", 1),
];

/// The values of a contact, and their numbers.
pub(crate) const CONTACT: [(&str, usize); 7] = [
    ("found", 1),
    ("force", 3),
    ("torque", 3),
    ("dist", 1),
    ("pos", 3),
    ("normal", 3),
    ("tangent", 3),
];

impl SensorType {
    /// Whether the cutoff clamps the values: of `touch` above, of others on both sides. Axes,
    /// quaternions, contacts and the nearest points of geoms are not clamped.
    #[must_use]
    pub fn has_cutoff(self) -> bool {
        let axes = [Self::FrameXAxis, Self::FrameYAxis, Self::FrameZAxis];
        let others = [Self::GeomNormal, Self::GeomFromTo, Self::Contact];
        !axes.contains(&self) && !others.contains(&self) && !self.is_quaternion()
    }

    /// The number of values of `number` contacts or pixels; `bits` select them.
    pub(crate) fn values(self, bits: i32, number: usize) -> usize {
        let sizes = match self {
            Self::Contact => &CONTACT[..],
            Self::Rangefinder => &RAY,
            _ => return self.dim(),
        };
        let parts = sizes.iter().enumerate();
        // without bits, the first value
        let bits = bits.max(1);
        let own = parts.filter(|(k, _)| bits & (1 << k) != 0);
        own.map(|(_, (_, size))| size).sum::<usize>() * number
    }

    /// Whether the sensor returns a quaternion.
    fn is_quaternion(self) -> bool {
        matches!(self, Self::FrameQuat | Self::BallQuat)
    }

    /// Whether the cutoff clamps the values above only.
    pub(crate) fn is_positive(self) -> bool {
        self == Self::Touch
    }
}
