//! The agent's view: a square of cells in front of it, rotated so that the agent faces up.

use crate::{Cell, Grid, Kind, Pos};

/// The largest width of a view.
pub(crate) const MAX_VIEW: u32 = 63;

/// The directions that an agent can face, clockwise from the right.
pub(crate) const DIRECTIONS: [Pos; 4] = [
    Pos::new(1, 0),
    Pos::new(0, 1),
    Pos::new(-1, 0),
    Pos::new(0, -1),
];

/// The square that the agent sees. The square is `size` cells wide; the agent is in the middle of
/// the last row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) size: i32,
    /// The position of the view's top left corner.
    corner: Pos,
    forward: Pos,
    right: Pos,
}

impl View {
    pub(crate) fn new(agent: Pos, direction: u8, size: i32) -> Self {
        let forward = DIRECTIONS[usize::from(direction) % 4];
        let right = Pos::new(-forward.y, forward.x);
        Self {
            size,
            corner: agent + forward * (size - 1) - right * (size / 2),
            forward,
            right,
        }
    }

    /// Returns the position of the view's column `i` and row `j` on the grid.
    pub(crate) fn place(&self, i: i32, j: i32) -> Pos {
        self.corner - self.forward * j + self.right * i
    }

    /// Iterates over the cells of the view's row `j`.
    fn row(&self, grid: &Grid, j: i32) -> impl Iterator<Item = Cell> {
        let (start, right) = (self.place(0, j), self.right);
        (0..self.size).map(move |i| grid.get(start + right * i))
    }

    /// Returns for each row the columns that the agent sees, as bits. As in minigrid's
    /// `process_vis`, light enters a row from the row below, and spreads sideways through
    /// transparent cells.
    pub(crate) fn visible(&self, grid: &Grid, see_through_walls: bool) -> [u64; 64] {
        let size = self.size as usize;
        let all = u64::MAX >> (64 - size);
        let mut rows = [all; 64];
        if see_through_walls {
            return rows;
        }
        let mut lit = 1 << (size / 2);
        for j in (0..size).rev() {
            let mut clear = 0;
            for (i, cell) in self.row(grid, j as i32).enumerate() {
                clear |= u64::from(cell.see_behind()) << i;
            }
            // no light goes to the right of the last column, or to the left of the first column
            let right = spread(lit, clear & (all >> 1), |bits| bits << 1) & clear & (all >> 1);
            lit |= right | right << 1;
            let left = spread(lit, clear & !1, |bits| bits >> 1) & clear & !1;
            lit |= left | left >> 1;
            rows[j] = lit;
            lit = right | right << 1 | left | left >> 1;
        }
        rows
    }

    /// Writes kind, colour and state of each visible cell, column by column.
    pub(crate) fn write(&self, grid: &Grid, visible: &[u64; 64], carried: Cell, image: &mut [u8]) {
        let size = self.size as usize;
        image.fill(Kind::Unseen as u8);
        for (j, &lit) in visible.iter().enumerate().take(size) {
            if lit == 0 {
                continue;
            }
            for (i, cell) in self.row(grid, j as i32).enumerate() {
                if lit >> i & 1 == 1 {
                    let at = 3 * (i * size + j);
                    image[at..at + 3].copy_from_slice(&cell.encode());
                }
            }
        }
        // the agent's own cell shows the object that it carries
        let own = 3 * ((size / 2) * size + size - 1);
        image[own..own + 3].copy_from_slice(&carried.encode());
    }
}

/// Returns the columns `lit`, and the columns that light reaches from them through transparent
/// cells (`clear`), one column per `shift`.
fn spread(lit: u64, clear: u64, shift: impl Fn(u64) -> u64) -> u64 {
    let mut lit = lit;
    loop {
        let more = lit | shift(lit & clear);
        if more == lit {
            return lit;
        }
        lit = more;
    }
}
