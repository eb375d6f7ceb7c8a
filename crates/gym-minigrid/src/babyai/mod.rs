//! BabyAI: instructions in words, on grids of rooms. A module for each kind of instruction.
//!
//! A level places objects, doors and the agent, and forms an [`Instr`]. The mission is the
//! instruction in words; the episode ends when it is done. Levels that cannot be solved are
//! generated again.

mod description;
pub mod go_to;
mod instruction;
mod level_gen;
pub mod open;
pub mod other;
pub mod pickup;
pub mod put_next;
pub mod synth;
pub mod unlocking;

use gym_core::Outcome;
use gym_core::spaces::MissionSpace;

pub use description::{Desc, Loc};
pub use instruction::Instr;
pub(crate) use level_gen::LevelGen;

use crate::draft::{Generated, GenerationError};
use crate::level::{Rules, View};
use crate::rooms::{Rooms, grid_size};
use crate::view::DIRECTIONS;
use crate::{Action, Cell, Color, Draft, Kind, Pos, State, World};
use instruction::Status;

gym_core::arguments! {
    /// The sizes of a grid of rooms.
    #[derive(Copy, Eq)]
    pub struct Maze {
        /// Columns and rows of a room, walls included.
        pub room_size: u32 = 8,
        /// The number of rows of rooms.
        pub num_rows: u32 = 3,
        /// The number of columns of rooms.
        pub num_cols: u32 = 3,
    }
}

impl Maze {
    pub(crate) const fn new(room_size: u32, num_rows: u32, num_cols: u32) -> Self {
        Self {
            room_size,
            num_rows,
            num_cols,
        }
    }
}

/// The settings of a BabyAI level, computed from its arguments.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The rooms.
    pub maze: Maze,
    /// The time limit of an episode; `None` to compute it from the instruction.
    pub max_steps: Option<u32>,
    /// Whether the agent may have to move objects out of its way. If so, instructions do not name
    /// keys of locked doors.
    pub unblocking: bool,
    /// Whether the agent carries the object to move from the start.
    pub start_carrying: bool,
}

impl From<Maze> for Plan {
    fn from(maze: Maze) -> Self {
        Self {
            maze,
            max_steps: None,
            unblocking: false,
            start_carrying: false,
        }
    }
}

impl Plan {
    fn max_steps(self, max_steps: u32) -> Self {
        Self {
            max_steps: Some(max_steps),
            ..self
        }
    }
}

pub(crate) fn rules(plan: Plan) -> Result<Rules, String> {
    let Maze {
        room_size,
        num_rows,
        num_cols,
    } = plan.maze;
    let [width, height] = grid_size(room_size, num_cols, num_rows)?;
    Ok(Rules {
        missions: MissionSpace::any("go"),
        ..Rules::new(width, height, plan.max_steps.unwrap_or(1), "")
    })
}

/// Generates levels until one is valid.
pub(crate) fn generate(
    plan: Plan,
    view: &View,
    draft: &mut Draft<'_>,
    make: impl Fn(&mut Rooms<'_, '_>) -> Generated<Instr>,
) -> Generated {
    let maze = plan.maze;
    let mut instr = loop {
        let attempt = Rooms::new(draft, maze.room_size, maze.num_cols, maze.num_rows).and_then(
            |mut rooms| {
                let mut instr = make(&mut rooms)?;
                let room = rooms.agents_room().area;
                let colors = if plan.unblocking {
                    locked_colors(&rooms)
                } else {
                    Vec::new()
                };
                let world = &*rooms.draft.world;
                instr.each(&mut |single| validate(single, world, room, &colors))?;
                Ok(instr)
            },
        );
        match attempt {
            Err(GenerationError::Rejected(_)) => {}
            other => break other?,
        }
    };
    let world = &mut *draft.world;
    if let Instr::PutNext { moved, .. } = &mut instr
        && plan.start_carrying
    {
        world.pending = moved
            .places
            .first()
            .map_or(Cell::EMPTY, |pos| world.grid.get(*pos));
    }
    if view.max_steps.or(plan.max_steps).is_none() {
        let room = maze.room_size.saturating_mul(maze.room_size);
        let all = room
            .saturating_mul(maze.num_rows)
            .saturating_mul(maze.num_cols);
        world.max_steps = all.saturating_mul(instr.walks());
    }
    world.mission = instr.words();
    world.instr = Some(instr);
    Ok(())
}

pub(crate) fn step(world: &mut World, action: Action) -> Outcome {
    let outcome = world.step(action);
    let Some(mut instr) = world.instr.take() else {
        return outcome;
    };
    if action == Action::Drop {
        instr.update(world);
    }
    let status = instr.verify(world, action);
    world.instr = Some(instr);
    let (reward, terminated) = match status {
        Status::Continue => return outcome,
        Status::Success => (world.reward(), true),
        Status::Failure => (0.0, true),
    };
    Outcome {
        reward,
        terminated,
        ..outcome
    }
}

/// Returns the colours of the locked doors.
fn locked_colors(rooms: &Rooms<'_, '_>) -> Vec<Color> {
    let doors = rooms
        .doors()
        .into_iter()
        .map(|pos| rooms.draft.world.grid.get(pos));
    doors
        .filter(|door| door.is_door(State::Locked))
        .map(Cell::color)
        .collect()
}

/// Finds the objects of a single task. Returns an error for a task that is already done or cannot
/// be done.
fn validate(instr: &mut Instr, world: &World, room: crate::Area, locked: &[Color]) -> Generated {
    for desc in instr.descriptions() {
        desc.find(world, room);
        if desc.count() == 0 {
            return Err(GenerationError::Impossible(
                "no object fits the instruction".into(),
            ));
        }
    }
    if let Instr::PutNext { moved, fixed, .. } = instr
        && (moved.meets(fixed) || moved.any_next_to(fixed))
    {
        return Err(GenerationError::Rejected(
            "the objects are next to each other already",
        ));
    }
    if instr
        .descriptions()
        .iter()
        .any(|desc| desc.is_key_of(locked))
    {
        return Err(GenerationError::Rejected("the key is needed for a door"));
    }
    Ok(())
}

/// Whether the agent can reach every object. Doors do not block the agent, objects do.
pub(crate) fn all_reachable(world: &World) -> bool {
    let grid = &world.grid;
    let index = |pos: Pos| (pos.y * grid.width() + pos.x) as usize;
    let mut reached = vec![false; grid.cells().len()];
    let mut stack = vec![world.agent];
    while let Some(pos) = stack.pop() {
        if !grid.contains(pos) || std::mem::replace(&mut reached[index(pos)], true) {
            continue;
        }
        let cell = grid.get(pos);
        if cell.is_empty() || cell.is(Kind::Door) {
            stack.extend(DIRECTIONS.map(|direction| pos + direction));
        }
    }
    let is_fine =
        |(cell, reached): (&Cell, bool)| reached || cell.is_empty() || cell.is(Kind::Wall);
    grid.cells().iter().zip(reached).all(is_fine)
}

/// Returns an error for a level with an object that the agent cannot reach.
pub(crate) fn check_reachable(rooms: &Rooms<'_, '_>) -> Generated {
    if all_reachable(rooms.draft.world) {
        Ok(())
    } else {
        Err(GenerationError::Rejected("an object cannot be reached"))
    }
}

/// Defines a level: its arguments, its [`Plan`], and the function that generates it.
macro_rules! babyai {
    (
        $(#[$doc:meta])* $name:ident { $($arguments:tt)* }
        $(check $check:expr;)? plan $plan:expr; make $make:expr;
    ) => {
        $crate::level! { $(#[$doc])* $name { $($arguments)* } }

        impl $name {
            fn plan(&self) -> $crate::babyai::Plan {
                let plan: fn(&Self) -> $crate::babyai::Plan = $plan;
                plan(self)
            }
        }

        impl $crate::Level for $name {
            fn name(&self) -> &'static str {
                concat!("BabyAI-", stringify!($name))
            }

            fn rules(&self) -> Result<$crate::level::Rules, String> {
                $(
                    let check: fn(&Self) -> Result<(), String> = $check;
                    check(self)?;
                )?
                $crate::babyai::rules(self.plan())
            }

            fn generate(&self, draft: &mut $crate::Draft<'_>) -> $crate::Generated {
                type Make<T> = fn(&T, &mut $crate::rooms::Rooms<'_, '_>) -> $crate::Generated<$crate::babyai::Instr>;
                let make: Make<Self> = $make;
                $crate::babyai::generate(self.plan(), &self.view, draft, |rooms| make(self, rooms))
            }

            fn step(
                &self,
                world: &mut $crate::World,
                action: $crate::Action,
                _rng: &mut gym_core::Generator,
            ) -> gym_core::Outcome {
                $crate::babyai::step(world, action)
            }
        }
    };
}
use babyai;
