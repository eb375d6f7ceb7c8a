//! Many worlds of one model, with their states in columns.

use std::sync::Arc;

use fearless_simd::Level;

use super::{Derived, Group, Stride};
use crate::physics::{rne_post_constraint, step, substep};
use crate::{Data, Model};

/// The largest number of worlds in a group.
const GROUP: usize = 64;

/// Many worlds of one model that step at once.
///
/// States are columns: world `w` has the positions `qpos[w * nq..(w + 1) * nq]`, and so on. Write
/// them at will; a step starts from what is there. Several worlds share the vector registers of the
/// CPU where the model allows it, and all bits are those of worlds that step one by one with
/// [`step()`].
///
/// ```
/// use std::sync::Arc;
///
/// use mujoco_engine::lanes::{Derived, Worlds};
/// use mujoco_engine::{Model, Result};
///
/// # fn main() -> Result<()> {
/// let arm = r#"<mujoco>
///   <worldbody>
///     <body><joint name="hinge" axis="0 1 0"/><geom size="0.1" pos="0.5 0 0"/></body>
///   </worldbody>
///   <actuator><motor joint="hinge"/></actuator></mujoco>"#;
/// let model = Arc::new(Model::from_xml(arm)?);
/// let mut worlds = Worlds::new(&model, 64, &[Derived::Xipos]);
/// for (world, ctrl) in worlds.ctrl.iter_mut().enumerate() {
///     *ctrl = world as f64;
/// }
/// worlds.step(10);
/// assert_eq!(worlds.qpos.len(), 64);
/// assert!(worlds.qpos[63] > worlds.qpos[0]);
/// let places = worlds.array(Derived::Xipos).expect("it was asked for");
/// assert_eq!(places.len(), 64 * 2 * 3); // of the world's body and the arm
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Worlds {
    /// The time of each world, in seconds.
    pub time: Box<[f64]>,
    /// Positions (nq of each world).
    pub qpos: Box<[f64]>,
    /// Velocities (nv of each world).
    pub qvel: Box<[f64]>,
    /// Activations of the actuators (na of each world).
    pub act: Box<[f64]>,
    /// Controls of the next step (nu of each world).
    pub ctrl: Box<[f64]>,
    /// The solver's starting points (nv of each world).
    pub qacc_warmstart: Box<[f64]>,
    model: Arc<Model>,
    reads: Vec<Derived>,
    /// The columns of `reads`.
    arrays: Vec<Box<[f64]>>,
    group: Group,
    /// The index of each world of a group, if it steps together with others.
    members: Vec<Option<usize>>,
    /// Data that steps one world.
    data: Data,
}

impl Worlds {
    /// Allocates `len` worlds in the model's initial state. `reads` are the derived arrays that
    /// [`array`](Self::array) gives after a step.
    #[must_use]
    pub fn new(model: &Arc<Model>, len: usize, reads: &[Derived]) -> Self {
        Self::with_level(model, len, reads, Level::new())
    }

    /// [`new`](Self::new) with the vector instructions of `level`.
    #[must_use]
    pub fn with_level(model: &Arc<Model>, len: usize, reads: &[Derived], level: Level) -> Self {
        let m = &**model;
        let data = Data::new(m);
        let stride = Stride {
            steps: 1,
            settles: false,
            contact_forces: reads.contains(&Derived::CfrcExt),
            reads: reads.to_vec(),
        };
        let zeros = |numbers: usize| vec![0.0; len * numbers].into_boxed_slice();
        let is_known = reads.iter().all(|array| array.is_known(m));
        let most = if is_known { len.min(GROUP) } else { 0 };
        Self {
            time: zeros(1),
            qpos: data.qpos.repeat(len).into_boxed_slice(),
            qvel: zeros(m.nv()),
            act: zeros(m.na()),
            ctrl: zeros(m.nu()),
            qacc_warmstart: zeros(m.nv()),
            reads: reads.to_vec(),
            arrays: reads.iter().map(|array| zeros(array.len(m))).collect(),
            group: Group::new(model, &stride, level, most),
            members: vec![None; len.min(GROUP)],
            model: Arc::clone(model),
            data,
        }
    }

    /// The number of worlds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no world.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// A derived array of all worlds, as the last step left it: that of the start of its last
    /// timestep, as in [`Data`]. `None` if [`new`](Self::new) was not asked for it.
    #[must_use]
    pub fn array(&self, array: Derived) -> Option<&[f64]> {
        let index = self.reads.iter().position(|known| *known == array)?;
        Some(&self.arrays[index])
    }

    /// Resets a world to the model's initial state.
    ///
    /// # Panics
    /// If there is no such world.
    pub fn reset(&mut self, world: usize) {
        self.data.reset(&self.model);
        self.data.ctrl.fill(0.0);
        self.save(world);
    }

    /// Advances each world by some timesteps.
    ///
    /// # Panics
    /// If a column was replaced by one of another length.
    pub fn step(&mut self, timesteps: usize) {
        if timesteps == 0 {
            return;
        }
        self.group.set_steps(timesteps);
        for first in (0..self.len()).step_by(GROUP) {
            let worlds = first..self.len().min(first + GROUP);
            self.group.clear();
            for world in worlds.clone() {
                self.load(world);
                let finite = self.data.ctrl.iter().all(|x| x.is_finite());
                let data = &self.data;
                self.members[world - first] = match finite {
                    true => self.group.add(&self.model, data, data.ctrl.iter().copied()),
                    false => None,
                };
            }
            self.group.step();
            for world in worlds {
                let member = self.members[world - first];
                if !member.is_some_and(|member| self.take(world, member, timesteps)) {
                    self.step_alone(world, timesteps);
                }
            }
        }
    }

    /// Copies the result of a world that stepped with others to its columns; false if there is
    /// none.
    fn take(&mut self, world: usize, member: usize, timesteps: usize) -> bool {
        let Some(record) = self.group.result(member) else {
            return false;
        };
        let (nq, nv) = (self.model.nq(), self.model.nv());
        let (qpos, rest) = record.split_at(nq);
        let (qvel, rest) = rest.split_at(nv);
        let (warm, rest) = rest.split_at(nv);
        self.qpos[world * nq..][..nq].copy_from_slice(qpos);
        self.qvel[world * nv..][..nv].copy_from_slice(qvel);
        self.qacc_warmstart[world * nv..][..nv].copy_from_slice(warm);
        // the state at the start of the last timestep comes next
        let mut derived = &rest[nq + 2 * nv..];
        for (array, column) in self.reads.iter().zip(&mut self.arrays) {
            let (own, others) = derived.split_at(array.len(&self.model));
            column[world * own.len()..][..own.len()].copy_from_slice(own);
            derived = others;
        }
        for _ in 0..timesteps {
            self.time[world] += self.model.opt.timestep;
        }
        true
    }

    fn step_alone(&mut self, world: usize, timesteps: usize) {
        self.load(world);
        let (m, data) = (&*self.model, &mut self.data);
        for _ in 1..timesteps {
            substep(m, data);
        }
        step(m, data);
        if self.group.stride().contact_forces {
            rne_post_constraint(m, data);
        }
        for (array, column) in self.reads.iter().zip(&mut self.arrays) {
            let own = array.of_data(data);
            column[world * own.len()..][..own.len()].copy_from_slice(own);
        }
        self.save(world);
    }

    /// Copies a world to `data`.
    fn load(&mut self, world: usize) {
        let d = &mut self.data;
        d.time = self.time[world];
        for (to, column) in [
            (&mut d.qpos, &self.qpos),
            (&mut d.qvel, &self.qvel),
            (&mut d.act, &self.act),
            (&mut d.ctrl, &self.ctrl),
            (&mut d.qacc_warmstart, &self.qacc_warmstart),
        ] {
            let n = to.len();
            to.copy_from_slice(&column[world * n..][..n]);
        }
    }

    /// Copies `data` to a world.
    fn save(&mut self, world: usize) {
        let d = &self.data;
        self.time[world] = d.time;
        for (from, column) in [
            (&d.qpos, &mut self.qpos),
            (&d.qvel, &mut self.qvel),
            (&d.act, &mut self.act),
            (&d.ctrl, &mut self.ctrl),
            (&d.qacc_warmstart, &mut self.qacc_warmstart),
        ] {
            let n = from.len();
            column[world * n..][..n].copy_from_slice(from);
        }
    }
}
