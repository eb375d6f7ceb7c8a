//! Descriptions of objects, such as "a red ball on your left".

use serde::{Deserialize, Serialize};

use crate::draft::Area;
use crate::view::DIRECTIONS;
use crate::{Cell, Color, Kind, Pos, World};

/// The direction of an object from the agent's initial pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the places explain themselves")]
pub enum Loc {
    Left,
    Right,
    Front,
    Behind,
}

impl Loc {
    pub(crate) const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Front, Self::Behind];

    fn words(self) -> &'static str {
        match self {
            Self::Left => " on your left",
            Self::Right => " on your right",
            Self::Front => " in front of you",
            Self::Behind => " behind you",
        }
    }
}

/// A description of objects: kind, colour and location, each optional.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Desc {
    kind: Option<Kind>,
    color: Option<Color>,
    loc: Option<Loc>,
    /// The numbers of the objects that fit the description.
    objects: Vec<u16>,
    /// The positions of these objects when the agent last dropped an object.
    pub(crate) places: Vec<Pos>,
}

impl Desc {
    pub(crate) fn new(kind: Option<Kind>, color: Option<Color>, loc: Option<Loc>) -> Self {
        Self {
            kind,
            color,
            loc,
            objects: Vec::new(),
            places: Vec::new(),
        }
    }

    /// Describes objects of the kind of `cell`.
    pub(crate) fn kind(cell: Cell) -> Self {
        Self::new(Some(cell.kind()), None, None)
    }

    /// Describes objects of the kind and colour of `cell`.
    pub(crate) fn of(cell: Cell) -> Self {
        Self::new(Some(cell.kind()), Some(cell.color()), None)
    }

    /// Whether the description names a key of one of the colours.
    pub(crate) fn is_key_of(&self, colors: &[Color]) -> bool {
        self.kind == Some(Kind::Key) && self.color.is_some_and(|color| colors.contains(&color))
    }

    fn fits(&self, cell: Cell) -> bool {
        !cell.is_empty()
            && self.kind.is_none_or(|kind| cell.is(kind))
            && self.color.is_none_or(|color| cell.color() == color)
    }

    /// Whether `pos` is in the agent's room `room`, in the direction `loc` from the agent.
    fn is_there(&self, world: &World, room: Area, pos: Pos) -> bool {
        let Some(loc) = self.loc else {
            return true;
        };
        let Pos { x, y } = pos - world.agent;
        let forward = DIRECTIONS[usize::from(world.direction) % 4];
        let ahead = x * forward.x + y * forward.y;
        let right = y * forward.x - x * forward.y;
        room.contains(pos)
            && match loc {
                Loc::Left => right < 0,
                Loc::Right => right > 0,
                Loc::Front => ahead > 0,
                Loc::Behind => ahead < 0,
            }
    }

    /// Finds the objects that fit the description. `room` is the agent's room.
    pub(crate) fn find(&mut self, world: &World, room: Area) {
        self.objects.clear();
        self.places.clear();
        for (pos, cell) in world.grid.by_column() {
            if self.fits(cell) && self.is_there(world, room, pos) {
                self.objects.push(cell.id());
                self.places.push(pos);
            }
        }
    }

    /// Updates `places`, the positions of the objects.
    pub(crate) fn update(&mut self, world: &World) {
        let mut places = std::mem::take(&mut self.places);
        places.clear();
        for (pos, cell) in world.grid.by_column() {
            if self.is(cell) && self.fits(cell) {
                places.push(pos);
            }
        }
        self.places = places;
    }

    /// Whether `cell` is one of the objects.
    pub(crate) fn is(&self, cell: Cell) -> bool {
        cell.id() != 0 && self.objects.contains(&cell.id())
    }

    /// Returns the number of objects.
    pub(crate) fn count(&self) -> usize {
        self.objects.len()
    }

    /// Whether an object fits both descriptions.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.objects.iter().any(|id| other.objects.contains(id))
    }

    /// Whether one of the objects is next to `pos`.
    pub(crate) fn is_next_to(&self, pos: Pos) -> bool {
        self.places.iter().any(|place| place.distance(pos) == 1)
    }

    /// Whether one of the objects is next to an object of the description `other`.
    pub(crate) fn any_next_to(&self, other: &Self) -> bool {
        self.places.iter().any(|place| other.is_next_to(*place))
    }

    pub(crate) fn words(&self) -> String {
        let article = if self.objects.len() > 1 { "a" } else { "the" };
        let color = self
            .color
            .map_or_else(String::new, |color| format!("{} ", color.name()));
        let kind = self.kind.map_or("object", Kind::name);
        format!("{article} {color}{kind}{}", self.loc.map_or("", Loc::words))
    }

    pub(crate) fn is_valid(&self, world: &World) -> bool {
        self.objects.iter().all(|id| usize::from(*id) <= world.things.len())
            && self.places.iter().all(|pos| world.grid.contains(*pos))
            // (so that `update` does not allocate)
            && self.places.len() <= self.objects.len()
    }
}
