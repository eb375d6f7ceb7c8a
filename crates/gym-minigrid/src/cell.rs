//! Cells of the grid: object, colour and state.

use gym_core::ArgumentType;
use serde::{Deserialize, Serialize};

gym_core::discrete! {
    /// The kind of an object, with minigrid's numbers.
    #[derive(PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Kind {
        /// A cell that the agent does not see.
        Unseen,
        /// An empty cell.
        Empty,
        /// A wall, which blocks the way and the view.
        Wall,
        /// A coloured floor.
        Floor,
        /// A door: open, closed or locked.
        Door,
        /// A key, which opens locked doors of its colour.
        Key,
        /// A ball.
        Ball,
        /// A box, which may contain an object.
        Box,
        /// The goal, which ends the episode.
        Goal,
        /// Lava, which ends the episode without a reward.
        Lava,
        /// The agent, in views of the whole grid.
        Agent,
    }
}

gym_core::discrete! {
    /// A colour, with minigrid's numbers.
    #[derive(PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    #[expect(missing_docs, reason = "the colours explain themselves")]
    pub enum Color { Red, Green, Blue, Purple, Yellow, Grey }
}

gym_core::discrete! {
    /// The state of a door, with minigrid's numbers.
    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum State {
        /// Open: the agent can enter it.
        Open,
        /// Closed: `toggle` opens it.
        Closed,
        /// Locked: `toggle` opens it if the agent carries a key of its colour.
        Locked,
    }
}

impl Kind {
    /// The word for the kind in missions.
    pub const fn name(self) -> &'static str {
        [
            "unseen", "empty", "wall", "floor", "door", "key", "ball", "box", "goal", "lava",
            "agent",
        ][self as usize]
    }
}

impl ArgumentType for Kind {
    fn kind() -> String {
        "name of a kind of object".to_owned()
    }
}

impl Color {
    /// All colours in the order of their names: minigrid's `COLOR_NAMES`.
    pub const SORTED: [Self; 6] = [
        Self::Blue,
        Self::Green,
        Self::Grey,
        Self::Purple,
        Self::Red,
        Self::Yellow,
    ];

    /// The word for the colour in missions.
    pub const fn name(self) -> &'static str {
        ["red", "green", "blue", "purple", "yellow", "grey"][self as usize]
    }

    /// The names of [`SORTED`](Self::SORTED).
    pub fn names() -> Vec<&'static str> {
        Self::SORTED.map(Self::name).to_vec()
    }

    /// Red, green and blue.
    pub const fn rgb(self) -> [u8; 3] {
        match self {
            Self::Red => [255, 0, 0],
            Self::Green => [0, 255, 0],
            Self::Blue => [0, 0, 255],
            Self::Purple => [112, 39, 195],
            Self::Yellow => [255, 255, 0],
            Self::Grey => [100, 100, 100],
        }
    }
}

impl ArgumentType for Color {
    fn kind() -> String {
        "name of a colour".to_owned()
    }
}

/// The content of a cell: kind, colour, state, and the number of the object.
///
/// Objects made by a [`Draft`](crate::Draft) have numbers from 1 on, so that two red balls differ;
/// other cells have the number 0.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Cell(u32);

impl Cell {
    /// An empty cell.
    pub const EMPTY: Self = Self::new(Kind::Empty, Color::Red);
    /// A grey wall.
    pub const WALL: Self = Self::new(Kind::Wall, Color::Grey);
    /// A green goal.
    pub const GOAL: Self = Self::new(Kind::Goal, Color::Green);
    /// Lava.
    pub const LAVA: Self = Self::new(Kind::Lava, Color::Red);

    /// An object with number 0; a door is open.
    pub const fn new(kind: Kind, color: Color) -> Self {
        Self(kind as u32 | (color as u32) << 8)
    }

    /// A door.
    pub const fn door(color: Color, state: State) -> Self {
        Self::new(Kind::Door, color).with_state(state)
    }

    /// The same object in another state.
    #[must_use]
    pub const fn with_state(self, state: State) -> Self {
        Self(self.0 & !0xf000 | (state as u32) << 12)
    }

    /// The same object in another colour.
    #[must_use]
    pub const fn with_color(self, color: Color) -> Self {
        Self(self.0 & !0xf00 | (color as u32) << 8)
    }

    pub(crate) const fn with_id(self, id: u16) -> Self {
        Self(self.0 & 0xffff | (id as u32) << 16)
    }

    /// The number of the object; 0 if it is not a numbered object.
    pub const fn id(self) -> u16 {
        (self.0 >> 16) as u16
    }

    /// The kind.
    pub fn kind(self) -> Kind {
        Kind::ALL[(self.0 & 0xff) as usize % Kind::ALL.len()]
    }

    /// The colour.
    pub fn color(self) -> Color {
        Color::ALL[(self.0 >> 8 & 0xf) as usize % Color::ALL.len()]
    }

    /// Whether the cell has this kind.
    #[inline]
    pub const fn is(self, kind: Kind) -> bool {
        self.0 & 0xff == kind as u32
    }

    /// Whether the cell is empty.
    #[inline]
    pub const fn is_empty(self) -> bool {
        self.is(Kind::Empty)
    }

    /// Whether the cell is a door in this state.
    #[inline]
    pub const fn is_door(self, state: State) -> bool {
        self.0 & 0xf0ff == Kind::Door as u32 | (state as u32) << 12
    }

    /// Kind, colour and state as in an observation.
    #[inline]
    pub const fn encode(self) -> [u8; 3] {
        [
            self.0 as u8,
            (self.0 >> 8 & 0xf) as u8,
            (self.0 >> 12 & 0xf) as u8,
        ]
    }

    /// Whether the agent can enter the cell.
    pub fn can_overlap(self) -> bool {
        matches!(
            self.kind(),
            Kind::Empty | Kind::Floor | Kind::Goal | Kind::Lava
        ) || self.is_door(State::Open)
    }

    /// Whether the agent can pick the object up.
    pub fn can_pickup(self) -> bool {
        matches!(self.kind(), Kind::Key | Kind::Ball | Kind::Box)
    }

    /// Whether the agent can see past the cell.
    #[inline]
    pub const fn see_behind(self) -> bool {
        !self.is(Kind::Wall) && (!self.is(Kind::Door) || self.is_door(State::Open))
    }

    /// Kind and colour in two letters, as minigrid's `pprint_grid` writes them.
    pub(crate) fn letters(self) -> [char; 2] {
        let color = self.color().name().to_ascii_uppercase();
        let color = color.chars().next().unwrap_or(' ');
        match self.kind() {
            Kind::Unseen | Kind::Empty | Kind::Agent => [' ', ' '],
            Kind::Wall => ['W', color],
            Kind::Floor => ['F', color],
            Kind::Door if self.is_door(State::Open) => ['_', '_'],
            Kind::Door if self.is_door(State::Locked) => ['L', color],
            Kind::Door => ['D', color],
            Kind::Key => ['K', color],
            Kind::Ball => ['A', color],
            Kind::Box => ['B', color],
            Kind::Goal => ['G', color],
            Kind::Lava => ['V', color],
        }
    }

    /// Whether the cell is valid on a grid with `objects` numbered objects.
    pub(crate) fn is_valid(self, objects: usize) -> bool {
        let [kind, color, state] = self.encode().map(usize::from);
        (1..Kind::Agent as usize).contains(&kind)
            && color < Color::ALL.len()
            && state <= State::Locked as usize
            && usize::from(self.id()) <= objects
    }
}

impl std::fmt::Debug for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (color, kind) = (self.color().name(), self.kind().name());
        write!(f, "{color} {kind} {}", self.id())
    }
}
