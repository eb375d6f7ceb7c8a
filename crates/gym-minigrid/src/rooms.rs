//! A grid of equal rooms with doors between them: minigrid's `RoomGrid`.

use crate::draft::{Area, Draft, Generated, GenerationError};
use crate::view::DIRECTIONS;
use crate::{Cell, Color, Kind, Pos, State};

/// The kinds of objects in rooms.
pub(crate) const KINDS: [Kind; 3] = [Kind::Key, Kind::Ball, Kind::Box];

/// The number of attempts to place an object.
const MAX_TRIES: u32 = 1000;

/// The number of attempts to connect rooms by doors.
const MAX_DOORS: u32 = 5000;

/// The number of attempts to place the agent where it faces nothing: of a room's places one in 144
/// suffices. minigrid tries for ever.
const MAX_POSES: u32 = 5000;

/// The passage through a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// No passage.
    Closed,
    /// A door at this position.
    Door(Pos),
    /// The wall was removed.
    Open,
}

/// A room. Its walls are numbered as directions: right, down, left, up.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    pub(crate) area: Area,
    /// For each wall: the index of the room behind it.
    neighbors: [Option<usize>; 4],
    pub(crate) ways: [Way; 4],
    /// For each wall: the position of its door, if the wall gets a door.
    door_pos: [Pos; 4],
    locked: bool,
    objects: Vec<(Kind, Color)>,
}

/// A grid of rooms under construction.
#[derive(Debug)]
pub(crate) struct Rooms<'d, 'a> {
    pub(crate) draft: &'d mut Draft<'a>,
    pub(crate) columns: i32,
    pub(crate) rows: i32,
    room_size: i32,
    pub(crate) rooms: Vec<Room>,
}

/// Returns the width and height of a grid of rooms, walls included.
pub(crate) fn grid_size(room_size: u32, columns: u32, rows: u32) -> Result<[u32; 2], String> {
    let limit = 3..=crate::Grid::MAX_SIDE;
    if !limit.contains(&room_size) || columns == 0 || rows == 0 {
        return Err(format!(
            "{columns} by {rows} rooms of size {room_size}: at least 1 by 1 of size 3 are needed"
        ));
    }
    Ok([columns, rows].map(|n| (room_size - 1).saturating_mul(n).saturating_add(1)))
}

impl<'d, 'a> Rooms<'d, 'a> {
    /// Builds the walls, chooses the positions of doors, and puts the agent in the middle.
    pub(crate) fn new(
        draft: &'d mut Draft<'a>,
        room_size: u32,
        columns: u32,
        rows: u32,
    ) -> Generated<Self> {
        let [room_size, columns, rows] = [room_size, columns, rows].map(|n| n as i32);
        draft.clear();
        let step = room_size - 1;
        let mut rooms: Vec<Room> = Vec::new();
        for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
            let area = Area::new(i * step, j * step, room_size, room_size);
            draft
                .world
                .grid
                .wall_rect(area.top.x, area.top.y, room_size, room_size);
            let index = (j * columns + i) as usize;
            rooms.push(Room {
                area,
                neighbors: [
                    (i < columns - 1).then_some(index + 1),
                    (j < rows - 1).then_some(index + columns as usize),
                    (i > 0).then(|| index - 1),
                    (j > 0).then(|| index - columns as usize),
                ],
                ways: [Way::Closed; 4],
                door_pos: [Pos::default(); 4],
                locked: false,
                objects: Vec::new(),
            });
        }
        for index in 0..rooms.len() {
            let Room {
                area: Area { top, .. },
                neighbors,
                ..
            } = rooms[index];
            let end = top + Pos::new(step, step);
            if let Some(right) = neighbors[0] {
                let pos = Pos::new(end.x, draft.int(top.y + 1, end.y)?);
                (rooms[index].door_pos[0], rooms[right].door_pos[2]) = (pos, pos);
            }
            if let Some(below) = neighbors[1] {
                let pos = Pos::new(draft.int(top.x + 1, end.x)?, end.y);
                (rooms[index].door_pos[1], rooms[below].door_pos[3]) = (pos, pos);
            }
        }
        let middle = |n: i32| n / 2 * step + room_size / 2;
        draft.put_agent(Pos::new(middle(columns), middle(rows)), 0);
        Ok(Self {
            draft,
            columns,
            rows,
            room_size,
            rooms,
        })
    }

    /// Returns the index of the room in column `i` and row `j`.
    pub(crate) fn index(&self, i: i32, j: i32) -> Generated<usize> {
        if i < self.columns && j < self.rows {
            return Ok((j * self.columns + i) as usize);
        }
        Err(GenerationError::Impossible(format!(
            "there is no room in column {i} and row {j}"
        )))
    }

    /// Returns the index of the room that contains `pos`, as minigrid computes it.
    pub(crate) fn index_at(&self, pos: Pos) -> usize {
        let step = self.room_size - 1;
        let (i, j) = (
            (pos.x / step).min(self.columns - 1),
            (pos.y / step).min(self.rows - 1),
        );
        (j * self.columns + i) as usize
    }

    /// Returns the agent's room.
    pub(crate) fn agents_room(&self) -> &Room {
        &self.rooms[self.index_at(self.draft.world.agent)]
    }

    /// Draws the column and row of a room.
    pub(crate) fn random_room(&mut self) -> Generated<(i32, i32)> {
        Ok((
            self.draft.int(0, self.columns)?,
            self.draft.int(0, self.rows)?,
        ))
    }

    /// Whether there is a room behind the wall `wall` of the room `index`.
    pub(crate) fn has_neighbor(&self, index: usize, wall: usize) -> bool {
        self.rooms[index].neighbors[wall].is_some()
    }

    /// Returns the positions of the doors of each room, column by column. A door between two rooms
    /// appears twice.
    pub(crate) fn doors(&self) -> Vec<Pos> {
        let indices = self
            .by_column()
            .map(|(i, j)| (j * self.columns + i) as usize);
        let ways = indices.flat_map(|index| self.rooms[index].ways);
        ways.filter_map(|way| match way {
            Way::Door(pos) => Some(pos),
            Way::Closed | Way::Open => None,
        })
        .collect()
    }

    /// Iterates over the columns and rows of the rooms, column by column.
    pub(crate) fn by_column(&self) -> impl Iterator<Item = (i32, i32)> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        (0..columns).flat_map(move |i| (0..rows).map(move |j| (i, j)))
    }

    /// Places an object in a room, but not next to the agent.
    pub(crate) fn place(&mut self, i: i32, j: i32, cell: Cell) -> Generated<Pos> {
        let index = self.index(i, j)?;
        let accept = |world: &crate::World, pos: Pos| world.agent.distance(pos) >= 2;
        let area = self.rooms[index].area;
        let pos = self.draft.place_if(cell, area, MAX_TRIES, accept)?;
        self.rooms[index].objects.push((cell.kind(), cell.color()));
        Ok(pos)
    }

    /// Places a new object in a room. Draws the kind or colour if it is `None`.
    pub(crate) fn add_object(
        &mut self,
        i: i32,
        j: i32,
        kind: Option<Kind>,
        color: Option<Color>,
    ) -> Generated<Cell> {
        let kind = kind.map_or_else(|| self.draft.pick(&KINDS), Ok)?;
        let color = color.map_or_else(|| self.draft.color(), Ok)?;
        let cell = self.draft.object(kind, color);
        self.place(i, j, cell)?;
        Ok(cell)
    }

    /// Adds a door in a wall of a room. Draws the wall, the colour or `locked` if it is `None`.
    /// Returns the door and its position.
    pub(crate) fn add_door(
        &mut self,
        i: i32,
        j: i32,
        wall: Option<usize>,
        color: Option<Color>,
        locked: Option<bool>,
    ) -> Generated<(Cell, Pos)> {
        let index = self.index(i, j)?;
        let wall = match wall {
            Some(wall) => wall,
            None => loop {
                let wall = self.draft.int(0, 4)? as usize;
                let room = &self.rooms[index];
                if room.neighbors[wall].is_some() && room.ways[wall] == Way::Closed {
                    break wall;
                }
            },
        };
        let color = color.map_or_else(|| self.draft.color(), Ok)?;
        let locked = locked.map_or_else(|| self.draft.bool(), Ok)?;
        let room = &mut self.rooms[index];
        let (Some(neighbor), Way::Closed) = (room.neighbors[wall], room.ways[wall]) else {
            return Err(GenerationError::Impossible(
                "there is no wall for a door".into(),
            ));
        };
        room.locked = locked;
        let pos = room.door_pos[wall];
        room.ways[wall] = Way::Door(pos);
        self.rooms[neighbor].ways[(wall + 2) % 4] = Way::Door(pos);
        let state = if locked { State::Locked } else { State::Closed };
        let door = self.draft.number(Cell::door(color, state));
        self.draft.put(pos, door);
        Ok((door, pos))
    }

    /// Removes the wall between two rooms.
    pub(crate) fn remove_wall(&mut self, i: i32, j: i32, wall: usize) -> Generated {
        let index = self.index(i, j)?;
        let Some(neighbor) = self.rooms[index].neighbors[wall] else {
            return Err(GenerationError::Impossible(
                "there is no wall to remove".into(),
            ));
        };
        let (top, last) = (self.rooms[index].area.top, self.room_size - 1);
        for n in 1..last {
            let offset = [(last, n), (n, last), (0, n), (n, 0)][wall];
            self.draft
                .put(top + Pos::new(offset.0, offset.1), Cell::EMPTY);
        }
        self.rooms[index].ways[wall] = Way::Open;
        self.rooms[neighbor].ways[(wall + 2) % 4] = Way::Open;
        Ok(())
    }

    /// Places the agent in a room, facing an empty cell or a wall. Draws the room if it is `None`.
    ///
    /// # Errors
    /// [`GenerationError::Rejected`] if the room has no such place.
    pub(crate) fn place_agent(&mut self, room: Option<(i32, i32)>) -> Generated {
        let (i, j) = room.map_or_else(|| self.random_room(), Ok)?;
        let area = self.rooms[self.index(i, j)?].area;
        for _ in 0..MAX_POSES {
            self.draft.place_agent_in(area, MAX_TRIES)?;
            let front = self.draft.world.front();
            if front.is_empty() || front.is(Kind::Wall) {
                return Ok(());
            }
        }
        Err(GenerationError::Rejected(
            "the agent faces an object everywhere",
        ))
    }

    /// Adds doors until every room can be reached.
    pub(crate) fn connect_all(&mut self, colors: &[Color]) -> Generated {
        let start = self.index_at(self.draft.world.agent);
        for _ in 0..=MAX_DOORS {
            if self.all_reached_from(start) {
                return Ok(());
            }
            let (i, j) = self.random_room()?;
            let wall = self.draft.int(0, 4)? as usize;
            let room = &self.rooms[self.index(i, j)?];
            let Some(neighbor) = room.neighbors[wall] else {
                continue;
            };
            if room.ways[wall] != Way::Closed || room.locked || self.rooms[neighbor].locked {
                continue;
            }
            let color = self.draft.pick(colors)?;
            self.add_door(i, j, Some(wall), Some(color), Some(false))?;
        }
        Err(GenerationError::Rejected(
            "the rooms could not be connected",
        ))
    }

    fn all_reached_from(&self, start: usize) -> bool {
        let mut reached = vec![false; self.rooms.len()];
        let mut stack = vec![start];
        while let Some(index) = stack.pop() {
            if std::mem::replace(&mut reached[index], true) {
                continue;
            }
            let room = &self.rooms[index];
            let ways = room.ways.iter().zip(room.neighbors);
            stack.extend(ways.filter_map(|(way, next)| next.filter(|_| *way != Way::Closed)));
        }
        reached.into_iter().all(|reached| reached)
    }

    /// Places `count` random objects, in the given room or each in a random room. If `unique`, the
    /// new objects differ from each other and from all other objects.
    pub(crate) fn add_distractors(
        &mut self,
        room: Option<(i32, i32)>,
        count: u32,
        unique: bool,
    ) -> Generated<Vec<Cell>> {
        let mut known: Vec<(Kind, Color)> = self
            .rooms
            .iter()
            .flat_map(|room| room.objects.clone())
            .collect();
        let mut added = Vec::new();
        while added.len() < count as usize {
            let color = self.draft.color()?;
            let kind = self.draft.pick(&KINDS)?;
            if unique && known.contains(&(kind, color)) {
                continue;
            }
            let (i, j) = room.map_or_else(|| self.random_room(), Ok)?;
            added.push(self.add_object(i, j, Some(kind), Some(color))?);
            known.push((kind, color));
        }
        Ok(added)
    }

    /// Puts a ball in front of a door, in the room whose wall has the door.
    pub(crate) fn block(&mut self, door: Pos, wall: usize, color: Color) {
        let ball = self.draft.object(Kind::Ball, color);
        self.draft.put(door - DIRECTIONS[wall], ball);
    }
}
