//! Groups of environments whose worlds step together.

use std::sync::Arc;

use fearless_simd::Level;
use gym_core::vector::lockstep::Together;
use gym_core::{Array, math};

use crate::physics::lanes::Stride;
use crate::physics::{forward, fwd_actuation, lanes};
use crate::{Data, Model};

/// The largest number of models with groups; environments of further models step one by one.
const MODELS: usize = 4;

/// Working memory for environments that step together.
///
/// Only worlds of the same model step together: environments share a built-in model, but each loads
/// its own from a file. Three kinds of worlds step one by one, with the same bits: those of models
/// with features that the lane stages lack, those that diverge, and a small remainder.
#[derive(Clone, Debug)]
pub struct Worlds {
    level: Level,
    groups: Vec<Group>,
}

/// The worlds of one model.
#[derive(Clone, Debug)]
struct Group {
    model: Arc<Model>,
    stride: Stride,
    /// The length of a world's record.
    length: usize,
    /// `None` if worlds of this model cannot step together.
    worlds: Option<Box<lanes::Worlds>>,
    /// Data that computes the actuator forces of a control.
    data: Data,
    /// The records of the worlds: the input of a step, later its output.
    records: Vec<f64>,
    /// The number of worlds that wait for the step.
    len: usize,
    /// Whether each world has stepped.
    stepped: Vec<bool>,
    /// The number of constraint rows of each world in its last step.
    rows: Vec<usize>,
    order: Vec<usize>,
}

/// A world in a group.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    group: usize,
    world: usize,
}

impl Default for Worlds {
    fn default() -> Self {
        Self::new(math::level())
    }
}

impl Worlds {
    /// Groups that step with the vector instructions of `level`.
    #[must_use]
    pub fn new(level: Level) -> Self {
        Self {
            level,
            groups: Vec::with_capacity(MODELS),
        }
    }

    /// Whether this CPU steps worlds together.
    #[must_use]
    pub fn can_step() -> bool {
        lanes::width(math::level()).is_some()
    }

    /// Adds a world to a group: its state, and the action of its next step, which must have one
    /// finite number for each control. `None` if the world steps alone.
    pub fn begin(
        &mut self,
        model: &Arc<Model>,
        stride: &Stride,
        data: &Data,
        action: &Array,
    ) -> Option<Place> {
        lanes::width(self.level)?;
        let known = self.groups.iter().position(|group| {
            Arc::ptr_eq(&group.model, model) && group.stride.steps == stride.steps
        });
        let group = match known {
            Some(group) => group,
            // no other environment uses this model
            None if Arc::strong_count(model) == 1 => return None,
            None if self.groups.len() < MODELS => {
                self.groups.push(Group::new(model, stride));
                self.groups.len() - 1
            }
            None => return None,
        };
        let world = self.groups[group].begin(data, action)?;
        Some(Place { group, world })
    }

    /// Writes the result of a world's step to `data`; [`Data::catch_up`] then takes it over.
    pub fn collect(&self, place: Place, data: &mut Data) {
        let group = &self.groups[place.group];
        if group.stepped[place.world] {
            let length = group.length;
            data.look_ahead(&group.records[place.world * length..][..length]);
        }
    }
}

impl Together for Worlds {
    const LEN: usize = 64;

    fn solve(&mut self) {
        for group in &mut self.groups {
            group.solve(self.level);
        }
    }

    fn clear(&mut self) {
        // drop the groups of models that no environment uses any more
        self.groups
            .retain(|group| group.len > 0 || Arc::strong_count(&group.model) > 1);
        self.groups.iter_mut().for_each(|group| group.len = 0);
    }
}

impl Group {
    fn new(model: &Arc<Model>, stride: &Stride) -> Self {
        let length = lanes::record_len(model, &stride.reads);
        let fits = lanes::fits(model, stride);
        let worlds = if fits { Worlds::LEN } else { 0 };
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
            length,
            worlds: fits.then(|| Box::new(lanes::Worlds::new(model, stride))),
            data,
            records: vec![0.0; worlds * length],
            len: 0,
            stepped: vec![false; worlds],
            rows: vec![0; worlds],
            order: Vec::with_capacity(worlds),
        }
    }

    fn begin(&mut self, data: &Data, action: &Array) -> Option<usize> {
        let world = self.len;
        if world == self.stepped.len() || data.is_pushed() {
            return None;
        }
        let (m, own) = (&*self.model, &mut self.data);
        for (ctrl, a) in own.ctrl.iter_mut().zip(action.iter_f64()) {
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
            &own.actuator_force,
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
        let (length, rows) = (self.length, &mut self.rows);
        self.stepped[..self.len].fill(false);
        // sort worlds by their number of rows: the solver's time depends on the largest number of
        // rows in a register
        self.order.clear();
        self.order.extend(0..self.len);
        self.order
            .sort_unstable_by_key(|&world| (rows[world], world));
        for order in self.order.chunks(lanes::WORLDS) {
            // if the remaining worlds fill less than half a register, stepping them one by one is
            // faster
            let rest = order.len() % width;
            let few = 2 * rest < width;
            let order = &order[..order.len() - if few { rest } else { 0 }];
            for (lane, &world) in order.iter().enumerate() {
                worlds.gather(lane, &self.records[world * length..][..length]);
            }
            if order.is_empty() || !worlds.step(&self.model, level, order.len(), self.stride.steps)
            {
                continue;
            }
            for (lane, &world) in order.iter().enumerate() {
                let record = &mut self.records[world * length..][..length];
                let reads = &self.stride.reads;
                self.stepped[world] = worlds.scatter(&self.model, lane, reads, record);
                rows[world] = worlds.rows(lane);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use gym_core::vector::lockstep::Lockstep;
    use gym_core::{Element, Env, EnvExt};

    use super::*;
    use crate::physics::lanes::tests::levels;
    use crate::tasks::{HalfCheetah, MujocoEnv, Task, half_cheetah};

    fn is_behind<T: Task>(env: &MujocoEnv<T>) -> bool {
        env.episode_data().is_some_and(Data::is_behind)
    }

    /// Of nine worlds, eight step together and one steps alone.
    #[test]
    fn whole_registers_step_together() {
        for level in levels() {
            let make = || HalfCheetah::new(half_cheetah::Config::default()).unwrap();
            let mut envs: Vec<HalfCheetah> = (0..9).map(|_| make()).collect();
            let mut alone = envs.clone();
            let mut worlds = Worlds::new(level);
            let mut seen = Array::empty();
            for (i, env) in envs.iter_mut().chain(&mut alone).enumerate() {
                env.reset_into(&(i as u64 % 9).into(), &mut seen).unwrap();
            }
            let mut sampler = envs[0].action_sampler(4).unwrap();
            for _ in 0..40 {
                let actions: Vec<Array> = (0..9).map(|_| sampler.sample().clone()).collect();
                worlds.clear();
                for (env, action) in envs.iter_mut().zip(&actions) {
                    env.begin_step(action, &mut worlds);
                }
                worlds.solve();
                let mut together = 0;
                for ((env, alone), action) in envs.iter_mut().zip(&mut alone).zip(&actions) {
                    env.collect(&mut worlds);
                    let outcome = env.step_into(action, &mut seen).unwrap();
                    let mut expected = Array::empty();
                    let other = alone.step_into(action, &mut expected).unwrap();
                    assert_eq!((outcome, &seen), (other, &expected), "{level:?}");
                    together += usize::from(is_behind(env));
                }
                let expected = lanes::width(level).map_or(0, |_| 8);
                assert_eq!(together, expected, "{level:?}");
            }
        }
    }
}
