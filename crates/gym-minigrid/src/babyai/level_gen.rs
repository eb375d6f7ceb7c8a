//! Levels with random instructions: BabyAI's `LevelGen`.

use super::{Desc, Instr, Loc, check_reachable};
use crate::rooms::Rooms;
use crate::{Color, Generated, GenerationError, Kind};

/// What a single instruction asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verb {
    GoTo,
    Pickup,
    Open,
    PutNext,
}

/// The kinds of instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Single,
    And,
    Sequence,
}

const ANY: [Kind; 4] = [Kind::Box, Kind::Ball, Kind::Key, Kind::Door];

/// The number of attempts to find an object for a description.
const MAX_TRIES: u32 = 100;

/// The arguments that differ between the levels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevelGen {
    pub(crate) distractors: u32,
    pub(crate) locked_room_probability: f64,
    pub(crate) locations: bool,
    pub(crate) unblocking: bool,
    pub(crate) implicit_unlock: bool,
    pub(crate) verbs: &'static [Verb],
    pub(crate) forms: &'static [Form],
}

impl LevelGen {
    /// BabyAI's default values.
    pub(crate) const DEFAULT: Self = Self {
        distractors: 18,
        locked_room_probability: 0.5,
        locations: true,
        unblocking: true,
        implicit_unlock: true,
        verbs: &[Verb::GoTo, Verb::Pickup, Verb::Open, Verb::PutNext],
        forms: &[Form::Single, Form::And, Form::Sequence],
    };

    pub(crate) fn make(&self, rooms: &mut Rooms<'_, '_>) -> Generated<Instr> {
        let locked = if rooms.draft.float() < self.locked_room_probability {
            Some(add_locked_room(rooms)?)
        } else {
            None
        };
        rooms.connect_all(&Color::SORTED)?;
        rooms.add_distractors(None, self.distractors, false)?;
        loop {
            rooms.place_agent(None)?;
            if Some(rooms.index_at(rooms.draft.world.agent)) != locked {
                break;
            }
        }
        if !self.unblocking {
            check_reachable(rooms)?;
        }
        self.instruction(rooms, locked, self.forms)
    }

    fn instruction(
        &self,
        rooms: &mut Rooms<'_, '_>,
        locked: Option<usize>,
        forms: &[Form],
    ) -> Generated<Instr> {
        let two = |rooms: &mut Rooms<'_, '_>, forms: &[Form]| {
            let a = self.instruction(rooms, locked, forms)?;
            Ok((a, self.instruction(rooms, locked, forms)?))
        };
        match rooms.draft.pick(forms)? {
            Form::Single => self.single(rooms, locked),
            Form::And => two(rooms, &[Form::Single]).map(|(a, b)| Instr::and(a, b)),
            Form::Sequence => {
                let (a, b) = two(rooms, &[Form::Single, Form::And])?;
                let join = rooms.draft.pick(&[Instr::before, Instr::after])?;
                Ok(join(a, b))
            }
        }
    }

    fn single(&self, rooms: &mut Rooms<'_, '_>, locked: Option<usize>) -> Generated<Instr> {
        let things = &ANY[..3];
        let verb = rooms.draft.pick(self.verbs)?;
        let mut object = |kinds: &[Kind]| self.object(rooms, locked, kinds);
        Ok(match verb {
            Verb::GoTo => Instr::GoTo(object(&ANY)?),
            Verb::Pickup => Instr::pickup(object(things)?, false),
            Verb::Open => Instr::open(object(&[Kind::Door])?, false),
            Verb::PutNext => Instr::put_next(object(things)?, object(&ANY)?),
        })
    }

    /// Draws descriptions until a description fits an object. If the instruction may not need a
    /// locked room, this object is outside of the locked room `locked`.
    fn object(
        &self,
        rooms: &mut Rooms<'_, '_>,
        locked: Option<usize>,
        kinds: &[Kind],
    ) -> Generated<Desc> {
        let mut colors = vec![None];
        colors.extend(Color::SORTED.map(Some));
        for _ in 0..=MAX_TRIES {
            let color = rooms.draft.pick(&colors)?;
            let kind = rooms.draft.pick(kinds)?;
            let loc = if self.locations && rooms.draft.bool()? {
                Some(rooms.draft.pick(&Loc::ALL)?)
            } else {
                None
            };
            let mut desc = Desc::new(Some(kind), color, loc);
            desc.find(rooms.draft.world, rooms.agents_room().area);
            let within = locked
                .filter(|_| !self.implicit_unlock)
                .map(|index| rooms.rooms[index].area);
            let is_out = |pos: &crate::Pos| within.is_none_or(|area| !area.contains(*pos));
            if desc.places.iter().any(is_out) {
                return Ok(desc);
            }
        }
        Err(GenerationError::Rejected("no object was found"))
    }
}

/// Adds a room behind a locked door, and its key in another room. Returns the index of the room.
fn add_locked_room(rooms: &mut Rooms<'_, '_>) -> Generated<usize> {
    let (locked, door) = loop {
        let (i, j) = rooms.random_room()?;
        let (index, wall) = (rooms.index(i, j)?, rooms.draft.int(0, 4)? as usize);
        if rooms.has_neighbor(index, wall) {
            let (door, _) = rooms.add_door(i, j, Some(wall), None, Some(true))?;
            break (index, door);
        }
    };
    loop {
        let (i, j) = rooms.random_room()?;
        if rooms.index(i, j)? != locked {
            rooms.add_object(i, j, Some(Kind::Key), Some(door.color()))?;
            return Ok(locked);
        }
    }
}
