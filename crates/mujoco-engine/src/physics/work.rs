//! Buffers of a forward call. No value passes from one call to the next, except from the first
//! half of a step to the second.

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
    sizes: Option<[usize; 17]>,
    /// Whether an external force acts on a joint or a body.
    pub(crate) pushed: bool,
    /// Whether to leave out frames of geoms and sites that no stage reads.
    pub(crate) skips: bool,
    /// Whether actuators are as if they were disabled.
    pub(crate) unactuated: bool,
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

    /// Whether each tree is awake, if trees may sleep.
    pub(crate) tree_awake: Vec<bool>,
    /// Whether a step computes accelerations again because trees fell asleep.
    pub(crate) settled: bool,
    /// Forces and accelerations of trees that sleep.
    pub(crate) kept: Vec<f64>,

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
            tree_awake: vec![true; if m.plan().sleeps { trees } else { 0 }],
            settled: false,
            kept: Vec::with_capacity(if m.plan().sleeps { 2 * nv } else { 0 }),
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
            unactuated: false,
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
            ctrl: vec![0.0; m.nu()],
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

    /// Clears what the first half of a step leaves to the second.
    pub(crate) fn clear(&mut self) {
        self.moments.reset();
        for buffer in [&mut self.gravcomp, &mut self.qh, &mut self.qh_diag_inv] {
            buffer.fill(0.0);
        }
    }

    pub(crate) fn fits(&self, m: &Model) -> bool {
        let Some(sizes) = &self.sizes else {
            return false;
        };
        // each step asks: this loop has no early exit, so it vectorises, and takes less time than a
        // call of `memcmp`
        let pairs = sizes.iter().zip(&m.plan().sizes);
        pairs.fold(0, |bits, (own, other)| bits | (own ^ other)) == 0
    }
}

/// Replaces numbers by NaN.
#[cfg(test)]
pub(crate) trait Poison {
    fn poison(&mut self);
}

#[cfg(test)]
impl Poison for f64 {
    fn poison(&mut self) {
        *self = f64::NAN;
    }
}

#[cfg(test)]
impl Poison for i32 {
    fn poison(&mut self) {
        *self = Self::MAX;
    }
}

#[cfg(test)]
impl<T: Poison, const N: usize> Poison for [T; N] {
    fn poison(&mut self) {
        self.iter_mut().for_each(T::poison);
    }
}

#[cfg(test)]
impl<T: Poison> Poison for Vec<T> {
    fn poison(&mut self) {
        self.iter_mut().for_each(T::poison);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::spatial::IDENTITY;
    use crate::model::{Cone, Integrator, Solver};
    use crate::physics::arrays;
    use crate::physics::data::UNTURNED;
    use crate::{Data, Revision, step};

    impl Work {
        /// Fills every buffer of numbers with NaN.
        pub(crate) fn poison(&mut self) {
            self.crb.poison();
            self.axes.poison();
            self.dofs.poison();
            for vectors in [&mut self.acc, &mut self.body_force, &mut self.body_velocity] {
                vectors.poison();
            }
            for vector in [
                &mut self.fluid,
                &mut self.damper,
                &mut self.gravcomp,
                &mut self.moments.values,
                &mut self.ctrl,
                &mut self.tendon_sums,
                &mut self.act_sum,
                &mut self.act_start,
                &mut self.qh,
                &mut self.qh_diag_inv,
                &mut self.acc_sum,
                &mut self.vel_sum,
                &mut self.rates,
                &mut self.qpos_start,
                &mut self.qvel_start,
            ] {
                vector.poison();
            }
            self.way.poison();
            self.newton.poison();
            self.pgs.poison();
            self.implicit.poison();
            self.polytope.poison();
        }
    }

    /// Two chains, free bodies and balls of 1 to 10 degrees of freedom in contact, with everything
    /// that makes rows of constraints.
    const TEXT: &str = r#"<mujoco><option density="2" viscosity=".1"/><worldbody>
        <geom type="plane" size="5 5 1"/>
        <body pos="0 0 .3"><joint axis="0 1 0" damping=".1" frictionloss=".05"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".05"/>
          <site name="a" pos=".1 0 .1"/><body pos=".4 0 0"><joint name="j" axis="0 1 0" range="-60 60" damping=".2"/>
          <geom name="g" type="capsule" fromto="0 0 0 .3 0 0" size=".04"/><site name="s" pos=".3 0 0"/></body></body>
        <body pos="1 0 .15"><freejoint/><geom type="box" size=".1 .12 .14"/><body pos="0 0 .2"><joint type="ball" damping=".1"/>
          <geom size=".1" pos=".1 0 .1" fluidshape="ellipsoid"/></body></body>
        <body pos="1.02 .01 .6"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
        <body pos="-1 0 .12"><joint name="x" type="slide" axis="0 0 1" range="-.05 1"/><geom type="cylinder" size=".1 .1"/></body>
        </worldbody>
        <tendon><fixed name="t" limited="true" range="-.4 .4" frictionloss=".02"><joint joint="j" coef="1"/></fixed>
          <spatial name="u" stiffness="5" damping=".1"><site site="s"/><site site="a"/></spatial></tendon>
        <equality><joint joint1="x" joint2="j" polycoef="0 .1 0 0 0"/></equality>
        <actuator><motor joint="j" gear=".2"/><intvelocity tendon="u" kp="2"/></actuator>
        <sensor><accelerometer site="s"/><touch site="s"/></sensor></mujoco>"#;

    /// The model with each solver, cone, integrator and version.
    fn models() -> Vec<Model> {
        let mut models = Vec::new();
        for revision in Revision::ALL {
            let model = Model::from_xml_with(TEXT, revision).unwrap();
            for solver in [Solver::Newton, Solver::CG, Solver::PGS] {
                for cone in [Cone::Pyramidal, Cone::Elliptic] {
                    for (i, integrator) in [
                        Integrator::Euler,
                        Integrator::RK4,
                        Integrator::Implicit,
                        Integrator::ImplicitFast,
                    ]
                    .into_iter()
                    .enumerate()
                    {
                        let mut compiled = crate::CompiledModel::clone(&model);
                        (compiled.opt.solver, compiled.opt.cone) = (solver, cone);
                        (compiled.opt.integrator, compiled.opt.noslip_iterations) =
                            (integrator, i % 2 * 3);
                        models.push(Model::new(compiled).unwrap());
                    }
                }
            }
        }
        models
    }

    fn bits(d: &Data) -> Vec<u64> {
        let vectors = [
            &d.qpos,
            &d.qvel,
            &d.qacc,
            &d.act,
            &d.sensordata,
            &d.efc.force,
        ];
        let numbers = vectors.into_iter().flatten();
        numbers.map(|x| x.to_bits()).collect()
    }

    fn advance(m: &Model, d: &mut Data, i: usize) {
        d.ctrl.fill((7 * i % 11) as f64 / 5.0 - 1.0);
        step(m, d);
    }

    fn poison<T: Poison>(array: &mut [T], _length: usize, _value: T) {
        array.iter_mut().for_each(T::poison);
    }

    /// No value passes from one call to the next, or from one episode to the next.
    #[test]
    fn buffers_may_hold_anything() {
        for m in models() {
            let (mut fresh, mut used, mut poisoned) = (Data::new(&m), Data::new(&m), Data::new(&m));
            (0..7).for_each(|i| advance(&m, &mut used, i));
            let d = &mut used;
            arrays!(d, m, poison);
            d.energy.poison();
            d.work.poison();
            d.reset(&m);
            for i in 0..60 {
                poisoned.work.poison();
                for d in [&mut fresh, &mut used, &mut poisoned] {
                    advance(&m, d, i);
                }
                let o = &m.opt;
                let which = format!(
                    "{} {:?} {:?} {:?} {i}",
                    m.revision, o.solver, o.cone, o.integrator
                );
                assert!(fresh.qacc.iter().all(|x| x.is_finite()), "{which}");
                assert_eq!(bits(&fresh), bits(&used), "{which}");
                assert_eq!(bits(&fresh), bits(&poisoned), "{which}");
            }
            assert!(fresh.efc.nefc() > 3);
        }
    }

    /// A model that diverges leaves numbers in buffers that are not finite.
    #[test]
    fn an_episode_that_diverged_leaves_nothing_behind() {
        let absurd = [
            ("", r#"impratio="1e300" cone="elliptic""#),
            (r#"solref="-1e200 -1""#, r#"integrator="RK4""#),
        ];
        for (softness, option) in absurd {
            for solver in ["Newton", "CG", "PGS"] {
                let text = TEXT.replace(r#"type="plane""#, &format!(r#"type="plane" {softness}"#));
                let text =
                    text.replace("<option", &format!(r#"<option solver="{solver}" {option}"#));
                let m = Model::from_xml(&text).unwrap();
                let mut used = Data::new(&m);
                (0..100).for_each(|i| advance(&m, &mut used, i));
                used.reset(&m);
                let mut fresh = Data::new(&m);
                for i in 0..20 {
                    for d in [&mut fresh, &mut used] {
                        advance(&m, d, i);
                    }
                    assert_eq!(bits(&fresh), bits(&used), "{option} {solver} {i}");
                }
            }
        }
    }
}
