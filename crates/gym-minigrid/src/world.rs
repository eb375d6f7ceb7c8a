//! The state of an episode, and the effects of the seven actions.

use gym_core::Outcome;
use serde::{Deserialize, Serialize};

use crate::babyai::Instr;
use crate::view::{DIRECTIONS, View};
use crate::{Cell, Grid, Kind, Pos, State};

gym_core::discrete! {
    /// An action of the agent.
    #[derive(Serialize, Deserialize)]
    pub enum Action {
        /// Turn left.
        Left,
        /// Turn right.
        Right,
        /// Move forward.
        Forward,
        /// Pick up the object in front.
        Pickup,
        /// Drop the carried object.
        Drop,
        /// Open or close the door in front, or open the box.
        Toggle,
        /// Declare the task done.
        Done,
    }
}

/// The record of a numbered object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Thing {
    /// The position where the object was first placed.
    pub(crate) start: Pos,
    /// The position where the object was last placed; [`NOWHERE`] while the agent carries the
    /// object.
    pub(crate) pos: Pos,
    /// The content, for a box.
    pub(crate) content: Cell,
}

/// The position of an object that is not on the grid.
pub(crate) const NOWHERE: Pos = Pos::new(-1, -1);

/// The state of an episode: grid, agent, mission and step count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct World {
    /// The cells.
    pub grid: Grid,
    /// The agent's position.
    pub agent: Pos,
    /// The direction that the agent faces: 0 right, 1 down, 2 left, 3 up.
    pub direction: u8,
    /// The object that the agent carries, or an empty cell.
    pub carrying: Cell,
    /// The number of steps in the episode.
    pub step_count: u32,
    /// The time limit of the episode.
    pub max_steps: u32,
    /// The mission.
    pub mission: String,
    /// Objects that end the episode, as the task defines.
    pub targets: Vec<Cell>,
    /// Positions that end the episode, as the task defines.
    pub places: Vec<Pos>,
    /// The instruction, in a BabyAI level.
    #[serde(deserialize_with = "Option::deserialize")]
    pub(crate) instr: Option<Instr>,
    /// The object that the agent carries from the first step on, or an empty cell.
    pub(crate) pending: Cell,
    /// The records of numbered objects: index 0 has number 1.
    pub(crate) things: Vec<Thing>,
}

impl World {
    pub(crate) fn new(width: i32, height: i32, max_steps: u32) -> Self {
        Self {
            grid: Grid::new(width, height),
            agent: NOWHERE,
            direction: 0,
            carrying: Cell::EMPTY,
            step_count: 0,
            max_steps,
            mission: String::new(),
            targets: Vec::new(),
            places: Vec::new(),
            instr: None,
            pending: Cell::EMPTY,
            things: Vec::new(),
        }
    }

    /// The position in front of the agent.
    pub fn front_pos(&self) -> Pos {
        self.agent + DIRECTIONS[usize::from(self.direction) % 4]
    }

    /// The cell in front of the agent.
    pub fn front(&self) -> Cell {
        self.grid.get(self.front_pos())
    }

    /// The reward for success: 1 minus up to 0.9 for the steps taken.
    pub fn reward(&self) -> f64 {
        1.0 - 0.9 * (f64::from(self.step_count) / f64::from(self.max_steps))
    }

    /// Takes an action. The episode terminates with success in the goal, and without reward in
    /// lava.
    pub fn step(&mut self, action: Action) -> Outcome {
        self.step_count = self.step_count.saturating_add(1);
        let mut outcome = Outcome::default();
        let (front_pos, front) = (self.front_pos(), self.front());
        match action {
            Action::Left => self.direction = (self.direction + 3) % 4,
            Action::Right => self.direction = (self.direction + 1) % 4,
            Action::Forward => {
                if front.can_overlap() {
                    self.agent = front_pos;
                }
                outcome.terminated = front.is(Kind::Goal) || front.is(Kind::Lava);
                if front.is(Kind::Goal) {
                    outcome.reward = self.reward();
                }
            }
            Action::Pickup => {
                if front.can_pickup() && self.carrying.is_empty() {
                    self.carrying = front;
                    self.note(front, NOWHERE);
                    self.grid.set(front_pos, Cell::EMPTY);
                }
            }
            Action::Drop => {
                if front.is_empty() && !self.carrying.is_empty() {
                    self.grid.set(front_pos, self.carrying);
                    self.note(self.carrying, front_pos);
                    self.carrying = Cell::EMPTY;
                }
            }
            Action::Toggle => self.toggle(front_pos, front),
            Action::Done => {}
        }
        outcome.truncated = self.step_count >= self.max_steps;
        outcome
    }

    fn toggle(&mut self, pos: Pos, cell: Cell) {
        let next = match cell.kind() {
            Kind::Box => self.thing(cell).map_or(Cell::EMPTY, |thing| thing.content),
            Kind::Door if cell.is_door(State::Open) => cell.with_state(State::Closed),
            Kind::Door if cell.is_door(State::Closed) => cell.with_state(State::Open),
            Kind::Door if self.carrying.is(Kind::Key) && self.carrying.color() == cell.color() => {
                cell.with_state(State::Open)
            }
            _ => return,
        };
        self.grid.set(pos, next);
    }

    /// The element `index` of [`targets`](Self::targets); an empty cell if there is none.
    pub fn target(&self, index: usize) -> Cell {
        self.targets.get(index).copied().unwrap_or(Cell::EMPTY)
    }

    /// The element `index` of [`places`](Self::places); `NOWHERE` if there is none.
    pub fn place(&self, index: usize) -> Pos {
        self.places.get(index).copied().unwrap_or(NOWHERE)
    }

    /// Gives the agent the pending object.
    pub(crate) fn begin(&mut self) {
        let pending = std::mem::replace(&mut self.pending, Cell::EMPTY);
        if let Some(start) = self.thing(pending).map(|thing| thing.start) {
            self.grid.set(start, Cell::EMPTY);
            self.carrying = pending;
        }
    }

    /// Returns the record of a numbered object.
    pub(crate) fn thing(&self, cell: Cell) -> Option<&Thing> {
        self.things.get(usize::from(cell.id()).checked_sub(1)?)
    }

    /// Records the position of a numbered object.
    pub(crate) fn note(&mut self, cell: Cell, pos: Pos) {
        let index = usize::from(cell.id()).wrapping_sub(1);
        if let Some(thing) = self.things.get_mut(index) {
            thing.pos = pos;
        }
    }

    pub(crate) fn view(&self, size: i32) -> View {
        View::new(self.agent, self.direction, size)
    }

    /// The grid as text, two letters for each cell: minigrid's `pprint_grid`.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for y in 0..self.grid.height() {
            for x in 0..self.grid.width() {
                let pos = Pos::new(x, y);
                text.extend(if pos == self.agent {
                    [['>', 'V', '<', '^'][usize::from(self.direction) % 4]; 2]
                } else {
                    self.grid.get(pos).letters()
                });
            }
            if y + 1 < self.grid.height() {
                text.push('\n');
            }
        }
        text
    }

    /// Whether a stored world fits a grid of `width` by `height` cells.
    pub(crate) fn is_valid(&self, width: i32, height: i32) -> bool {
        let things = self.things.len();
        self.grid.is_valid(width, height, things)
            && self.grid.contains(self.agent)
            && self.direction < 4
            && [self.carrying, self.pending]
                .iter()
                .all(|cell| cell.is_valid(things) && (cell.is_empty() || cell.can_pickup()))
            && self.targets.iter().all(|cell| cell.is_valid(things))
            && self.places.iter().all(|pos| self.grid.contains(*pos))
            && self.instr.as_ref().is_none_or(|instr| instr.is_valid(self))
            && self.things.iter().all(|thing| {
                let is_place = |pos: Pos| pos == NOWHERE || self.grid.contains(pos);
                thing.content.is_valid(things) && is_place(thing.start) && is_place(thing.pos)
            })
            && self.max_steps > 0
    }
}
