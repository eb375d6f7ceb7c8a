//! A world under construction. Random draws are in minigrid's order.

use gym_core::Generator;

use crate::world::{NOWHERE, Thing};
use crate::{Cell, Color, Kind, Pos, World};

/// Why a level was not generated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GenerationError {
    /// This attempt failed by chance, and another may succeed: minigrid's `RejectSampling` and
    /// `RecursionError`.
    Rejected(&'static str),
    /// No level is possible with these arguments.
    Impossible(String),
}

/// The result of a step of the generation of a level.
pub type Generated<T = ()> = std::result::Result<T, GenerationError>;

/// The largest number of random draws per episode. Only a level whose objects do not fit reaches
/// this number.
pub(crate) const MAX_CHOICES: u32 = 2_000_000;

/// A rectangle: the position of its top left corner, width and height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// The top left corner.
    pub top: Pos,
    /// Width and height.
    pub size: Pos,
}

impl Area {
    /// The rectangle with the corner `(x, y)`.
    pub const fn new(x: i32, y: i32, width: i32, height: i32) -> Self {
        Self {
            top: Pos::new(x, y),
            size: Pos::new(width, height),
        }
    }

    /// Whether `pos` lies in the rectangle.
    pub const fn contains(&self, pos: Pos) -> bool {
        let (x, y) = (pos.x - self.top.x, pos.y - self.top.y);
        x >= 0 && y >= 0 && x < self.size.x && y < self.size.y
    }
}

/// A world under construction, and its random generator.
#[derive(Debug)]
pub struct Draft<'a> {
    /// The world.
    pub world: &'a mut World,
    rng: &'a mut Generator,
    /// The random draws that are left.
    choices: u32,
}

impl<'a> Draft<'a> {
    pub(crate) fn new(world: &'a mut World, rng: &'a mut Generator, choices: u32) -> Self {
        Self {
            world,
            rng,
            choices,
        }
    }

    /// The width of the grid.
    pub fn width(&self) -> i32 {
        self.world.grid.width()
    }

    /// The height of the grid.
    pub fn height(&self) -> i32 {
        self.world.grid.height()
    }

    /// Removes everything, for another attempt.
    pub fn clear(&mut self) {
        self.world.grid.clear();
        self.world.things.clear();
        self.world.targets.clear();
        self.world.places.clear();
    }

    /// Draws an integer from `low` to `high - 1` uniformly: minigrid's `_rand_int`.
    ///
    /// # Errors
    /// [`GenerationError::Impossible`] for an empty range, and if a level needs too many choices.
    pub fn int(&mut self, low: i32, high: i32) -> Generated<i32> {
        if low >= high {
            let reason = format!("there is no place from {low} to {}", high - 1);
            return Err(GenerationError::Impossible(reason));
        }
        let Some(left) = self.choices.checked_sub(1) else {
            let reason = "no level fits the arguments";
            return Err(GenerationError::Impossible(reason.into()));
        };
        self.choices = left;
        Ok(self.rng.integers(low.into(), high.into()) as i32)
    }

    /// Draws a boolean: minigrid's `_rand_bool`.
    ///
    /// # Errors
    /// The errors of [`int`](Self::int).
    pub fn bool(&mut self) -> Generated<bool> {
        Ok(self.int(0, 2)? == 0)
    }

    /// Draws a number from `[0, 1)` uniformly: minigrid's `_rand_float(0, 1)`.
    pub fn float(&mut self) -> f64 {
        self.rng.uniform(0.0, 1.0)
    }

    /// Draws an element of `list`: minigrid's `_rand_elem`.
    ///
    /// # Errors
    /// [`GenerationError::Impossible`] for an empty list, and the errors of [`int`](Self::int).
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> Generated<T> {
        if list.is_empty() {
            let reason = "there is nothing to choose from";
            return Err(GenerationError::Impossible(reason.into()));
        }
        Ok(list[self.int(0, list.len() as i32)? as usize])
    }

    /// Draws `count` distinct elements of `list`: minigrid's `_rand_subset`.
    ///
    /// # Errors
    /// The errors of [`int`](Self::int); the list must be long enough.
    pub fn subset<T: Copy>(&mut self, list: &[T], count: usize) -> Generated<Vec<T>> {
        let mut rest = list.to_vec();
        (0..count)
            .map(|_| Ok(rest.remove(self.int(0, rest.len() as i32)? as usize)))
            .collect()
    }

    /// Draws a colour: minigrid's `_rand_color`.
    ///
    /// # Errors
    /// The errors of [`int`](Self::int).
    pub fn color(&mut self) -> Generated<Color> {
        self.pick(&Color::SORTED)
    }

    /// Puts a list in random order.
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        self.rng.shuffle(list);
    }

    /// Makes a numbered object. It is not on the grid yet.
    pub fn object(&mut self, kind: Kind, color: Color) -> Cell {
        self.number(Cell::new(kind, color))
    }

    /// Makes a numbered box that contains an object.
    pub fn box_of(&mut self, color: Color, content: Cell) -> Cell {
        let cell = self.object(Kind::Box, color);
        if let Some(thing) = self.world.things.last_mut() {
            thing.content = content;
        }
        cell
    }

    /// Gives a cell the next object number.
    pub fn number(&mut self, cell: Cell) -> Cell {
        self.world.things.push(Thing {
            start: NOWHERE,
            pos: NOWHERE,
            content: Cell::EMPTY,
        });
        // (a grid has at most 255 * 255 = 65,025 cells)
        cell.with_id(u16::try_from(self.world.things.len()).unwrap_or(u16::MAX))
    }

    /// Puts a cell at a position.
    pub fn put(&mut self, pos: Pos, cell: Cell) {
        self.world.grid.set(pos, cell);
        self.world.note(cell, pos);
        let index = usize::from(cell.id()).wrapping_sub(1);
        if let Some(thing) = self.world.things.get_mut(index) {
            thing.start = pos;
        }
    }

    /// Puts a cell at a random empty position: minigrid's `place_obj`.
    ///
    /// # Errors
    /// The errors of [`int`](Self::int).
    pub fn place(&mut self, cell: Cell) -> Generated<Pos> {
        self.place_if(cell, self.whole(), u32::MAX, |_, _| true)
    }

    /// The area of the grid.
    pub fn whole(&self) -> Area {
        Area::new(0, 0, self.width(), self.height())
    }

    /// Puts a cell at a random empty position of an area, for which `accept` returns true. It gives
    /// up after more than `max_tries` failed attempts.
    ///
    /// # Errors
    /// [`GenerationError::Rejected`] after too many failures, and the errors of [`int`](Self::int).
    pub fn place_if(
        &mut self,
        cell: Cell,
        Area { top, size }: Area,
        max_tries: u32,
        accept: impl Fn(&World, Pos) -> bool,
    ) -> Generated<Pos> {
        let (x, y) = (top.x.max(0), top.y.max(0));
        let (right, bottom) = (
            (x + size.x).min(self.width()),
            (y + size.y).min(self.height()),
        );
        let mut tries = 0;
        loop {
            if tries > max_tries {
                return Err(GenerationError::Rejected("no free place was found"));
            }
            tries += 1;
            let pos = Pos::new(self.int(x, right)?, self.int(y, bottom)?);
            let world = &*self.world;
            if world.grid.get(pos).is_empty() && pos != world.agent && accept(world, pos) {
                self.put(pos, cell);
                return Ok(pos);
            }
        }
    }

    /// Puts the agent at a random empty position, facing a random direction.
    ///
    /// # Errors
    /// The errors of [`int`](Self::int).
    pub fn place_agent(&mut self) -> Generated {
        self.place_agent_in(self.whole(), u32::MAX)
    }

    /// Puts the agent at a random empty position of an area.
    ///
    /// # Errors
    /// The errors of [`place_if`](Self::place_if).
    pub fn place_agent_in(&mut self, area: Area, max_tries: u32) -> Generated {
        self.world.agent = NOWHERE;
        self.world.agent = self.place_if(Cell::EMPTY, area, max_tries, |_, _| true)?;
        self.world.direction = self.int(0, 4)? as u8;
        Ok(())
    }

    /// Puts the agent at a position.
    pub fn put_agent(&mut self, pos: impl Into<Pos>, direction: u8) {
        self.world.agent = pos.into();
        self.world.direction = direction;
    }

    /// Sets the mission.
    pub fn mission(&mut self, mission: impl Into<String>) {
        self.world.mission = mission.into();
    }
}
