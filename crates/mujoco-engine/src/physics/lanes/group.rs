//! Worlds that are owned one by one, and step together.

use std::sync::Arc;

use fearless_simd::Level;

use super::{Batch, Stride, WORLDS, actuators, fits, record_len, width};
use crate::physics::{forward, fwd_actuation};
use crate::{Data, Model};

/// Worlds of one model that take their next step together, while each has an owner and a [`Data`]
/// of its own.
///
/// An owner [adds](Self::add) its world with the controls of the next step; [`step`](Self::step)
/// steps all worlds that were added; an owner [collects](Self::collect) the result, and takes it
/// over with [`Data::catch_up`] in place of a step. All bits are those of worlds that step one by
/// one. Some worlds must step one by one: those of models with features that lanes lack, those that
/// diverge, those with applied forces, and a small remainder.
#[derive(Clone, Debug)]
pub struct Group {
    model: Arc<Model>,
    stride: Stride,
    level: Level,
    /// The length of a world's record.
    length: usize,
    /// `None` if worlds of this model cannot step together.
    batch: Option<Box<Batch>>,
    /// Data that computes the actuator forces of a control.
    data: Data,
    /// The records of the worlds: the input of a step, later its output.
    records: Vec<f64>,
    /// The number of worlds that wait for the step.
    len: usize,
    /// Whether each world has stepped.
    stepped: Vec<bool>,
    /// The [key](Batch::likeness) of each world in its last step.
    keys: Vec<(u64, usize)>,
    order: Vec<usize>,
}

impl Group {
    /// Whether a CPU with the vector instructions of `level` steps worlds together.
    #[must_use]
    pub fn can_step(level: Level) -> bool {
        width(level).is_some()
    }

    /// Allocates a group of at most `most` worlds, which step with the vector instructions of
    /// `level`. It stays empty if worlds of this model cannot step together.
    #[must_use]
    pub fn new(model: &Arc<Model>, stride: &Stride, level: Level, most: usize) -> Self {
        let length = record_len(model, &stride.reads);
        let fits = fits(model, stride) && Self::can_step(level);
        let worlds = if fits { most } else { 0 };
        let mut data = Data::default();
        if fits {
            data = Data::new(model);
            // computes the tendons' moment arms, which are constant
            forward(model, &mut data);
            // the stages of the lanes add the part of the forces that depends on positions
            data.actuator_length.fill(0.0);
            data.actuator_velocity.fill(0.0);
        }
        Self {
            model: Arc::clone(model),
            stride: stride.clone(),
            level,
            length,
            batch: fits.then(|| Box::new(Batch::new(model, stride))),
            data,
            records: vec![0.0; worlds * length],
            len: 0,
            stepped: vec![false; worlds],
            keys: vec![(0, 0); worlds],
            order: Vec::with_capacity(worlds),
        }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The kind of step.
    #[must_use]
    pub fn stride(&self) -> &Stride {
        &self.stride
    }

    /// The number of worlds that were added.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no world was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes the worlds that were added.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a world: its model, which is the group's or [differs](super::differ_in_stiffness) from it
    /// in the stiffness of joints alone; its state; and the controls of its next step, which must be
    /// finite numbers. Returns its index; `None` if the world steps alone.
    pub fn add(
        &mut self,
        model: &Model,
        data: &Data,
        controls: impl IntoIterator<Item = f64>,
    ) -> Option<usize> {
        let world = self.len;
        if world == self.stepped.len() || data.is_pushed() {
            return None;
        }
        let (m, own) = (&*self.model, &mut self.data);
        for (ctrl, a) in own.ctrl.iter_mut().zip(controls) {
            *ctrl = a;
        }
        fwd_actuation(m, own);
        let length = self.length;
        let parts = [
            &data.qpos[..],
            &data.qvel,
            &data.qacc_warmstart,
            &own.qfrc_actuator,
            data.mocap_pos.as_flattened(),
            data.mocap_quat.as_flattened(),
            &own.actuator_force[..actuators::inputs(m)],
        ];
        let mut record = self.records[world * length..][..length].iter_mut();
        for part in parts {
            for (from, to) in part.iter().zip(&mut record) {
                *to = *from;
            }
        }
        for (&j, to) in m.plan().springs.iter().zip(&mut record) {
            *to = model.jnt_stiffness[j];
        }
        self.len += 1;
        Some(world)
    }

    /// Steps the worlds that were added.
    pub fn step(&mut self) {
        let (Some(batch), Some(width)) = (&mut self.batch, width(self.level)) else {
            return;
        };
        let (length, keys) = (self.length, &mut self.keys);
        self.stepped[..self.len].fill(false);
        // worlds with the same islands solve together, and the solver's time depends on the largest
        // number of rows in a register
        self.order.clear();
        self.order.extend(0..self.len);
        self.order
            .sort_unstable_by_key(|&world| (keys[world], world));
        for order in self.order.chunks(WORLDS) {
            // if the remaining worlds fill less than half a register, stepping them one by one is
            // faster
            let rest = order.len() % width;
            let few = 2 * rest < width;
            let order = &order[..order.len() - if few { rest } else { 0 }];
            for (lane, &world) in order.iter().enumerate() {
                batch.gather(lane, &self.records[world * length..][..length]);
            }
            let steps = self.stride.steps;
            if order.is_empty() || !batch.step(&self.model, self.level, order.len(), steps) {
                continue;
            }
            for (lane, &world) in order.iter().enumerate() {
                let record = &mut self.records[world * length..][..length];
                let reads = &self.stride.reads;
                self.stepped[world] = batch.scatter(&self.model, lane, reads, record);
                keys[world] = batch.likeness(lane);
            }
        }
    }

    /// Sets the number of timesteps of the next step.
    pub(super) fn set_steps(&mut self, timesteps: usize) {
        self.stride.steps = timesteps;
    }

    /// The record of a world that stepped: its state, its state at the start of the last timestep,
    /// and the derived arrays. `None` if the world must step alone.
    pub(super) fn result(&self, world: usize) -> Option<&[f64]> {
        let record = || &self.records[world * self.length..][..self.length];
        self.stepped[world].then(record)
    }

    /// Writes the result of a world's step to `data`, if the world has stepped;
    /// [`Data::catch_up`] then takes it over.
    pub fn collect(&self, world: usize, data: &mut Data) {
        if let Some(record) = self.result(world) {
            data.store_result(record);
        }
    }
}
