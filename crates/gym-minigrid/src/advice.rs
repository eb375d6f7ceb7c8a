//! What helps if no level fits the arguments: found by trial, for levels of any kind.

use std::sync::Arc;

use gym_core::{Arguments, Generator};
use serde_json::Value as Json;

use crate::draft::{Draft, Generated, GenerationError};
use crate::env::Facts;
use crate::level::{Level, View};
use crate::{Pos, World};

/// The seeds that are tried are those below this.
const SEEDS: u64 = 8;

/// How far from the value of an argument others are tried.
const FARTHEST: u64 = 24;

/// The number of random draws of an attempt, which is enough for a level that is likely.
const MAX_CHOICES: u32 = 20_000;

/// Reads a level from its arguments.
pub(crate) type Read = fn(Json) -> Option<Arc<dyn Level>>;

pub(crate) fn read<L: Level + Arguments>(arguments: Json) -> Option<Arc<dyn Level>> {
    let level: L = serde_json::from_value(arguments).ok()?;
    Some(Arc::new(level))
}

/// Generates a level.
pub(crate) fn generate(
    level: &dyn Level,
    facts: &Facts,
    rng: &mut Generator,
    max_choices: u32,
) -> Generated<World> {
    let rules = &facts.rules;
    let mut world = World::new(rules.width as i32, rules.height as i32, rules.max_steps);
    if rules.missions.words().is_empty() {
        world.mission.push_str(rules.missions.pattern());
    }
    level.generate(&mut Draft::new(&mut world, rng, max_choices))?;
    let Pos { x, y } = world.agent;
    if !world.grid.contains(world.agent) || !world.grid.get(world.agent).can_overlap() {
        let reason = format!("the agent starts at {:?}, which is not free", [x, y]);
        return Err(GenerationError::Impossible(reason));
    }
    Ok(world)
}

/// For how many of the seeds there is a level.
fn possible(level: &dyn Level) -> usize {
    let Ok(facts) = Facts::new(level) else {
        return 0;
    };
    let is_possible = |seed: &u64| {
        let rng = &mut Generator::from(*seed);
        generate(level, &facts, rng, MAX_CHOICES).is_ok()
    };
    (0..SEEDS).filter(is_possible).count()
}

/// What to change so that there is a level: the seed, if that helps, or the nearest value of each
/// argument that does.
pub(crate) fn advice(level: &dyn Level, read: Read, arguments: &Json) -> Option<String> {
    if possible(level) > 0 {
        return Some("reset with another seed".to_owned());
    }
    let shared = serde_json::to_value(View::default()).ok()?;
    let mut found = Vec::new();
    for (name, value) in arguments.as_object()? {
        let (Some(value), None) = (value.as_u64(), shared.get(name)) else {
            continue;
        };
        let helps = |other: &u64| {
            let mut arguments = arguments.clone();
            arguments[name] = (*other).into();
            read(arguments).is_some_and(|level| possible(&*level) == SEEDS as usize)
        };
        if let Some(least) = (value + 1..=value + FARTHEST).find(helps) {
            found.push(format!("`{name}` to {least}"));
        } else if let Some(most) = (value.saturating_sub(FARTHEST)..value).rev().find(helps) {
            found.push(format!("`{name}` to {most}"));
        }
    }
    match found.is_empty() {
        true => None,
        false => Some(format!("set {}", found.join(", or "))),
    }
}
