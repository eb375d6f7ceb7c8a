//! From the pixels of objects to colours and collisions.

use serde::{Deserialize, Serialize};

use super::pixels::{Pixels, WIDTH};

/// The pixels of each object on a line.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Objects {
    pub(super) p0: Pixels,
    pub(super) p1: Pixels,
    pub(super) m0: Pixels,
    pub(super) m1: Pixels,
    pub(super) bl: Pixels,
    pub(super) pf: Pixels,
}

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

/// The bits of word `word` that lie in `from..to`.
fn window(word: usize, from: usize, to: usize) -> u64 {
    let clamp = |x: usize| x.saturating_sub(64 * word).min(64) as u32;
    let below = |x: u32| if x == 64 { u64::MAX } else { (1 << x) - 1 };
    below(clamp(to)) & !below(clamp(from))
}

impl Objects {
    fn word(&self, word: usize) -> [u64; 6] {
        [self.p0, self.p1, self.m0, self.m1, self.bl, self.pf].map(|pixels| pixels.0[word])
    }

    /// Whether nothing but the playfield is on the line.
    pub(super) fn only_playfield(&self) -> bool {
        [self.p0, self.p1, self.m0, self.m1, self.bl].iter().all(|pixels| pixels.0 == [0; 3])
    }

    /// The collisions within `from..to`.
    pub(super) fn collisions(&self, from: usize, to: usize) -> u16 {
        let mut found = 0;
        for word in from / 64..to.div_ceil(64) {
            let window = window(word, from, to);
            let [p0, p1, m0, m1, bl, pf] = self.word(word).map(|bits| bits & window);
            // two objects at least, one of which is not the playfield
            if p0 | p1 | m0 | m1 | bl != 0 {
                found |= pairs([p0, p1, m0, m1, bl, pf]);
            }
        }
        found
    }

    /// Paints `from..to` of a row.
    pub(super) fn paint(&self, row: &mut [u8; WIDTH], from: usize, to: usize, colors: &Colors) {
        for word in from / 64..to.div_ceil(64) {
            let window = window(word, from, to);
            let [p0, p1, m0, m1, bl, pf] = self.word(word);
            let (zero, one) = (p0 | m0, p1 | m1);
            for group in 8 * word..(8 * word + 8).min(WIDTH / 8) {
                let shift = 8 * (group % 8);
                let byte = |bits: u64| EXPANDED[(bits >> shift) as usize & 0xff];
                let inside = byte(window);
                if inside == 0 {
                    continue;
                }
                let playfield = match (colors.score, group < WIDTH / 16) {
                    (false, _) => colors.pf,
                    (true, true) => colors.p0,
                    (true, false) => colors.p1,
                };
                let mut painted = solid(colors.bk);
                let mut over = |mask: u64, color: u8| painted = painted & !mask | solid(color) & mask;
                if colors.playfield_first {
                    over(byte(one), colors.p1);
                    over(byte(zero), colors.p0);
                    over(byte(bl), colors.pf);
                    over(byte(pf), playfield);
                } else {
                    over(byte(bl), colors.pf);
                    over(byte(pf), playfield);
                    over(byte(one), colors.p1);
                    over(byte(zero), colors.p0);
                }
                let cells: &mut [u8; 8] = (&mut row[8 * group..8 * group + 8]).try_into().expect("8 bytes");
                let before = u64::from_le_bytes(*cells);
                *cells = (before & !inside | painted & inside).to_le_bytes();
            }
        }
    }
}

/// Eight pixels of one colour.
fn solid(color: u8) -> u64 {
    u64::from(color) * 0x0101_0101_0101_0101
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
