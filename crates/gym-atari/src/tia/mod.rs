//! The Television Interface Adaptor: draws the picture line by line while the program runs.
//!
//! Registers have the names and addresses of the Stella Programmer's Guide (1979). The timing of
//! writes, and the effect of moving objects while they are drawn, were measured: see `NOTICE.md`.
//!
//! Times are in processor cycles, of which a line has 76, or in colour clocks, three per cycle. The
//! first 68 clocks of a line are blank; pixel `x` is at clock `68 + x`. `c` is the number of cycles
//! of the line at the end of an access.
//!
//! Drawing is delayed until a register changes: a write first paints earlier pixels with the old
//! value. A write of an equal value does nothing.

mod draw;
mod objects;
mod paint;
mod pixels;
mod registers;
mod write;

use serde::{Deserialize, Serialize};

use draw::Differing;
use paint::Objects;
use registers::*;

use crate::palette;
use crate::screen::{Screen, WIDTH};

const CYCLES_PER_LINE: u32 = 76;
const CLOCKS_PER_LINE: u32 = 228;
/// Clocks of a line before its first pixel.
const BLANK: i32 = 68;

/// Properties of the game rather than of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Display {
    /// The frame's line that is the first row of the picture.
    pub first_line: u32,
    /// The rows of the picture, at most 250.
    pub rows: usize,
    /// Whether `HMOVE` blackens the first 8 pixels of its line (the "comb").
    pub comb: bool,
    /// A write in this line of the frame ends the frame, even without `VSYNC`.
    pub last_line: u32,
    /// Whether the game is for PAL televisions: other colours, and none after a frame with an odd
    /// number of lines.
    pub pal: bool,
}

impl Display {
    /// The properties of nearly all games.
    pub const NTSC: Self = Self {
        first_line: 34,
        rows: 210,
        comb: true,
        last_line: 291,
        pal: false,
    };
    /// The properties of PAL games.
    pub const PAL: Self = Self {
        rows: 250,
        last_line: 343,
        pal: true,
        ..Self::NTSC
    };

    /// Returns red, green and blue of each colour index.
    pub fn rgb(&self) -> &'static [[u8; 3]; 256] {
        if self.pal {
            &palette::PAL_RGB
        } else {
            &palette::RGB
        }
    }

    /// Returns the shade of gray of each colour index.
    pub fn gray(&self) -> &'static [u8; 256] {
        if self.pal {
            &palette::PAL_GRAY
        } else {
            &palette::GRAY
        }
    }
}

impl Default for Display {
    fn default() -> Self {
        Self::NTSC
    }
}

/// Indices of the objects: players, missiles, ball.
const P0: usize = 0;
const P1: usize = 1;
const M0: usize = 2;
const M1: usize = 3;
const BL: usize = 4;

/// Index of the playfield.
const PF: usize = 5;
/// The number of objects.
const OBJECTS: usize = 6;

/// The bits of the movable objects.
const MOVABLE: u8 = 0x1f;

/// The chip, without the picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Tia {
    #[serde(skip)]
    display: Display,
    // registers
    vsync: u8,
    vblank: u8,
    nusiz: [u8; 2],
    colup: [u8; 2],
    colupf: u8,
    colubk: u8,
    ctrlpf: u8,
    refp: [bool; 2],
    /// The 20 bits of `PF0`, `PF1` and `PF2`; the lowest bit is leftmost on the line.
    pf: u32,
    /// Whether the right half of this line mirrors the left half.
    reflected: bool,
    grp: [u8; 2],
    enam: [bool; 2],
    enabl: bool,
    /// The values that the vertical delay shows instead of `GRP0`, `GRP1` and `ENABL`.
    old_grp: [u8; 2],
    old_enabl: bool,
    hm: [u8; 5],
    /// A bit for each object whose `hm` is not 0.
    in_motion: u8,
    vdelp: [bool; 2],
    vdelbl: bool,
    resmp: [bool; 2],
    collisions: u16,
    /// The pixel at which each object starts.
    x: [u8; 5],
    /// Whether each player's first copy is suppressed, until the end of a visible line, a write of
    /// `NUSIZx`, or `HMOVE`.
    without_main: [bool; 2],
    // the beam
    line: u32,
    line_start: u64,
    /// The number of lines in the last complete frame.
    frame_lines: u32,
    vsync_since: u64,
    /// The cycle of the last `HMOVE`.
    moved: u64,
    /// The line that is being drawn: the beam's line or the next one.
    drawn_line: u32,
    /// The number of painted pixels of the drawn line.
    painted: u8,
    comb: bool,
    /// The lowest bit of each pixel: 1 in a frame without colours.
    colorless: u8,
    /// Whether the last frame ended before its picture was complete.
    short: bool,
    // the objects on the line being drawn
    objects: Objects,
    /// A bit for each object that changed since its pixels were computed, and the pixel of each
    /// object's last change.
    stale: u8,
    from: [u8; OBJECTS],
    /// A bit for each object that changed within the line.
    mixed: u8,
    /// The pixels that must be painted.
    #[serde(skip)]
    differing: Differing,
    /// Whether a whole line was searched for collisions since the last change.
    #[serde(skip)]
    searched: bool,
    // inputs
    pub(crate) fire: [bool; 2],
    latched: [bool; 2],
    /// The clocks to charge each paddle's capacitor; `None` without a paddle.
    pub(crate) charge: [Option<u32>; 4],
    /// The clock at which the capacitors began to charge.
    released: u64,
}

impl Tia {
    pub(crate) fn new(display: Display) -> Self {
        Self {
            display,
            vsync: 0,
            vblank: 0,
            nusiz: [0; 2],
            colup: [0; 2],
            colupf: 0,
            colubk: 0,
            ctrlpf: 0,
            refp: [false; 2],
            pf: 0,
            reflected: false,
            grp: [0; 2],
            enam: [false; 2],
            enabl: false,
            old_grp: [0; 2],
            old_enabl: false,
            hm: [0; 5],
            in_motion: 0,
            vdelp: [false; 2],
            vdelbl: false,
            resmp: [false; 2],
            collisions: 0,
            x: [0; 5],
            without_main: [false; 2],
            line: 0,
            line_start: 0,
            frame_lines: 0,
            vsync_since: 0,
            moved: 0,
            drawn_line: 0,
            painted: 0,
            comb: false,
            colorless: 0,
            short: false,
            objects: Objects::default(),
            stale: 0,
            from: [0; OBJECTS],
            mixed: 0,
            differing: Differing::ALL,
            searched: false,
            fire: [false; 2],
            latched: [false; 2],
            charge: [None; 4],
            released: 0,
        }
    }

    pub(crate) fn display(&self) -> &Display {
        &self.display
    }

    /// Starts a picture: painting no longer depends on earlier lines.
    pub(crate) fn start_picture(&mut self) {
        self.differing = Differing::ALL;
        self.searched = false;
    }

    pub(crate) fn set_display(&mut self, display: Display) {
        self.display = display;
    }

    /// Whether a deserialized chip is consistent at `cycle`.
    pub(crate) fn is_valid(&self, cycle: u64) -> bool {
        // small enough that arithmetic on times does not overflow
        const LONG: u64 = 1 << 60;
        cycle < LONG
            && self.line_start <= cycle
            && cycle - self.line_start < 1 << 30
            && self.vsync_since <= cycle
            && self.released <= 3 * cycle
            && self.line < 1 << 30
            && self.frame_lines < 1 << 30
            && self.drawn_line <= self.line + 1
            && self.line - self.drawn_line.min(self.line) < 1 << 16
            && usize::from(self.painted) <= WIDTH
            && self.from.iter().all(|&x| usize::from(x) <= WIDTH)
            && self.x.iter().all(|&x| usize::from(x) < WIDTH)
            && self.hm.iter().all(|&nibble| nibble < 16)
            && self.pf < 1 << 20
            && self.in_motion <= MOVABLE
            && self.colorless <= 1
    }

    /// Reads a register. Only bits 7 and 6 are driven.
    pub(crate) fn read(&mut self, address: u16, cycle: u64, screen: &mut Screen) -> u8 {
        match address & READ_ADDRESS {
            register @ CXM0P..=CXPPMM => {
                self.beam(cycle);
                self.paint_to(self.clock(cycle), screen);
                ((self.collisions >> (2 * register)) as u8) << 6
            }
            paddle @ INPT0..=INPT3 => self.paddle(usize::from(paddle - INPT0), cycle),
            trigger @ (INPT4 | INPT5) => self.trigger(usize::from(trigger - INPT4)),
            _ => 0,
        }
    }

    fn paddle(&self, paddle: usize, cycle: u64) -> u8 {
        let charged = match self.charge[paddle] {
            Some(clocks) => {
                self.vblank & bit::DISCHARGE == 0 && 3 * cycle >= self.released + u64::from(clocks)
            }
            None => false,
        };
        if charged { bit::INPUT } else { 0 }
    }

    fn trigger(&mut self, trigger: usize) -> u8 {
        let mut pressed = self.fire[trigger];
        if self.vblank & bit::LATCH != 0 {
            self.latched[trigger] |= pressed;
            pressed = self.latched[trigger];
        }
        if pressed { 0 } else { bit::INPUT }
    }

    /// Advances the beam to `cycle`; returns the cycles of its line that have passed.
    #[inline(always)]
    fn beam(&mut self, cycle: u64) -> u32 {
        let mut c = (cycle - self.line_start) as u32;
        if c >= CYCLES_PER_LINE {
            c -= CYCLES_PER_LINE;
            self.next_line();
            if c >= CYCLES_PER_LINE {
                c = self.skip_lines(c);
            }
        }
        c
    }

    #[inline(always)]
    fn next_line(&mut self) {
        self.line_start += u64::from(CYCLES_PER_LINE);
        self.line += 1;
    }

    /// Like [`beam`](Self::beam), `c` cycles after the start of the line.
    #[cold]
    #[inline(never)]
    fn skip_lines(&mut self, c: u32) -> u32 {
        let lines = c / CYCLES_PER_LINE;
        self.line_start += u64::from(lines * CYCLES_PER_LINE);
        self.line += lines;
        c % CYCLES_PER_LINE
    }

    /// Returns the clock of the beam's line at `cycle`.
    fn clock(&self, cycle: u64) -> u32 {
        3 * (cycle - self.line_start) as u32
    }

    /// Whether the last frame ended before its picture was complete.
    pub(crate) fn is_short(&self) -> bool {
        self.short
    }

    /// Ends the frame: the beam's line becomes the first line of a new frame.
    #[cold]
    fn end_frame(&mut self, cycle: u64, screen: &mut Screen) {
        self.beam(cycle);
        self.paint_to(self.clock(cycle), screen);
        self.start_frame(cycle);
    }

    /// Like `end_frame`, without painting the rest of the frame.
    pub(crate) fn start_frame(&mut self, cycle: u64) {
        self.beam(cycle);
        self.short = self.row().is_some() || self.drawn_line < self.display.first_line;
        self.drawn_line = self.drawn_line.saturating_sub(self.line);
        self.start_picture();
        // a clear of `VSYNC` in the last line ends the frame a second time
        if self.line > 0 {
            self.frame_lines = self.line;
            if self.display.pal {
                self.colorless = (self.line & 1) as u8;
            }
        }
        self.line = 0;
    }

    /// Continues the last frame: makes the beam's line a line of that frame.
    pub(crate) fn continue_frame(&mut self) {
        self.line += self.frame_lines;
        self.drawn_line += self.frame_lines;
    }
}
