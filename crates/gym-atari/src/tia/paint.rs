//! From the pixels of objects to colours and collisions.

use serde::{Deserialize, Serialize};

use super::pixels::{Pixels, WIDTH, window};
use super::{OBJECTS, PF};

/// The pixels of each object on a line: `P0`, `P1`, `M0`, `M1`, `BL`, `PF`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Objects(pub(super) [Pixels; OBJECTS]);

/// What decides about colours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors {
    pub(super) p0: u8,
    pub(super) p1: u8,
    pub(super) pf: u8,
    pub(super) bk: u8,
    /// `CTRLPF` bit 2: the playfield goes before the players.
    pub(super) playfield_first: bool,
    /// `CTRLPF` bit 1: the playfield's halves have the colours of the players.
    pub(super) score: bool,
}

/// Collision registers in the order of their addresses, two bits each: bit 7 of a register is the upper one.
fn pairs([p0, p1, m0, m1, bl, pf]: [u64; 6]) -> u16 {
    [
        (m0 & p0, m0 & p1), // CXM0P
        (m1 & p1, m1 & p0), // CXM1P
        (p0 & bl, p0 & pf), // CXP0FB
        (p1 & bl, p1 & pf), // CXP1FB
        (m0 & bl, m0 & pf), // CXM0FB
        (m1 & bl, m1 & pf), // CXM1FB
        (0, bl & pf),       // CXBLPF
        (m0 & m1, p0 & p1), // CXPPMM
    ]
    .iter()
    .rev()
    .fold(0, |bits, &(six, seven)| bits << 2 | u16::from(seven != 0) << 1 | u16::from(six != 0))
}

impl Objects {
    fn word(&self, word: usize) -> [u64; OBJECTS] {
        self.0.map(|pixels| pixels.0[word])
    }

    /// Whether nothing but the playfield is on the line.
    pub(super) fn only_playfield(&self) -> bool {
        let [movable @ .., _] = &self.0;
        movable.iter().all(|pixels| *pixels == Pixels::default())
    }

    /// The collisions within a window.
    pub(super) fn collisions(&self, window: Pixels) -> u16 {
        let mut found = 0;
        for (word, window) in window.0.into_iter().enumerate() {
            let objects = self.word(word);
            let (mut once, mut twice) = (0, 0);
            for object in objects {
                twice |= once & object;
                once |= object;
            }
            if twice & window != 0 {
                found |= pairs(objects.map(|object| object & window));
            }
        }
        found
    }

    /// Paints `from..to` of a row, which is not empty: background and playfield in cells of eight pixels, the others
    /// where they are.
    pub(super) fn paint(&self, row: &mut [u8; WIDTH], from: usize, to: usize, colors: &Colors) {
        let cells = row.as_chunks_mut::<8>().0;
        let (first, last) = (from / 8, (to - 1) / 8);
        let (before, after) = (cells[first], cells[last]);

        let playfield = self.0[PF].bytes();
        if colors.score {
            let half = WIDTH / 16;
            let middle = half.clamp(first, last + 1);
            paint_playfield(&mut cells[first..middle], &playfield[first..middle], colors.bk, colors.p0);
            paint_playfield(&mut cells[middle..=last], &playfield[middle..=last], colors.bk, colors.p1);
        } else {
            paint_playfield(&mut cells[first..=last], &playfield[first..=last], colors.bk, colors.pf);
        }
        let window = window(8 * first, 8 * last + 8);
        for (word, window) in window.0.into_iter().enumerate() {
            let [p0, p1, m0, m1, bl, pf] = self.word(word);
            let (zero, one) = (p0 | m0, p1 | m1);
            if zero | one | bl == 0 {
                continue;
            }
            let hidden = if colors.playfield_first { pf | bl } else { 0 };
            let cells = &mut cells[8 * word..];
            paint_over(cells, bl & !pf & window, colors.pf);
            paint_over(cells, one & !hidden & window, colors.p1);
            paint_over(cells, zero & !hidden & window, colors.p0);
        }

        // what lies outside stays
        merge(&mut cells[first], before, (1 << (8 * (from - 8 * first))) - 1);
        merge(&mut cells[last], after, !(u64::MAX >> (8 * (8 * last + 8 - to))));
    }
}

/// Eight pixels.
type Cell = [u8; 8];

/// Eight pixels of one colour.
fn solid(color: u8) -> u64 {
    u64::from(color) * 0x0101_0101_0101_0101
}

/// Fills cells with the background and, where a bit is set, with the playfield.
fn paint_playfield(cells: &mut [Cell], playfield: &[u8], background: u8, color: u8) {
    let background = solid(background);
    let difference = background ^ solid(color);
    for (cell, &bits) in cells.iter_mut().zip(playfield) {
        *cell = (background ^ EXPANDED[usize::from(bits)] & difference).to_le_bytes();
    }
}

/// Gives pixels a colour.
fn paint_over(cells: &mut [Cell], mut pixels: u64, color: u8) {
    let color = solid(color);
    while pixels != 0 {
        let group = pixels.trailing_zeros() / 8;
        let mask = EXPANDED[(pixels >> (8 * group)) as usize & 0xff];
        let cell = &mut cells[group as usize];
        *cell = (u64::from_le_bytes(*cell) & !mask | color & mask).to_le_bytes();
        pixels &= !(0xff << (8 * group));
    }
}

/// Puts back what a mask of bytes covers.
fn merge(cell: &mut Cell, back: Cell, mask: u64) {
    *cell = (u64::from_le_bytes(*cell) & !mask | u64::from_le_bytes(back) & mask).to_le_bytes();
}

/// Bits as bytes: `00` or `FF`.
static EXPANDED: [u64; 256] = {
    let mut table = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let mut bit = 0;
        while bit < 8 {
            if bits >> bit & 1 == 1 {
                table[bits] |= 0xff << (8 * bit);
            }
            bit += 1;
        }
        bits += 1;
    }
    table
};
