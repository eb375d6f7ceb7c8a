//! MiniGrid's tasks: a module for each.

pub mod blocked_unlock_pickup;
pub mod crossing;
pub mod dist_shift;
pub mod door_key;
pub mod dynamic_obstacles;
pub mod empty;
pub mod fetch;
pub mod four_rooms;
pub mod go_to_door;
pub mod go_to_object;
pub mod key_corridor;
pub mod lava_gap;
pub mod locked_room;
pub mod memory;
pub mod multi_room;
pub mod obstructed_maze;
pub mod playground;
pub mod put_near;
pub mod red_blue_doors;
pub mod unlock;
pub mod unlock_pickup;

use gym_core::Outcome;
use gym_core::registry::Exceptions;

use crate::draft::Area;
use crate::{Action, Cell, Color, Draft, Generated, Kind, Pos, World};

/// Returns the square of `size`; the largest number if it overflows.
pub(crate) fn square(size: u32) -> u32 {
    size.saturating_mul(size)
}

/// Checks the argument `agent_start_dir`.
pub(crate) fn direction(direction: u32) -> Result<u8, String> {
    match direction {
        0..=3 => Ok(direction as u8),
        _ => Err(format!(
            "agent_start_dir is {direction}: it is 0 (right), 1 (down), 2 (left) or 3 (up)"
        )),
    }
}

/// The conformance exceptions of levels with an argument `agent_start_dir`.
pub(crate) const DIRECTION: Exceptions = &[
    crate::env::WINDOW,
    (
        "arguments-matter.agent_start_dir",
        "it counts where `agent_start_pos` is given",
    ),
];

/// Registers the ids of a level, each with its arguments. With `planned`, the planner is the good
/// policy of the ids; `excused` lists their conformance exceptions, and `named` the actions of a
/// level that does not have all seven.
macro_rules! ids {
    ($level:ty, $sentence:literal: $($ids:tt)+) => {
        ids! { @($level, $sentence, None) [] $($ids)+ }
    };
    ($level:ty, $sentence:literal, planned: $($ids:tt)+) => {
        ids! { @($level, $sentence, Some($crate::planner::POLICY)) [] $($ids)+ }
    };
    ($level:ty, $sentence:literal, excused $exceptions:ident: $($ids:tt)+) => {
        ids! { @($level, $sentence, None) [.exceptions($exceptions)] $($ids)+ }
    };
    ($level:ty, $sentence:literal, excused $exceptions:ident, named $actions:ident: $($ids:tt)+) => {
        ids! { @($level, $sentence, None) [.exceptions($exceptions).actions($actions)] $($ids)+ }
    };
    ($level:ty, $sentence:literal, planned, excused $exceptions:ident: $($ids:tt)+) => {
        ids! { @($level, $sentence, Some($crate::planner::POLICY)) [.exceptions($exceptions)] $($ids)+ }
    };
    (@$facts:tt $more:tt $($id:literal, $kwargs:literal;)+) => {
        gym_core::register!($(ids! { @one $facts $more $id, $kwargs }),+);
    };
    (@one ($level:ty, $sentence:literal, $policy:expr) [$($more:tt)*] $id:literal, $kwargs:literal) => {
        $crate::env::register::<$level>($id, $sentence, $policy).kwargs($kwargs)$($more)*
    };
}
pub(crate) use ids;

/// Returns the words for `kinds`.
pub(crate) fn names(kinds: &[Kind]) -> Vec<&'static str> {
    kinds.iter().map(|kind| kind.name()).collect()
}

/// Returns the words for a cell, such as `blue ball`.
pub(crate) fn describe(cell: Cell) -> String {
    format!("{} {}", cell.color().name(), cell.kind().name())
}

/// Whether two cells have the same kind and colour.
pub(crate) fn is_alike(a: Cell, b: Cell) -> bool {
    (a.kind(), a.color()) == (b.kind(), b.color())
}

/// Draws a position inside the walls of a room.
pub(crate) fn inside(draft: &mut Draft<'_>, room: Area) -> Generated<Pos> {
    let end = room.top + room.size - Pos::new(1, 1);
    let x = draft.int(room.top.x + 1, end.x)?;
    Ok(Pos::new(x, draft.int(room.top.y + 1, end.y)?))
}

/// Takes a step of a task that terminates when the agent picks up the first target.
pub(crate) fn pick_up(world: &mut World, action: Action) -> Outcome {
    let mut outcome = world.step(action);
    if action == Action::Pickup && world.carrying == world.target(0) {
        outcome.reward = world.reward();
        outcome.terminated = true;
    }
    outcome
}

/// Places objects of distinct kinds and colours at random positions for which `accept` returns
/// true. Returns the objects with their positions.
pub(crate) fn distinct_objects(
    draft: &mut Draft<'_>,
    count: u32,
    accept: impl Fn(&[(Cell, Pos)], Pos) -> bool,
) -> Generated<Vec<(Cell, Pos)>> {
    let mut objects: Vec<(Cell, Pos)> = Vec::new();
    while objects.len() < count as usize {
        let kind = draft.pick(&crate::rooms::KINDS)?;
        let color = draft.pick(&Color::SORTED)?;
        if objects
            .iter()
            .any(|(cell, _)| (cell.kind(), cell.color()) == (kind, color))
        {
            continue;
        }
        let cell = draft.object(kind, color);
        let pos = draft.place_if(cell, draft.whole(), u32::MAX, |_, pos| {
            accept(&objects, pos)
        })?;
        objects.push((cell, pos));
    }
    Ok(objects)
}
