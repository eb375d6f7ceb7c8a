//! The sparsity of the tendons' Jacobians.

use std::ops::Range;

use super::{CompiledModel, Disable, WrapType};

/// Properties of the tendons that do not depend on the state.
#[derive(Clone, Debug, Default)]
pub(crate) struct Paths {
    /// The elements of each tendon's row of the Jacobian.
    pub(crate) rows: Vec<Range<usize>>,
    /// The degrees of freedom of the elements, ascending within a row.
    pub(crate) columns: Vec<usize>,
    /// Whether each tendon is fixed: a sum of joint positions.
    pub(crate) fixed: Vec<bool>,
    /// The tendons with springs or dampers: index, stiffness and damping.
    pub(crate) elastic: Vec<(usize, f64, f64)>,
}

impl Paths {
    /// Builds the structure: MuJoCo's `makeTendonSparse`. `chain` returns the degrees of freedom
    /// that move a body.
    pub(crate) fn new<'a>(m: &CompiledModel, chain: impl Fn(usize) -> &'a [usize]) -> Self {
        let mut paths = Self::default();
        for t in 0..m.ntendon() {
            let parts = m.tendon_adr[t]..m.tendon_adr[t] + m.tendon_num[t];
            let mut dofs = Vec::new();
            for w in parts.clone() {
                let id = usize::try_from(m.wrap_objid[w]).unwrap_or(0);
                match m.wrap_type[w] {
                    WrapType::Joint => dofs.push(m.jnt_dofadr[id]),
                    WrapType::Pulley => {}
                    WrapType::Site => dofs.extend_from_slice(chain(m.site_bodyid[id])),
                    WrapType::Sphere | WrapType::Cylinder => {
                        dofs.extend_from_slice(chain(m.geom_bodyid[id]));
                    }
                }
            }
            dofs.sort_unstable();
            dofs.dedup();
            let first = paths.columns.len();
            paths.columns.extend(dofs);
            paths.rows.push(first..paths.columns.len());
            paths
                .fixed
                .push(m.wrap_type[parts.start] == WrapType::Joint);
            let (spring, damper) = (Disable::Spring, Disable::Damper);
            let on = |part, x: f64| if m.opt.disables(part) { 0.0 } else { x };
            let stiffness = on(spring, m.tendon_stiffness[t]);
            let damping = on(damper, m.tendon_damping[t]);
            let bends = on(spring, f64::from(m.tendon_stiffnesspoly[t] != [0.0; 2]))
                + on(damper, f64::from(m.tendon_dampingpoly[t] != [0.0; 2]));
            if stiffness != 0.0 || damping != 0.0 || bends != 0.0 {
                paths.elastic.push((t, stiffness, damping));
            }
        }
        paths
    }
}
