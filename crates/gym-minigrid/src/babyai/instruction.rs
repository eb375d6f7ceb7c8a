//! Instructions: the agent's task in words, and the test of whether it is done.

use serde::{Deserialize, Serialize};

use super::description::Desc;
use crate::{Action, Cell, Kind, State, World};

/// A task for the agent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Instr {
    /// Stand before an object.
    GoTo(Desc),
    /// Open a door.
    Open {
        /// The door.
        door: Desc,
        /// Whether another door fails the task.
        strict: bool,
    },
    /// Pick up an object.
    Pickup {
        /// The object.
        object: Desc,
        /// Whether another object fails the task.
        strict: bool,
        /// The object that the agent carried at the last `verify`.
        before: Cell,
    },
    /// Put an object next to another one.
    PutNext {
        /// The object to move.
        moved: Desc,
        /// The object that stays.
        fixed: Desc,
        /// The object that the agent carried at the last `verify`.
        before: Cell,
    },
    /// Two tasks, one after the other.
    Then {
        /// The task to do first.
        first: Box<Instr>,
        /// The task to do second.
        second: Box<Instr>,
        /// Whether the words name the second task first.
        after: bool,
        /// Whether the first task is done.
        first_done: bool,
    },
    /// Two tasks in any order.
    And(Box<[Instr; 2]>, [bool; 2]),
}

/// The status of a task after an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    Continue,
    Success,
    Failure,
}

impl Instr {
    pub(crate) fn open(door: Desc, strict: bool) -> Self {
        Self::Open { door, strict }
    }

    pub(crate) fn pickup(object: Desc, strict: bool) -> Self {
        Self::Pickup {
            object,
            strict,
            before: Cell::EMPTY,
        }
    }

    pub(crate) fn put_next(moved: Desc, fixed: Desc) -> Self {
        Self::PutNext {
            moved,
            fixed,
            before: Cell::EMPTY,
        }
    }

    /// Makes the instruction `first, then second`.
    pub(crate) fn before(first: Self, second: Self) -> Self {
        Self::Then {
            first: first.into(),
            second: second.into(),
            after: false,
            first_done: false,
        }
    }

    /// Makes the instruction `second after you first`.
    pub(crate) fn after(second: Self, first: Self) -> Self {
        Self::Then {
            first: first.into(),
            second: second.into(),
            after: true,
            first_done: false,
        }
    }

    pub(crate) fn and(a: Self, b: Self) -> Self {
        Self::And([a, b].into(), [false; 2])
    }

    /// Returns the instruction in words.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::GoTo(object) => format!("go to {}", object.words()),
            Self::Open { door, .. } => format!("open {}", door.words()),
            Self::Pickup { object, .. } => format!("pick up {}", object.words()),
            Self::PutNext { moved, fixed, .. } => {
                format!("put {} next to {}", moved.words(), fixed.words())
            }
            Self::Then {
                first,
                second,
                after: false,
                ..
            } => format!("{}, then {}", first.words(), second.words()),
            Self::Then { first, second, .. } => {
                format!("{} after you {}", second.words(), first.words())
            }
            Self::And(both, _) => format!("{} and {}", both[0].words(), both[1].words()),
        }
    }

    /// Calls `f` with each single task, in the order of the words.
    pub(crate) fn each<E>(
        &mut self,
        f: &mut impl FnMut(&mut Self) -> Result<(), E>,
    ) -> Result<(), E> {
        match self {
            Self::Then {
                first,
                second,
                after,
                ..
            } => {
                let (a, b) = if *after {
                    (second, first)
                } else {
                    (first, second)
                };
                a.each(f)?;
                b.each(f)
            }
            Self::And(both, _) => both.iter_mut().try_for_each(|instr| instr.each(f)),
            single => f(single),
        }
    }

    /// Returns the descriptions of a single task.
    pub(crate) fn descriptions(&mut self) -> Vec<&mut Desc> {
        match self {
            Self::GoTo(object) | Self::Pickup { object, .. } => vec![object],
            Self::Open { door, .. } => vec![door],
            Self::PutNext { moved, fixed, .. } => vec![moved, fixed],
            Self::Then { .. } | Self::And(..) => Vec::new(),
        }
    }

    /// Updates the positions of the described objects.
    pub(crate) fn update(&mut self, world: &World) {
        match self {
            Self::GoTo(object) | Self::Pickup { object, .. } => object.update(world),
            Self::Open { door, .. } => door.update(world),
            Self::PutNext { moved, fixed, .. } => {
                moved.update(world);
                fixed.update(world);
            }
            Self::Then { first, second, .. } => {
                first.update(world);
                second.update(world);
            }
            Self::And(both, _) => both.iter_mut().for_each(|instr| instr.update(world)),
        }
    }

    /// Returns the status of the task after `action`.
    pub(crate) fn verify(&mut self, world: &World, action: Action) -> Status {
        let success = |is: bool| {
            if is {
                Status::Success
            } else {
                Status::Continue
            }
        };
        match self {
            Self::GoTo(object) => success(object.places.contains(&world.front_pos())),
            Self::Open { door, strict } => {
                let front = world.front();
                match action {
                    Action::Toggle if door.is(front) && front.is_door(State::Open) => {
                        Status::Success
                    }
                    Action::Toggle if *strict && front.is(Kind::Door) => Status::Failure,
                    _ => Status::Continue,
                }
            }
            Self::Pickup {
                object,
                strict,
                before,
            } => {
                let before = std::mem::replace(before, world.carrying);
                match action {
                    Action::Pickup if before.is_empty() && object.is(world.carrying) => {
                        Status::Success
                    }
                    Action::Pickup if *strict && !world.carrying.is_empty() => Status::Failure,
                    _ => Status::Continue,
                }
            }
            Self::PutNext {
                moved,
                fixed,
                before,
            } => {
                let before = std::mem::replace(before, world.carrying);
                let pos = world
                    .thing(before)
                    .filter(|_| moved.is(before))
                    .map(|thing| thing.pos);
                success(action == Action::Drop && pos.is_some_and(|pos| fixed.is_next_to(pos)))
            }
            Self::Then {
                first,
                second,
                first_done,
                ..
            } => {
                if !*first_done {
                    match first.verify(world, action) {
                        Status::Success => *first_done = true,
                        other => return other,
                    }
                }
                second.verify(world, action)
            }
            Self::And(both, done) => {
                for (instr, done) in both.iter_mut().zip(done.iter_mut()) {
                    *done = *done || instr.verify(world, action) == Status::Success;
                }
                success(done.iter().all(|done| *done))
            }
        }
    }

    /// Returns the number of walks that the task needs, which determines the step limit.
    pub(crate) fn walks(&self) -> u32 {
        match self {
            Self::PutNext { .. } => 2,
            Self::Then { first, second, .. } => first.walks() + second.walks(),
            Self::And(both, _) => both.iter().map(Self::walks).sum(),
            _ => 1,
        }
    }

    /// Whether a stored task fits the world.
    pub(crate) fn is_valid(&self, world: &World) -> bool {
        let things = world.things.len();
        match self {
            Self::GoTo(object) => object.is_valid(world),
            Self::Open { door, .. } => door.is_valid(world),
            Self::Pickup { object, before, .. } => {
                object.is_valid(world) && before.is_valid(things)
            }
            Self::PutNext {
                moved,
                fixed,
                before,
            } => moved.is_valid(world) && fixed.is_valid(world) && before.is_valid(things),
            Self::Then { first, second, .. } => first.is_valid(world) && second.is_valid(world),
            Self::And(both, _) => both.iter().all(|instr| instr.is_valid(world)),
        }
    }
}
