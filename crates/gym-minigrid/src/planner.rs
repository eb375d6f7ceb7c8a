//! A policy that knows the whole grid, and takes the shortest path.

use std::collections::VecDeque;

use gym_core::policy::Controller;
use gym_core::{BoxEnv, Element, EnvExt, Policy};

use crate::babyai::Instr;
use crate::view::DIRECTIONS;
use crate::{Action, Cell, Facts, Kind, Pos, State, World};

/// Takes the shortest path to the goal or to the object of the instruction, and fetches keys on the
/// way.
pub(crate) const POLICY: Policy = Policy::rules(
    "knows the whole grid, and takes the shortest way, past lava and through doors",
    start,
);

fn start(env: &BoxEnv) -> Option<Controller> {
    env.layer::<Facts>()?;
    Some(Box::new(|env, _| {
        let action = next_action(env.layer::<World>()?);
        Some(action.unwrap_or(Action::Left).to_value())
    }))
}

/// Returns the next action on the path; `None` without a path.
pub(crate) fn next_action(world: &World) -> Option<Action> {
    let (is_target, action): (Box<dyn Fn(Pos, Cell) -> bool>, _) = match &world.instr {
        Some(Instr::GoTo(object)) => (
            Box::new(|pos, _| object.places.contains(&pos)),
            Action::Done,
        ),
        Some(Instr::Pickup { object, .. }) => (Box::new(|_, cell| object.is(cell)), Action::Pickup),
        Some(Instr::Open { door, .. }) => (Box::new(|_, cell| door.is(cell)), Action::Toggle),
        Some(_) => return None,
        None => (Box::new(|_, cell| cell.is(Kind::Goal)), Action::Forward),
    };
    if let Some(next) = walk(world, &*is_target, action) {
        return Some(next);
    }
    // without another path: fetch the key of a locked door
    let locked = world
        .grid
        .cells()
        .iter()
        .filter(|cell| cell.is_door(State::Locked));
    let mut colors = locked.map(|door| door.color());
    let color = colors.next()?;
    let is_key = move |_: Pos, cell: Cell| cell.is(Kind::Key) && cell.color() == color;
    match world.carrying.is_empty() {
        true => walk(world, &is_key, Action::Pickup),
        false => walk(world, &|_, cell| cell.is_empty(), Action::Drop),
    }
}

/// Whether the agent can pass a cell.
fn is_passable(world: &World, cell: Cell) -> bool {
    let has_key = world.carrying.is(Kind::Key) && world.carrying.color() == cell.color();
    (cell.can_overlap() && !cell.is(Kind::Lava))
        || cell.is_door(State::Closed)
        || (cell.is_door(State::Locked) && has_key)
}

/// Returns the first action on the shortest path to a position in front of a target. Returns
/// `action` if the agent is at such a position already.
fn walk(world: &World, is_target: &dyn Fn(Pos, Cell) -> bool, action: Action) -> Option<Action> {
    let start = (world.agent, world.direction);
    let index = |(pos, direction): (Pos, u8)| {
        ((pos.y * world.grid.width() + pos.x) * 4) as usize + usize::from(direction)
    };
    let mut first = vec![None; 4 * world.grid.cells().len()];
    let mut queue = VecDeque::from([start]);
    first[index(start)] = Some(action);
    while let Some((pos, direction)) = queue.pop_front() {
        let ahead = pos + DIRECTIONS[usize::from(direction)];
        let cell = world.grid.get(ahead);
        let so_far = first[index((pos, direction))];
        if is_target(ahead, cell) {
            return so_far;
        }
        let open = if cell.is(Kind::Door) && !cell.can_overlap() {
            Action::Toggle
        } else {
            Action::Forward
        };
        let turns = [
            (Action::Left, (pos, (direction + 3) % 4)),
            (Action::Right, (pos, (direction + 1) % 4)),
        ];
        let forward = is_passable(world, cell).then_some((open, (ahead, direction)));
        for (taken, next) in turns.into_iter().chain(forward) {
            if first[index(next)].is_none() {
                let is_first = (pos, direction) == start;
                first[index(next)] = if is_first { Some(taken) } else { so_far };
                queue.push_back(next);
            }
        }
    }
    None
}
