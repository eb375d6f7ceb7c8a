//! The step of environments whose worlds step together, and the arrays that an environment reads
//! after a step.

use super::{Arrays, PerWorld, actuators};
use crate::{Data, Model};

/// The kind of step of environments whose worlds step together.
#[derive(Clone, Debug)]
pub struct Stride {
    /// The number of timesteps per step of the environment.
    pub steps: usize,
    /// Whether the environment calls [`step1`](crate::step1) after the timesteps. Frames and
    /// sensors then belong to the new state.
    pub settles: bool,
    /// Whether the environment calls
    /// [`rne_post_constraint`](crate::physics::rne_post_constraint) after the last timestep.
    pub contact_forces: bool,
    /// The derived arrays that the environment reads after a step.
    pub reads: Vec<Derived>,
}

impl Stride {
    /// Returns how many numbers at the front of `sensordata` the environment reads.
    pub(super) fn sensors(&self) -> usize {
        let numbers = self.reads.iter().map(|array| match array {
            Derived::Sensors(numbers) => *numbers,
            _ => 0,
        });
        numbers.max().unwrap_or(0)
    }
}

/// A derived array that a task reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Derived {
    /// [`Data::xpos`].
    Xpos,
    /// [`Data::xquat`].
    Xquat,
    /// [`Data::xmat`].
    Xmat,
    /// [`Data::xipos`].
    Xipos,
    /// [`Data::geom_xpos`].
    GeomXpos,
    /// [`Data::geom_xmat`].
    GeomXmat,
    /// [`Data::site_xpos`].
    SiteXpos,
    /// [`Data::cinert`].
    Cinert,
    /// [`Data::cvel`].
    Cvel,
    /// [`Data::qfrc_actuator`].
    QfrcActuator,
    /// [`Data::qfrc_constraint`].
    QfrcConstraint,
    /// [`Data::cfrc_ext`], for tasks that compute contact forces after a step.
    CfrcExt,
    /// [`Data::ten_length`].
    TenLength,
    /// [`Data::ten_velocity`].
    TenVelocity,
    /// The first numbers of [`Data::sensordata`].
    Sensors(usize),
}

impl Derived {
    /// Returns the number of elements of the array.
    pub(super) fn len(self, m: &Model) -> usize {
        match self {
            Self::Xpos | Self::Xipos => 3 * m.nbody(),
            Self::Xquat => 4 * m.nbody(),
            Self::Xmat => 9 * m.nbody(),
            Self::GeomXpos => 3 * m.ngeom(),
            Self::GeomXmat => 9 * m.ngeom(),
            Self::SiteXpos => 3 * m.nsite(),
            Self::Cinert => 10 * m.nbody(),
            Self::QfrcActuator | Self::QfrcConstraint => m.nv(),
            Self::Cvel | Self::CfrcExt => 6 * m.nbody(),
            Self::TenLength | Self::TenVelocity => m.ntendon(),
            Self::Sensors(numbers) => numbers,
        }
    }

    pub(super) fn of(self, a: &Arrays) -> &[PerWorld] {
        match self {
            Self::Xpos => a.xpos.as_flattened(),
            Self::Xquat => a.xquat.as_flattened(),
            Self::Xmat => a.xmat.as_flattened(),
            Self::Xipos => a.xipos.as_flattened(),
            Self::GeomXpos => a.geom_xpos.as_flattened(),
            Self::GeomXmat => a.geom_xmat.as_flattened(),
            Self::SiteXpos => a.site_xpos.as_flattened(),
            Self::Cinert => a.cinert.as_flattened(),
            Self::Cvel => a.cvel.as_flattened(),
            Self::QfrcActuator => &a.qfrc_actuator,
            Self::QfrcConstraint => &a.qfrc_constraint,
            Self::CfrcExt => a.cfrc_ext.as_flattened(),
            Self::TenLength => &a.ten_length,
            Self::TenVelocity => &a.ten_velocity,
            Self::Sensors(numbers) => &a.sensordata[..numbers],
        }
    }

    pub(crate) fn of_data(self, d: &mut Data) -> &mut [f64] {
        match self {
            Self::Xpos => d.xpos.as_flattened_mut(),
            Self::Xquat => d.xquat.as_flattened_mut(),
            Self::Xmat => d.xmat.as_flattened_mut(),
            Self::Xipos => d.xipos.as_flattened_mut(),
            Self::GeomXpos => d.geom_xpos.as_flattened_mut(),
            Self::GeomXmat => d.geom_xmat.as_flattened_mut(),
            Self::SiteXpos => d.site_xpos.as_flattened_mut(),
            Self::Cinert => d.cinert.as_flattened_mut(),
            Self::Cvel => d.cvel.as_flattened_mut(),
            Self::QfrcActuator => &mut d.qfrc_actuator,
            Self::QfrcConstraint => &mut d.qfrc_constraint,
            Self::CfrcExt => d.cfrc_ext.as_flattened_mut(),
            Self::TenLength => &mut d.ten_length,
            Self::TenVelocity => &mut d.ten_velocity,
            Self::Sensors(numbers) => &mut d.sensordata[..numbers],
        }
    }

    /// Whether worlds that step together compute this array for the model.
    #[must_use]
    pub fn is_known(self, m: &Model) -> bool {
        match self {
            Self::TenLength | Self::TenVelocity => actuators::can_measure_tendons(m),
            _ => true,
        }
    }

    /// All arrays except the tendons' and `sensordata`.
    pub(crate) const ALL: [Self; 12] = [
        Self::Xpos,
        Self::Xquat,
        Self::Xmat,
        Self::Xipos,
        Self::GeomXpos,
        Self::GeomXmat,
        Self::SiteXpos,
        Self::Cinert,
        Self::Cvel,
        Self::QfrcActuator,
        Self::QfrcConstraint,
        Self::CfrcExt,
    ];
}
