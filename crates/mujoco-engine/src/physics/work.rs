//! Buffers of a forward call. No value passes from one call to the next.

use super::collision::Polytope;
use super::implicit;
use super::inertia::Way;
use super::solver::{Island, buffers, pgs};
use super::transmission::Moments;
use crate::Model;
use crate::math::dense::{self, Lanes};
use crate::model::Cone;

/// Buffers, allocated once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// The sizes of the model that the buffers fit.
    sizes: Option<[usize; 15]>,
    /// Whether an external force acts on a joint or a body.
    pub(crate) pushed: bool,
    /// Whether to leave out frames of geoms and sites that no stage reads.
    pub(crate) skips: bool,
    /// Composite inertias.
    pub(crate) crb: Vec<[f64; 10]>,
    /// Motion axes on the path from the root to a degree of freedom: four at a time, by components.
    pub(crate) axes: Vec<[Lanes; 6]>,
    /// Vectors over the path from the root of a tree to a degree of freedom.
    pub(crate) way: Way,
    /// Accelerations of bodies.
    pub(crate) acc: Vec<[f64; 6]>,
    /// Forces on bodies.
    pub(crate) body_force: Vec<[f64; 6]>,
    /// Velocities of bodies at their centres of mass.
    pub(crate) body_velocity: Vec<[f64; 6]>,
    /// A vector over the degrees of freedom.
    pub(crate) dofs: Vec<Lanes>,
    /// Forces of the fluid, of dampers, and of gravity compensation.
    pub(crate) fluid: Vec<f64>,
    pub(crate) damper: Vec<f64>,
    pub(crate) gravcomp: Vec<f64>,
    /// Moment arms of the actuators.
    pub(crate) moments: Moments,
    /// Clamped controls.
    pub(crate) ctrl: Vec<f64>,
    /// Forces of the actuators on tendons.
    pub(crate) tendon_sums: Vec<f64>,
    /// The weighted sum of the activations' rates over the Runge-Kutta stages.
    pub(crate) act_sum: Vec<f64>,
    pub(crate) act_start: Vec<f64>,

    pub(crate) polytope: Polytope,

    /// The island of each tree; `usize::MAX` for none.
    pub(crate) tree_island: Vec<usize>,
    pub(crate) tree_least: Vec<usize>,
    pub(crate) tree_touched: Vec<bool>,
    /// Trees by island.
    pub(crate) island_trees: Vec<usize>,
    /// Blocks by island.
    pub(crate) island_blocks: Vec<usize>,
    pub(crate) islands: Vec<Island>,
    pub(crate) newton: buffers::Buffers,
    pub(crate) pgs: pgs::Buffers,
    pub(crate) implicit: implicit::Buffers,

    /// `M + dt * damping`, later its factors.
    pub(crate) qh: Vec<f64>,
    pub(crate) qh_diag_inv: Vec<f64>,
    pub(crate) acc_sum: Vec<f64>,
    pub(crate) vel_sum: Vec<f64>,
    /// Rates of the positions at a Runge-Kutta stage, relative to the start.
    pub(crate) rates: Vec<f64>,
    pub(crate) qpos_start: Vec<f64>,
    pub(crate) qvel_start: Vec<f64>,
}

impl Work {
    pub(crate) fn new(m: &Model) -> Self {
        let nv = m.nv();
        let bounds = m.plan().bounds();
        let trees = m.ntree();
        let cones = match m.opt.cone {
            Cone::Elliptic => bounds.contacts,
            Cone::Pyramidal => 0,
        };
        Self {
            tree_island: Vec::with_capacity(trees),
            tree_least: Vec::with_capacity(trees),
            tree_touched: Vec::with_capacity(trees),
            island_trees: Vec::with_capacity(trees),
            island_blocks: Vec::with_capacity(bounds.blocks),
            islands: Vec::with_capacity(trees),
            newton: buffers::Buffers::new(m, bounds.rows, bounds.blocks, cones),
            pgs: pgs::Buffers::new(m, &bounds),
            implicit: implicit::Buffers::new(m),
            sizes: Some(m.plan().sizes),
            pushed: false,
            skips: false,
            crb: vec![[0.0; 10]; m.nbody()],
            axes: vec![[[0.0; 4]; 6]; m.plan().m_groups],
            way: Way::new(m),
            acc: vec![[0.0; 6]; m.nbody()],
            body_force: vec![[0.0; 6]; m.nbody()],
            body_velocity: Vec::with_capacity(m.nbody()),
            dofs: vec![[0.0; 4]; dense::groups(nv)],
            fluid: vec![0.0; nv],
            damper: vec![0.0; nv],
            gravcomp: vec![0.0; nv],
            moments: Moments::new(m),
            ctrl: Vec::with_capacity(m.nu()),
            tendon_sums: vec![0.0; m.ntendon()],
            act_sum: vec![0.0; m.na()],
            act_start: vec![0.0; m.na()],
            polytope: Polytope::new(m.plan().deep),
            qh: vec![0.0; m.plan().m_colind.len()],
            qh_diag_inv: vec![0.0; nv],
            acc_sum: vec![0.0; nv],
            vel_sum: vec![0.0; nv],
            rates: vec![0.0; nv],
            qpos_start: vec![0.0; m.nq()],
            qvel_start: vec![0.0; nv],
        }
    }

    pub(crate) fn fits(&self, m: &Model) -> bool {
        self.sizes.as_ref() == Some(&m.plan().sizes)
    }
}
