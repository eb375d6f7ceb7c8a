//! A rectangle of cells.

use serde::{Deserialize, Serialize};

use crate::Cell;

/// A position: column and row from the top left. It can lie outside the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Pos {
    /// The column.
    pub x: i32,
    /// The row.
    pub y: i32,
}

impl Pos {
    /// The position in column `x` and row `y`.
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// The number of steps between two positions.
    pub const fn distance(self, other: Self) -> i32 {
        (self.x - other.x).abs() + (self.y - other.y).abs()
    }

    /// Whether `other` is this position or one of the eight around it.
    pub const fn is_near(self, other: Self) -> bool {
        (self.x - other.x).abs() <= 1 && (self.y - other.y).abs() <= 1
    }
}

impl std::ops::Add for Pos {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl std::ops::Sub for Pos {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl std::ops::Mul<i32> for Pos {
    type Output = Self;

    fn mul(self, n: i32) -> Self {
        Self::new(self.x * n, self.y * n)
    }
}

impl From<[u32; 2]> for Pos {
    fn from([x, y]: [u32; 2]) -> Self {
        let number = |n: u32| i32::try_from(n).unwrap_or(i32::MAX);
        Self::new(number(x), number(y))
    }
}

/// The cells of a world. Cells outside the grid are walls.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grid {
    width: i32,
    height: i32,
    cells: Vec<Cell>,
}

impl Grid {
    /// The largest width and height.
    pub const MAX_SIDE: u32 = 255;

    /// Makes an empty grid.
    pub(crate) fn new(width: i32, height: i32) -> Self {
        Self {
            width,
            height,
            cells: vec![Cell::EMPTY; (width * height) as usize],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.cells.fill(Cell::EMPTY);
    }

    /// The number of columns.
    pub fn width(&self) -> i32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> i32 {
        self.height
    }

    /// The cells, row by row.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    fn index(&self, Pos { x, y }: Pos) -> Option<usize> {
        let inside = (x as u32) < self.width as u32 && (y as u32) < self.height as u32;
        inside.then(|| (y * self.width + x) as usize)
    }

    /// Whether the position lies on the grid.
    pub fn contains(&self, pos: Pos) -> bool {
        self.index(pos).is_some()
    }

    /// The cell at a position.
    #[inline]
    pub fn get(&self, pos: Pos) -> Cell {
        match self.index(pos) {
            Some(index) => self.cells[index],
            None => Cell::WALL,
        }
    }

    /// Sets the cell at a position; a position outside the grid is ignored.
    pub fn set(&mut self, pos: Pos, cell: Cell) {
        if let Some(index) = self.index(pos) {
            self.cells[index] = cell;
        }
    }

    /// All positions with their cells, column by column: the order in which minigrid searches for
    /// objects.
    pub fn by_column(&self) -> impl Iterator<Item = (Pos, Cell)> + '_ {
        let places = (0..self.width).flat_map(|x| (0..self.height).map(move |y| Pos::new(x, y)));
        places.map(|pos| (pos, self.get(pos)))
    }

    /// Sets `length` cells from `(x, y)` to the right.
    pub fn horizontal(&mut self, x: i32, y: i32, length: i32, cell: Cell) {
        (x..x + length).for_each(|x| self.set(Pos::new(x, y), cell));
    }

    /// Sets `length` cells from `(x, y)` down.
    pub fn vertical(&mut self, x: i32, y: i32, length: i32, cell: Cell) {
        (y..y + length).for_each(|y| self.set(Pos::new(x, y), cell));
    }

    /// Adds walls along the edges of a rectangle.
    pub fn wall_rect(&mut self, x: i32, y: i32, width: i32, height: i32) {
        self.horizontal(x, y, width, Cell::WALL);
        self.horizontal(x, y + height - 1, width, Cell::WALL);
        self.vertical(x, y, height, Cell::WALL);
        self.vertical(x + width - 1, y, height, Cell::WALL);
    }

    /// Adds walls along the edges of the grid.
    pub fn surround(&mut self) {
        self.wall_rect(0, 0, self.width, self.height);
    }

    /// Whether a stored grid has this size, and at most `objects` numbered objects.
    pub(crate) fn is_valid(&self, width: i32, height: i32, objects: usize) -> bool {
        (self.width, self.height) == (width, height)
            && self.cells.len() == (width * height) as usize
            && self.cells.iter().all(|cell| cell.is_valid(objects))
    }
}
