//! Groups of environments whose worlds step together.

use std::sync::Arc;

use fearless_simd::Level;
use gym_core::vector::lockstep::Together;
use gym_core::{Array, math};

use mujoco_engine::Data;
use mujoco_engine::lanes::Group;

use crate::simulation::Simulation;

/// The largest number of models with groups; environments of further models step one by one.
const MODELS: usize = 4;

/// Working memory for environments that step together: a group of worlds for each model.
///
/// Only worlds of the same model step together, or of models that differ in the stiffness of joints:
/// environments share a built-in model, but each loads its own from a file.
#[derive(Clone, Debug)]
pub struct Groups {
    level: Level,
    groups: Vec<Group>,
}

/// A world in a group.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    group: usize,
    world: usize,
}

impl Default for Groups {
    fn default() -> Self {
        Self::new(math::level())
    }
}

impl Groups {
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
        simulation: &Simulation,
        data: &Data,
        action: &Array,
    ) -> Option<Member> {
        if !Group::can_step(self.level) {
            return None;
        }
        let (model, stride) = (simulation.shared(), simulation.stride.as_ref()?);
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
        let world = self.groups[group].add(&simulation.model, data, action.iter_f64())?;
        Some(Member { group, world })
    }

    /// Writes the result of a world's step to `data`; [`Data::catch_up`] then takes it over.
    pub fn collect(&self, member: Member, data: &mut Data) {
        self.groups[member.group].collect(member.world, data);
    }
}

impl Together for Groups {
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
