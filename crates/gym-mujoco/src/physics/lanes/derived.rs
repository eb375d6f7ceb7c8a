//! Arrays beside the state that worlds leave behind.

use super::{Arrays, Row};
use crate::{Data, Model};

/// A derived array that a task reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Derived {
    /// [`Data::xpos`].
    Xpos,
    /// [`Data::xipos`].
    Xipos,
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
    /// [`Data::cfrc_ext`], where contact forces are computed after a step.
    CfrcExt,
}

impl Derived {
    /// The number of its elements.
    pub(super) fn len(self, m: &Model) -> usize {
        match self {
            Self::Xpos | Self::Xipos => 3 * m.nbody(),
            Self::SiteXpos => 3 * m.nsite(),
            Self::Cinert => 10 * m.nbody(),
            Self::QfrcActuator | Self::QfrcConstraint => m.nv(),
            Self::Cvel | Self::CfrcExt => 6 * m.nbody(),
        }
    }

    pub(super) fn of(self, a: &Arrays) -> &[Row] {
        match self {
            Self::Xpos => a.xpos.as_flattened(),
            Self::Xipos => a.xipos.as_flattened(),
            Self::SiteXpos => a.site_xpos.as_flattened(),
            Self::Cinert => a.cinert.as_flattened(),
            Self::Cvel => a.cvel.as_flattened(),
            Self::QfrcActuator => &a.qfrc_actuator,
            Self::QfrcConstraint => &a.qfrc_constraint,
            Self::CfrcExt => a.cfrc_ext.as_flattened(),
        }
    }

    pub(crate) fn of_data(self, d: &mut Data) -> &mut [f64] {
        match self {
            Self::Xpos => d.xpos.as_flattened_mut(),
            Self::Xipos => d.xipos.as_flattened_mut(),
            Self::SiteXpos => d.site_xpos.as_flattened_mut(),
            Self::Cinert => d.cinert.as_flattened_mut(),
            Self::Cvel => d.cvel.as_flattened_mut(),
            Self::QfrcActuator => &mut d.qfrc_actuator,
            Self::QfrcConstraint => &mut d.qfrc_constraint,
            Self::CfrcExt => d.cfrc_ext.as_flattened_mut(),
        }
    }

    /// All of them.
    pub(crate) const ALL: [Self; 8] = [
        Self::Xpos,
        Self::Xipos,
        Self::SiteXpos,
        Self::Cinert,
        Self::Cvel,
        Self::QfrcActuator,
        Self::QfrcConstraint,
        Self::CfrcExt,
    ];
}
