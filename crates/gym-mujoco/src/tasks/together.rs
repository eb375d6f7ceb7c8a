//! Worlds of several environments that step together.

use std::sync::Arc;

use fearless_simd::Level;
use gym_core::Array;
use gym_core::vector::lockstep::Together;

use super::Simulation;
use crate::physics::lanes::Derived;
use crate::physics::{fwd_actuation, lanes};
use crate::{Data, Model};

/// The most models of which worlds step together; environments of others step one by one.
const MODELS: usize = 4;

/// Working memory for environments that step together.
///
/// Only worlds of one model can: environments share a built-in model, and each has its own of a
/// file. Worlds with features that the stages for several worlds do not have, those that diverge,
/// and a rest of few step one by one, with the same bits.
#[derive(Clone, Debug)]
pub struct Worlds {
    level: Level,
    crews: Vec<Crew>,
}

/// The worlds of one model.
#[derive(Clone, Debug)]
struct Crew {
    model: Arc<Model>,
    steps: usize,
    reads: Vec<Derived>,
    /// The numbers of a world's record.
    length: usize,
    /// None for a model that does not fit.
    worlds: Option<Box<lanes::Worlds>>,
    /// For the forces of actuators.
    data: Data,
    /// What each world brings and takes away.
    records: Vec<f64>,
    /// The number of worlds that have begun.
    len: usize,
    /// Which of them have stepped.
    stepped: Vec<bool>,
}

/// A world in a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    crew: usize,
    world: usize,
}

impl Default for Worlds {
    fn default() -> Self {
        Self::new(Level::new())
    }
}

impl Worlds {
    pub(super) fn new(level: Level) -> Self {
        Self {
            level,
            crews: Vec::with_capacity(MODELS),
        }
    }

    /// Takes the state of a world, and the action of its next step. None if it steps by itself.
    pub(super) fn begin(
        &mut self,
        simulation: &Simulation,
        data: &Data,
        action: &Array,
    ) -> Option<Place> {
        let reads = simulation.reads.as_ref()?;
        lanes::width(self.level)?;
        let (model, steps) = (&simulation.model, simulation.frame_skip);
        let known = self
            .crews
            .iter()
            .position(|crew| Arc::ptr_eq(&crew.model, model) && crew.steps == steps);
        let crew = match known {
            Some(crew) => crew,
            None if self.crews.len() < MODELS => {
                self.crews.push(Crew::new(model, steps, reads));
                self.crews.len() - 1
            }
            None => return None,
        };
        let world = self.crews[crew].begin(data, action)?;
        Some(Place { crew, world })
    }

    /// Gives a world the result of its step.
    pub(super) fn collect(&self, place: Place, data: &mut Data) {
        let crew = &self.crews[place.crew];
        if crew.stepped[place.world] {
            let length = crew.length;
            data.look_ahead(&crew.records[place.world * length..][..length]);
        }
    }
}

impl Together for Worlds {
    const LEN: usize = 64;

    fn solve(&mut self) {
        for crew in &mut self.crews {
            crew.solve(self.level);
        }
    }

    fn clear(&mut self) {
        // models that no environment has any more
        self.crews
            .retain(|crew| crew.len > 0 || Arc::strong_count(&crew.model) > 1);
        self.crews.iter_mut().for_each(|crew| crew.len = 0);
    }
}

impl Crew {
    fn new(model: &Arc<Model>, steps: usize, reads: &[Derived]) -> Self {
        let length = lanes::record_len(model, reads);
        let fits = lanes::fits(model);
        let worlds = if fits { Worlds::LEN } else { 0 };
        Self {
            model: Arc::clone(model),
            steps,
            reads: reads.to_vec(),
            length,
            worlds: fits.then(|| Box::new(lanes::Worlds::new(model))),
            data: if fits {
                Data::new(model)
            } else {
                Data::default()
            },
            records: vec![0.0; worlds * length],
            len: 0,
            stepped: vec![false; worlds],
        }
    }

    fn begin(&mut self, data: &Data, action: &Array) -> Option<usize> {
        let world = self.len;
        if world == self.stepped.len() {
            return None;
        }
        let (m, own) = (&*self.model, &mut self.data);
        for (ctrl, a) in own.ctrl.iter_mut().zip(action.iter_f64()) {
            *ctrl = a;
        }
        fwd_actuation(m, own);
        let length = self.length;
        let parts = [
            &data.qpos,
            &data.qvel,
            &data.qacc_warmstart,
            &own.qfrc_actuator,
        ];
        let record = &mut self.records[world * length..][..length];
        for (to, from) in record.iter_mut().zip(parts.into_iter().flatten()) {
            *to = *from;
        }
        self.len += 1;
        Some(world)
    }

    fn solve(&mut self, level: Level) {
        let (Some(worlds), Some(width)) = (&mut self.worlds, lanes::width(level)) else {
            return;
        };
        let length = self.length;
        self.stepped[..self.len].fill(false);
        let records = self.records[..self.len * length].chunks_mut(length * lanes::WORLDS);
        for (records, stepped) in records.zip(self.stepped.chunks_mut(lanes::WORLDS)) {
            // a rest that fills less than half a register is faster one by one
            let len = records.len() / length;
            let rest = len % width;
            let len = if 2 * rest < width { len - rest } else { len };
            let records = &mut records[..len * length];
            for (world, record) in records.chunks(length).enumerate() {
                worlds.gather(world, record);
            }
            if len == 0 || !worlds.step(&self.model, level, len, self.steps) {
                continue;
            }
            let records = records.chunks_mut(length).zip(stepped);
            for (world, (record, stepped)) in records.enumerate() {
                *stepped = worlds.scatter(&self.model, world, &self.reads, record);
            }
        }
    }
}
