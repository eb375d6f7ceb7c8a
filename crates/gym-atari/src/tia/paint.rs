//! From the objects' pixels to colours and collisions.

use serde::{Deserialize, Serialize};

use super::pixels::Pixels;
use super::{BL, M0, M1, OBJECTS, P0, P1, PF};
use crate::screen::WIDTH;

/// The pixels of each object on a line: `P0`, `P1`, `M0`, `M1`, `BL`, `PF`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Objects {
    pixels: [Pixels; OBJECTS],
    /// A bit for each object that has pixels.
    present: u8,
}

/// The registers that decide colours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors {
    pub(super) p0: u8,
    pub(super) p1: u8,
    pub(super) pf: u8,
    pub(super) bk: u8,
    /// `CTRLPF` bit 2: the playfield is drawn over the players.
    pub(super) playfield_first: bool,
    /// `CTRLPF` bit 1: the halves of the playfield have the players' colours.
    pub(super) score: bool,
}

/// The two objects of each collision bit: bits 6 and 7 of each register, in the order of addresses.
const PAIRS: [[usize; 2]; 16] = [
    [M0, P0], // CXM0P
    [M0, P1],
    [M1, P1], // CXM1P
    [M1, P0],
    [P0, BL], // CXP0FB
    [P0, PF],
    [P1, BL], // CXP1FB
    [P1, PF],
    [M0, BL], // CXM0FB
    [M0, PF],
    [M1, BL], // CXM1FB
    [M1, PF],
    [BL, BL], // CXBLPF, which has no bit 6
    [BL, PF],
    [M0, M1], // CXPPMM
    [P0, P1],
];

/// The possible collisions for each set of objects that have pixels.
static POSSIBLE: [u16; 1 << OBJECTS] = {
    let mut table = [0; 1 << OBJECTS];
    let mut present = 0;
    while present < table.len() {
        let mut bit = 0;
        while bit < PAIRS.len() {
            let [a, b] = PAIRS[bit];
            if a != b && present >> a & present >> b & 1 == 1 {
                table[present] |= 1 << bit;
            }
            bit += 1;
        }
        present += 1;
    }
    table
};

/// The collisions that involve each object.
static INVOLVING: [u16; OBJECTS] = {
    let mut table = [0; OBJECTS];
    let mut bit = 0;
    while bit < PAIRS.len() {
        let [a, b] = PAIRS[bit];
        if a != b {
            table[a] |= 1 << bit;
            table[b] |= 1 << bit;
        }
        bit += 1;
    }
    table
};

impl Objects {
    pub(super) fn get(&self, object: usize) -> Pixels {
        self.pixels[object]
    }

    #[inline(always)]
    pub(super) fn set(&mut self, object: usize, pixels: Pixels) {
        self.pixels[object] = pixels;
        let bit = 1 << object;
        let present = !pixels.is_empty();
        self.present = self.present & !bit | if present { bit } else { 0 };
    }

    /// Whether the line has no object except the playfield.
    pub(super) fn only_playfield(&self) -> bool {
        self.present & !(1 << PF) == 0
    }

    /// Returns a bit for each object that has pixels.
    pub(super) fn present(&self) -> u8 {
        self.present
    }

    /// Returns the collisions that are possible on the line.
    pub(super) fn possible_collisions(&self) -> u16 {
        Self::collisions_of(self.present)
    }

    /// Returns the possible collisions of the objects whose bits are set in `present`.
    pub(super) fn collisions_of(present: u8) -> u16 {
        POSSIBLE[usize::from(present) % POSSIBLE.len()]
    }

    /// Returns a bit for each object that `collisions` involve.
    pub(super) fn with_collisions(collisions: u16) -> u8 {
        (0..OBJECTS).fold(0, |set, object| {
            set | u8::from(collisions & INVOLVING[object] != 0) << object
        })
    }

    /// Returns the collisions among `candidates` within `window`.
    pub(super) fn collisions(&self, candidates: u16, window: Pixels) -> u16 {
        let (mut found, mut left) = (0, candidates);
        while left != 0 {
            let bit = left.trailing_zeros() as usize % PAIRS.len();
            let [a, b] = PAIRS[bit];
            let (a, b) = (self.pixels[a].0, self.pixels[b].0);
            let overlap = |word: usize| a[word] & b[word] & window.0[word];
            if overlap(0) | overlap(1) | overlap(2) != 0 {
                found |= 1 << bit;
            }
            left &= left - 1;
        }
        found
    }

    /// Paints `pixels` of a row: background and playfield, then the movable objects.
    pub(super) fn paint(&self, row: &mut [u8; WIDTH], pixels: Pixels, colors: &Colors) {
        let (cells, _) = row.as_chunks_mut::<8>();
        for (word, (cells, pixels)) in cells.chunks_mut(8).zip(pixels.0).enumerate() {
            if pixels == 0 {
                continue;
            }
            let [p0, p1, m0, m1, bl, pf] =
                [P0, P1, M0, M1, BL, PF].map(|object| self.pixels[object].0[word]);
            let [left, right] = if colors.score {
                [colors.p0, colors.p1]
            } else {
                [colors.pf; 2]
            };
            // the second word contains the middle of the line
            let playfield = match word {
                0 => [left; 2],
                1 => [left, right],
                _ => [right; 2],
            };
            if pf & pixels != 0 {
                paint_playfield(cells, pixels, pf, colors.bk, playfield);
            } else if pixels == Pixels::ALL.0[word] {
                cells.fill([colors.bk; 8]);
            } else {
                paint_over(cells, pixels, colors.bk);
            }
            if (p0 | m0 | p1 | m1 | bl) & pixels != 0 {
                let ahead = if colors.playfield_first { pf | bl } else { 0 };
                // in score mode, the left half of the playfield has player 0's priority, so the
                // half is drawn over player 1
                let ahead_of_1 = if colors.score {
                    ahead | pf & LEFT_HALF[word]
                } else {
                    ahead
                };
                paint_over(cells, bl & !pf & pixels, colors.pf);
                paint_over(cells, (p1 | m1) & !ahead_of_1 & pixels, colors.p1);
                paint_over(cells, (p0 | m0) & !ahead & pixels, colors.p0);
            }
        }
    }
}

/// The left half of the line.
const LEFT_HALF: [u64; 3] = [u64::MAX, 0xffff, 0];

/// Eight pixels.
type Cell = [u8; 8];

/// Returns eight pixels of one colour.
fn solid(color: u8) -> u64 {
    u64::from(color) * 0x0101_0101_0101_0101
}

/// Sets pixels to the background colour, and pixels whose bit in `playfield` is set to the
/// playfield colour: `colors[0]` in the first two cells, `colors[1]` in the others.
#[inline(always)]
fn paint_playfield(
    cells: &mut [Cell],
    mut pixels: u64,
    playfield: u64,
    background: u8,
    colors: [u8; 2],
) {
    let background = solid(background);
    let differences = colors.map(|color| background ^ solid(color));
    while pixels != 0 {
        let group = pixels.trailing_zeros() / 8;
        let difference = differences[usize::from(group >= 2)];
        let color = background ^ EXPANDED[(playfield >> (8 * group)) as usize & 0xff] & difference;
        let mask = EXPANDED[(pixels >> (8 * group)) as usize & 0xff];
        merge(&mut cells[group as usize], color, mask);
        pixels &= !(0xff << (8 * group));
    }
}

/// Sets the pixels whose bits are set to `color`.
#[inline(always)]
fn paint_over(cells: &mut [Cell], mut pixels: u64, color: u8) {
    let color = solid(color);
    while pixels != 0 {
        let group = pixels.trailing_zeros() / 8;
        let mask = EXPANDED[(pixels >> (8 * group)) as usize & 0xff];
        merge(&mut cells[group as usize], color, mask);
        pixels &= !(0xff << (8 * group));
    }
}

/// Replaces the bytes of a cell that `mask` covers by those of `values`.
#[inline(always)]
fn merge(cell: &mut Cell, values: u64, mask: u64) {
    *cell = (u64::from_le_bytes(*cell) & !mask | values & mask).to_le_bytes();
}

/// Each byte with its bits expanded to bytes: `00` or `FF`.
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
