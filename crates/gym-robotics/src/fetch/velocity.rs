//! Velocities of sites.

use gym_core::Result;
use gym_sim::Simulation;
use gym_sim::numpy::three_rows_avx2;
use mujoco_engine::math::{add, cross, sub};
use mujoco_engine::{Data, Model};

/// A site whose velocity is observed.
#[derive(Debug)]
pub(super) struct Moving {
    pub(super) site: usize,
    /// The root of the site's kinematic tree.
    root: usize,
    /// The degrees of freedom that move the site, in order.
    dofs: Vec<usize>,
}

impl Moving {
    pub(super) fn new(simulation: &Simulation, name: &str) -> Result<Self> {
        let (m, site) = (&*simulation.model, simulation.site(name)?);
        let mut body = m.site_bodyid[site];
        let root = m.body_rootid[body];
        let mut dofs = Vec::new();
        while body > 0 {
            if let Ok(first) = usize::try_from(m.body_dofadr[body]) {
                dofs.extend(first..first + m.body_dofnum[body]);
            }
            body = m.body_parentid[body];
        }
        dofs.sort_unstable();
        Ok(Self { site, root, dofs })
    }

    /// The velocity in m/s and the angular velocity in rad/s: the products of the Jacobians,
    /// `mj_jacSite`, and the velocities of the joints.
    pub(super) fn velocity(&self, m: &Model, d: &Data) -> [[f64; 3]; 2] {
        let offset = sub(d.site_xpos[self.site], d.subtree_com[self.root]);
        let product = |column: &dyn Fn([f64; 3], [f64; 3]) -> [f64; 3]| {
            let columns = self.dofs.iter().map(|&dof| {
                let [a, b, c, x, y, z] = d.cdof[dof];
                (dof, column([a, b, c], [x, y, z]))
            });
            three_rows_avx2(m.nv(), columns, &d.qvel)
        };
        [
            product(&|turn, shift| add(shift, cross(turn, offset))),
            product(&|turn, _| turn),
        ]
    }
}
