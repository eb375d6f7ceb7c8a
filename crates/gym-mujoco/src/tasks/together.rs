//! Groups of environments whose worlds step together.

use std::sync::Arc;

use fearless_simd::Level;
use gym_core::vector::lockstep::Together;
use gym_core::{Array, math};

use crate::lanes::{Group, Stride};
use crate::{Data, Model};

/// The largest number of models with groups; environments of further models step one by one.
const MODELS: usize = 4;

/// Working memory for environments that step together: a group of worlds for each model.
///
/// Only worlds of the same model step together: environments share a built-in model, but each loads
/// its own from a file.
#[derive(Clone, Debug)]
pub struct Worlds {
    level: Level,
    groups: Vec<Group>,
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
        Group::can_step(math::level())
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
        if !Group::can_step(self.level) {
            return None;
        }
        let known = self.groups.iter().position(|group| {
            Arc::ptr_eq(group.model(), model) && group.stride().steps == stride.steps
        });
        let group = match known {
            Some(group) => group,
            // no other environment uses this model
            None if Arc::strong_count(model) == 1 => return None,
            None if self.groups.len() < MODELS => {
                let group = Group::new(model, stride, self.level, Self::LEN);
                self.groups.push(group);
                self.groups.len() - 1
            }
            None => return None,
        };
        let world = self.groups[group].add(data, action.iter_f64())?;
        Some(Place { group, world })
    }

    /// Writes the result of a world's step to `data`; [`Data::catch_up`] then takes it over.
    pub fn collect(&self, place: Place, data: &mut Data) {
        self.groups[place.group].collect(place.world, data);
    }
}

impl Together for Worlds {
    const LEN: usize = 64;

    fn solve(&mut self) {
        self.groups.iter_mut().for_each(Group::step);
    }

    fn clear(&mut self) {
        // drop the groups of models that no environment uses any more
        self.groups
            .retain(|group| !group.is_empty() || Arc::strong_count(group.model()) > 1);
        self.groups.iter_mut().for_each(Group::clear);
    }
}

#[cfg(test)]
mod tests {
    use gym_core::vector::lockstep::Lockstep;
    use gym_core::{Element, Env, EnvExt};

    use super::*;
    use crate::tasks::{HalfCheetah, MujocoEnv, Task, half_cheetah};

    fn is_behind<T: Task>(env: &MujocoEnv<T>) -> bool {
        env.episode_data().is_some_and(Data::is_behind)
    }

    fn levels() -> Vec<Level> {
        let level = math::level();
        let mut levels = vec![level, Level::baseline()];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        levels.extend(level.as_avx2().map(Level::Avx2));
        levels
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
                let expected = if Group::can_step(level) { 8 } else { 0 };
                assert_eq!(together, expected, "{level:?}");
            }
        }
    }
}
