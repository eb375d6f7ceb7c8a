//! The movable objects and the playfield, as the pixels that they cover on a line.

use super::pixels::Pixels;

/// What the lower three bits of `NUSIZx` select: the offsets of the copies of a player or missile,
/// and the width of a player's pixel.
struct Copies {
    offsets: &'static [u8],
    scale: u8,
}

const COPIES: [Copies; 8] = [
    Copies {
        offsets: &[0],
        scale: 1,
    },
    Copies {
        offsets: &[0, 16],
        scale: 1,
    },
    Copies {
        offsets: &[0, 32],
        scale: 1,
    },
    Copies {
        offsets: &[0, 16, 32],
        scale: 1,
    },
    Copies {
        offsets: &[0, 64],
        scale: 1,
    },
    Copies {
        offsets: &[0],
        scale: 2,
    },
    Copies {
        offsets: &[0, 32, 64],
        scale: 1,
    },
    Copies {
        offsets: &[0],
        scale: 4,
    },
];

fn copies(nusiz: u8) -> &'static Copies {
    &COPIES[usize::from(nusiz & 0x07)]
}

/// Returns the width of a player's pixel: 1, 2 or 4.
pub(super) fn scale(nusiz: u8) -> u8 {
    copies(nusiz).scale
}

/// Returns `x + shift`, wrapped around the line. `x` is below 160 and `shift` between -160 and 160.
pub(super) fn around(x: u8, shift: i32) -> u8 {
    let x = i32::from(x) + shift;
    let x = if x < 0 { x + 160 } else { x };
    (if x >= 160 { x - 160 } else { x }) as u8
}

/// Converts a graphics byte to a pattern whose lowest bit is the leftmost pixel.
fn pattern(graphics: u8, reflected: bool, scale: u8) -> u32 {
    let bits = if reflected {
        graphics
    } else {
        REVERSED[usize::from(graphics)]
    };
    WIDENED[usize::from(scale >> 1)][usize::from(bits)]
}

/// Each byte with its bits reversed.
static REVERSED: [u8; 256] = {
    let mut table = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        table[bits] = (bits as u8).reverse_bits();
        bits += 1;
    }
    table
};

/// Each byte with its bits repeated once, twice and four times.
static WIDENED: [[u32; 256]; 3] = {
    let mut table = [[0; 256]; 3];
    let mut bits = 0;
    while bits < 256 {
        let mut bit = 0;
        while bit < 8 {
            if bits >> bit & 1 == 1 {
                table[0][bits] |= 0x1 << bit;
                table[1][bits] |= 0x3 << (2 * bit);
                table[2][bits] |= 0xf << (4 * bit);
            }
            bit += 1;
        }
        bits += 1;
    }
    table
};

/// Returns the pixels of a player; without its first copy if `without_main` is true.
#[inline(always)]
pub(super) fn player(
    x: u8,
    nusiz: u8,
    graphics: u8,
    reflected: bool,
    without_main: bool,
) -> Pixels {
    let mut pixels = Pixels::default();
    if graphics != 0 {
        let Copies { offsets, scale } = copies(nusiz);
        // a wide player starts one pixel later
        let start = i32::from(*scale > 1);
        let pattern = pattern(graphics, reflected, *scale);
        for &offset in &offsets[usize::from(without_main)..] {
            pixels.stamp(around(x, i32::from(offset) + start), pattern);
        }
    }
    pixels
}

/// Iterates over the pixels at which a player's copies start.
pub(super) fn starts(x: u8, nusiz: u8) -> impl Iterator<Item = u8> {
    copies(nusiz)
        .offsets
        .iter()
        .map(move |&offset| around(x, i32::from(offset)))
}

/// Returns the pixels of a missile; bits 4 and 5 of `NUSIZx` are its width.
#[inline(always)]
pub(super) fn missile(x: u8, nusiz: u8) -> Pixels {
    let mut pixels = Pixels::default();
    for &offset in copies(nusiz).offsets {
        pixels.stamp(around(x, i32::from(offset)), bar(nusiz));
    }
    pixels
}

/// Returns the pixels of the ball; bits 4 and 5 of `CTRLPF` are its width.
#[inline(always)]
pub(super) fn ball(x: u8, ctrlpf: u8) -> Pixels {
    let mut pixels = Pixels::default();
    pixels.stamp(x, bar(ctrlpf));
    pixels
}

/// Returns a pattern of 1, 2, 4 or 8 pixels.
fn bar(register: u8) -> u32 {
    (1 << (1 << (register >> 4 & 0x03))) - 1
}

/// Returns the pixels of the playfield: 20 bits, each 4 pixels wide, repeated or reflected on the
/// right half.
#[inline(always)]
pub(super) fn playfield(left: u32, reflected: bool) -> Pixels {
    let right = if reflected {
        left.reverse_bits() >> 12
    } else {
        left
    };
    let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|byte| {
        let bits = (u64::from(left) | u64::from(right) << 20) >> (8 * byte);
        u64::from(WIDENED[2][bits as usize & 0xff])
    });
    Pixels([a | b << 32, c | d << 32, e])
}
