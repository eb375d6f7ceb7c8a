//! BabyAI: instructions in words, on grids of rooms. A module for each kind of instruction.
//!
//! A level places objects, doors and the agent, and forms an [`Instr`]. The mission is the
//! instruction in words; the episode ends when it is done. Levels that cannot be used are made
//! anew.

mod description;
pub mod go_to;
mod instruction;
mod level_gen;
pub mod open;
pub mod other;
pub mod pickup;
pub mod put_next;
pub mod synth;
pub mod unlock;

use gym_core::spaces::MissionSpace;
use gym_core::{Generator, Outcome, Result};
use serde::{Deserialize, Serialize};

pub use description::{Desc, Loc};
pub use instruction::Instr;
pub(crate) use level_gen::LevelGen;

use crate::draft::{Making, Stop};
use crate::level::{Level, Rules, View, refuse};
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

/// What follows from the arguments of a BabyAI level.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The rooms.
    pub maze: Maze,
    /// The steps after which an episode is truncated; otherwise they follow from the instruction.
    pub max_steps: Option<u32>,
    /// Whether the agent may have to move objects out of its way; keys of locked doors are then not
    /// part of an instruction.
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

/// A level of BabyAI.
pub(crate) trait Babyai:
    gym_core::Arguments + PartialEq + std::fmt::Debug + Clone + Send + Sync + 'static
{
    const NAME: &'static str;

    fn view(&self) -> &View;

    fn plan(&self) -> Plan;

    /// Why the arguments cannot be used.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Places everything, and forms the instruction.
    fn make(&self, rooms: &mut Rooms<'_, '_>) -> Making<Instr>;
}

/// The instruction of an episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// The instruction, and what of it is done.
    pub instr: Instr,
    /// The object that the agent gets after the first observation, or an empty cell.
    carried: Cell,
}

impl crate::level::Memory for Memory {
    fn fits(&self, world: &World) -> bool {
        self.instr.is_valid(world) && self.carried.is_valid(world.things.len())
    }
}

impl<B: Babyai> Level for B {
    type Action = Action;
    type Memory = Memory;

    const NAME: &'static str = B::NAME;

    fn view(&self) -> &View {
        Babyai::view(self)
    }

    fn rules(&self) -> Result<Rules> {
        let plan = self.plan();
        let Maze {
            room_size,
            num_rows,
            num_cols,
        } = plan.maze;
        self.check().or_else(refuse::<Self, _>)?;
        let [width, height] =
            grid_size(room_size, num_cols, num_rows).or_else(refuse::<Self, _>)?;
        Ok(Rules {
            missions: MissionSpace::any("go"),
            ..Rules::new(width, height, plan.max_steps.unwrap_or(1), "")
        })
    }

    fn generate(&self, draft: &mut Draft<'_>) -> Making<Memory> {
        let plan = self.plan();
        let maze = plan.maze;
        let mut instr = loop {
            let attempt = Rooms::new(draft, maze.room_size, maze.num_cols, maze.num_rows).and_then(
                |mut rooms| {
                    let mut instr = self.make(&mut rooms)?;
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
                Err(Stop::Again(_)) => {}
                other => break other?,
            }
        };
        let carried = match &mut instr {
            Instr::PutNext { moved, .. } if plan.start_carrying => moved
                .places
                .first()
                .map_or(Cell::EMPTY, |pos| draft.world.grid.get(*pos)),
            _ => Cell::EMPTY,
        };
        if Babyai::view(self).max_steps.or(plan.max_steps).is_none() {
            let room = maze.room_size.saturating_mul(maze.room_size);
            let all = room
                .saturating_mul(maze.num_rows)
                .saturating_mul(maze.num_cols);
            draft.world.max_steps = all.saturating_mul(instr.walks());
        }
        draft.mission(instr.words());
        Ok(Memory { instr, carried })
    }

    fn begin(&self, world: &mut World, memory: &Memory) {
        if let Some(thing) = world.thing(memory.carried) {
            world.grid.set(thing.start, Cell::EMPTY);
            world.carrying = memory.carried;
        }
    }

    fn step(
        &self,
        world: &mut World,
        memory: &mut Memory,
        action: Action,
        _rng: &mut Generator,
    ) -> Outcome {
        let outcome = world.step(action);
        if action == Action::Drop {
            memory.instr.update(world);
        }
        let (reward, terminated) = match memory.instr.verify(world, action) {
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
}

/// The colours of the locked doors.
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

/// Finds the objects of a single task, and refuses tasks that are done already, or cannot be done.
fn validate(instr: &mut Instr, world: &World, room: crate::Area, locked: &[Color]) -> Making {
    for desc in instr.descriptions() {
        desc.find(world, room);
        if desc.count() == 0 {
            return Err(Stop::Impossible("no object fits the instruction".into()));
        }
    }
    if let Instr::PutNext { moved, fixed, .. } = instr
        && (moved.meets(fixed) || moved.any_next_to(fixed))
    {
        return Err(Stop::Again("the objects are next to each other already"));
    }
    if instr
        .descriptions()
        .iter()
        .any(|desc| desc.is_key_of(locked))
    {
        return Err(Stop::Again("the key is needed for a door"));
    }
    Ok(())
}

/// Whether the agent can reach every object, through doors but past no object.
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

/// Refuses a level with an object that the agent cannot reach.
pub(crate) fn check_reachable(rooms: &Rooms<'_, '_>) -> Making {
    if all_reachable(rooms.draft.world) {
        Ok(())
    } else {
        Err(Stop::Again("an object cannot be reached"))
    }
}

/// Defines a level: its arguments, what follows from them, and how it is made.
macro_rules! babyai {
    (
        $(#[$doc:meta])* $name:ident { $($arguments:tt)* }
        $(check $check:expr;)? plan $plan:expr; make $make:expr;
    ) => {
        $crate::tasks::level! { $(#[$doc])* $name { $($arguments)* } }

        impl $crate::babyai::Babyai for $name {
            const NAME: &'static str = concat!("BabyAI-", stringify!($name));

            fn view(&self) -> &$crate::level::View {
                &self.view
            }

            fn plan(&self) -> $crate::babyai::Plan {
                let plan: fn(&Self) -> $crate::babyai::Plan = $plan;
                plan(self)
            }

            $(fn check(&self) -> Result<(), String> {
                let check: fn(&Self) -> Result<(), String> = $check;
                check(self)
            })?

            fn make(&self, rooms: &mut $crate::rooms::Rooms<'_, '_>) -> $crate::Making<$crate::babyai::Instr> {
                type Make<T> = fn(&T, &mut $crate::rooms::Rooms<'_, '_>) -> $crate::Making<$crate::babyai::Instr>;
                let make: Make<Self> = $make;
                make(self, rooms)
            }
        }
    };
}
use babyai;
