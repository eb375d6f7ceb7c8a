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

use serde::{Deserialize, Serialize};

use draw::Differing;
use paint::Objects;
use registers::*;

use crate::cpu::Ready;
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

    /// Writes a register. Writes without effect are handled inline, all others in separate
    /// functions.
    #[inline(always)]
    pub(crate) fn write(
        &mut self,
        address: u16,
        value: u8,
        cycle: u64,
        screen: &mut Screen,
    ) -> Ready {
        let c = self.beam(cycle);
        if self.line >= self.display.last_line {
            return self.write_late(address, value, cycle, screen);
        }
        self.register(address, value, c, screen)
    }

    /// Writes a register after the end of the frame's last line: ends the frame first. `WSYNC` ends
    /// the frame at the end of its line.
    #[cold]
    #[inline(never)]
    fn write_late(&mut self, address: u16, value: u8, cycle: u64, screen: &mut Screen) -> Ready {
        let c = self.beam(cycle);
        let wait = if address & WRITE_ADDRESS == WSYNC && c > 0 {
            CYCLES_PER_LINE - c
        } else {
            0
        };
        self.end_frame(cycle + u64::from(wait), screen);
        let c = self.beam(cycle + u64::from(wait));
        self.register(address, value, c, screen);
        Ready::Return(wait)
    }

    #[inline(always)]
    fn register(&mut self, address: u16, value: u8, c: u32, screen: &mut Screen) -> Ready {
        match self.set(address, value, c) {
            Some(ready) => ready,
            None => self.change_register(address, value, c, screen),
        }
    }

    /// Writes a register if the write changes no pixel and at most one line has begun since the
    /// last write; otherwise does nothing and returns `None`.
    #[inline(always)]
    pub(crate) fn write_unseen(&mut self, address: u16, value: u8, cycle: u64) -> Option<Ready> {
        let passed = (cycle - self.line_start) as u32;
        let is_next = passed >= CYCLES_PER_LINE;
        let c = if is_next {
            passed - CYCLES_PER_LINE
        } else {
            passed
        };
        if c >= CYCLES_PER_LINE || self.line >= self.display.last_line - 1 {
            return None;
        }
        let ready = self.set(address, value, c)?;
        if is_next {
            self.next_line();
        }
        Some(ready)
    }

    /// Handles writes that change no pixel yet: an equal value, or a value that takes effect at
    /// `HMOVE` or in the next cycle. Returns `None` for other writes.
    #[inline(always)]
    fn set(&mut self, address: u16, value: u8, c: u32) -> Option<Ready> {
        let unchanged = match address & WRITE_ADDRESS {
            WSYNC => {
                return Some(if c > 0 {
                    Ready::After(CYCLES_PER_LINE - c)
                } else {
                    Ready::Now
                });
            }
            register @ (NUSIZ0 | NUSIZ1) => {
                let i = usize::from(register - NUSIZ0);
                self.nusiz[i] == value && !self.without_main[i]
            }
            register @ (COLUP0 | COLUP1) => {
                self.colup[usize::from(register - COLUP0)] == value & bit::COLOR
            }
            COLUPF => self.colupf == value & bit::COLOR,
            COLUBK => self.colubk == value & bit::COLOR,
            CTRLPF => self.ctrlpf == value,
            register @ (REFP0 | REFP1) => {
                self.refp[usize::from(register - REFP0)] == (value & bit::REFLECT != 0)
            }
            register @ PF0..=PF2 => self.with_playfield(register, value) == self.pf,
            GRP0 => self.grp[0] == value && self.old_grp[1] == self.grp[1],
            GRP1 => {
                self.grp[1] == value
                    && self.old_grp[0] == self.grp[0]
                    && self.old_enabl == self.enabl
            }
            register @ (ENAM0 | ENAM1) => {
                self.enam[usize::from(register - ENAM0)] == (value & bit::ENABLE != 0)
            }
            ENABL => self.enabl == (value & bit::ENABLE != 0),
            register @ HMP0..=HMBL => {
                let object = usize::from(register - HMP0);
                self.hm[object] = value >> 4;
                self.in_motion =
                    self.in_motion & !(1 << object) | u8::from(value >> 4 != 0) << object;
                true
            }
            register @ (VDELP0 | VDELP1) => {
                self.vdelp[usize::from(register - VDELP0)] == (value & bit::DELAY != 0)
            }
            VDELBL => self.vdelbl == (value & bit::DELAY != 0),
            register @ (RESMP0 | RESMP1) => {
                self.resmp[usize::from(register - RESMP0)] == (value & bit::LOCK != 0)
            }
            HMCLR => {
                self.hm = [0; 5];
                self.in_motion = 0;
                true
            }
            VSYNC | VBLANK | RESP0..=RESBL | HMOVE | CXCLR => false,
            // `RSYNC` is not emulated, and there is no sound (`AUDCx`, `AUDFx`, `AUDVx`)
            _ => true,
        };
        unchanged.then_some(Ready::Now)
    }

    /// Handles writes that may change pixels.
    #[inline(always)]
    fn change_register(&mut self, address: u16, value: u8, c: u32, screen: &mut Screen) -> Ready {
        match address & WRITE_ADDRESS {
            VSYNC => return self.write_vsync(value, c, screen),
            VBLANK => self.write_vblank(value, c, screen),
            register @ (NUSIZ0 | NUSIZ1) => {
                self.write_nusiz(usize::from(register - NUSIZ0), value, c, screen);
            }
            register @ (COLUP0 | COLUP1) => {
                self.write_colup(
                    usize::from(register - COLUP0),
                    value & bit::COLOR,
                    c,
                    screen,
                );
            }
            COLUPF => self.write_colupf(value & bit::COLOR, c, screen),
            COLUBK => self.write_colubk(value & bit::COLOR, c, screen),
            CTRLPF => self.write_ctrlpf(value, c, screen),
            register @ (REFP0 | REFP1) => {
                self.write_refp(
                    usize::from(register - REFP0),
                    value & bit::REFLECT != 0,
                    c,
                    screen,
                );
            }
            register @ PF0..=PF2 => {
                self.change_playfield(self.with_playfield(register, value), c, screen);
            }
            register @ (RESP0 | RESP1) => {
                self.reset_player(usize::from(register - RESP0), c, screen);
            }
            register @ RESM0..=RESBL => {
                self.reset_missile_or_ball(usize::from(register - RESP0), c, screen);
            }
            register @ (GRP0 | GRP1) => {
                self.write_grp(usize::from(register - GRP0), value, c, screen);
            }
            register @ (ENAM0 | ENAM1) => {
                self.write_enam(
                    usize::from(register - ENAM0),
                    value & bit::ENABLE != 0,
                    c,
                    screen,
                );
            }
            ENABL => self.write_enabl(value & bit::ENABLE != 0, c, screen),
            register @ (VDELP0 | VDELP1) => {
                self.write_vdelp(
                    usize::from(register - VDELP0),
                    value & bit::DELAY != 0,
                    c,
                    screen,
                );
            }
            VDELBL => self.write_vdelbl(value & bit::DELAY != 0, c, screen),
            register @ (RESMP0 | RESMP1) => {
                self.write_resmp(
                    usize::from(register - RESMP0),
                    value & bit::LOCK != 0,
                    c,
                    screen,
                );
            }
            HMOVE => self.hmove(c, screen),
            CXCLR => self.clear_collisions(c, screen),
            _ => {}
        }
        Ready::Now
    }

    #[inline(never)]
    fn write_nusiz(&mut self, i: usize, value: u8, c: u32, screen: &mut Screen) {
        self.change(1 << (P0 + i) | 1 << (M0 + i), 3 * c + 8, screen);
        self.nusiz[i] = value;
        self.without_main[i] = false;
    }

    #[inline(never)]
    fn write_colup(&mut self, i: usize, color: u8, c: u32, screen: &mut Screen) {
        // in score mode the playfield has the players' colours
        let playfield = u8::from(self.ctrlpf & bit::SCORE != 0) << PF;
        self.change_colors(1 << (P0 + i) | 1 << (M0 + i) | playfield, 3 * c, screen);
        self.colup[i] = color;
    }

    #[inline(never)]
    fn write_colupf(&mut self, color: u8, c: u32, screen: &mut Screen) {
        self.change_colors(1 << PF | 1 << BL, 3 * c, screen);
        self.colupf = color;
    }

    #[inline(never)]
    fn write_colubk(&mut self, color: u8, c: u32, screen: &mut Screen) {
        self.change_all_colors(3 * c, screen);
        self.colubk = color;
    }

    #[inline(never)]
    fn write_ctrlpf(&mut self, value: u8, c: u32, screen: &mut Screen) {
        let clock = 3 * c;
        self.change_all_colors(clock, screen);
        self.change(1 << PF | 1 << BL, clock, screen);
        self.ctrlpf = value;
        // the write does not change the reflection of a right half that has begun: a write at pixel
        // 76 is in time, a write at pixel 79 is too late
        if (clock as i32) < BLANK + 79 {
            self.reflected = value & bit::REFLECT_PLAYFIELD != 0;
        }
    }

    #[inline(never)]
    fn write_refp(&mut self, i: usize, reflected: bool, c: u32, screen: &mut Screen) {
        self.change(1 << (P0 + i), 3 * c + 1, screen);
        self.refp[i] = reflected;
    }

    /// Writes `RESMx` or `RESBL`: the object restarts just behind the beam. A missile keeps its old
    /// pixels for 8 more clocks.
    #[inline(never)]
    fn reset_missile_or_ball(&mut self, object: usize, c: u32, screen: &mut Screen) {
        let clock = 3 * c;
        self.change(
            1 << object,
            if object == BL { clock } else { clock + 8 },
            screen,
        );
        // all positions in the horizontal blank give the same start
        let beam = (clock as i32 - BLANK).max(-2);
        self.x[object] = match (object, self.moved.checked_sub(self.line_start), c) {
            // an `HMOVE` at the start of the line still moves some objects; measured for all
            // objects and times
            (M1 | BL, Some(3), 6) => 3,
            (BL, Some(3), 9) => 5,
            (BL, Some(3), 10) => 6,
            (M0, Some(3), 23) => 8,
            (BL, Some(5), 23) => 10,
            _ => ((beam + 4) % 160) as u8,
        };
    }

    #[inline(never)]
    fn write_enam(&mut self, i: usize, enabled: bool, c: u32, screen: &mut Screen) {
        self.change(1 << (M0 + i), 3 * c, screen);
        self.enam[i] = enabled;
    }

    #[inline(never)]
    fn write_enabl(&mut self, enabled: bool, c: u32, screen: &mut Screen) {
        self.change(1 << BL, 3 * c, screen);
        self.enabl = enabled;
    }

    #[inline(never)]
    fn write_vdelp(&mut self, i: usize, delayed: bool, c: u32, screen: &mut Screen) {
        self.change(1 << (P0 + i), 3 * c, screen);
        self.vdelp[i] = delayed;
    }

    #[inline(never)]
    fn write_vdelbl(&mut self, delayed: bool, c: u32, screen: &mut Screen) {
        self.change(1 << BL, 3 * c, screen);
        self.vdelbl = delayed;
    }

    #[inline(never)]
    fn clear_collisions(&mut self, c: u32, screen: &mut Screen) {
        self.paint_to(3 * c, screen);
        self.collisions = 0;
        self.searched = false;
    }

    #[inline(never)]
    fn write_vsync(&mut self, value: u8, c: u32, screen: &mut Screen) -> Ready {
        let cycle = self.line_start + u64::from(c);
        let (was, is) = (self.vsync & bit::SYNC != 0, value & bit::SYNC != 0);
        self.vsync = value;
        if is {
            self.vsync_since = cycle;
        } else if was && cycle - self.vsync_since >= u64::from(CYCLES_PER_LINE) {
            self.end_frame(cycle, screen);
            return Ready::Return(0);
        }
        Ready::Now
    }

    #[inline(never)]
    fn write_vblank(&mut self, value: u8, c: u32, screen: &mut Screen) {
        if (self.vblank ^ value) & bit::BLANK != 0 {
            self.change_all_colors(3 * c + 1, screen);
        }
        if self.vblank & bit::DISCHARGE != 0 && value & bit::DISCHARGE == 0 {
            self.released = 3 * (self.line_start + u64::from(c));
        }
        if value & bit::LATCH == 0 {
            self.latched = [false; 2];
        }
        self.vblank = value;
    }

    /// Returns the playfield after a write of `value` to `PF0`, `PF1` or `PF2`.
    #[inline(always)]
    fn with_playfield(&self, register: u16, value: u8) -> u32 {
        let (mask, bits) = match register {
            PF0 => (0x0000f, u32::from(value >> 4)),
            PF1 => (0x00ff0, u32::from(value.reverse_bits()) << 4),
            _ => (0xff000, u32::from(value) << 12),
        };
        self.pf & !mask | bits
    }

    #[inline(never)]
    fn change_playfield(&mut self, pf: u32, c: u32, screen: &mut Screen) {
        self.change(1 << PF, 3 * c + [4, 5, 2, 3][c as usize % 4], screen);
        self.pf = pf;
    }

    /// Writes `GRPx`. A write to one player's register latches the other player's delayed graphics;
    /// `GRP1` also latches the ball's.
    #[inline(never)]
    fn write_grp(&mut self, i: usize, value: u8, c: u32, screen: &mut Screen) {
        let other = 1 - i;
        let shows_other = self.vdelp[other] && self.old_grp[other] != self.grp[other];
        let shows_this = !self.vdelp[i] && self.grp[i] != value;
        let shows_ball = i == 1 && self.vdelbl && self.old_enabl != self.enabl;
        let changed = u8::from(shows_other) << (P0 + other)
            | u8::from(shows_this) << (P0 + i)
            | u8::from(shows_ball) << BL;
        if changed != 0 {
            self.change(changed, 3 * c + 1, screen);
        }
        self.grp[i] = value;
        self.old_grp[other] = self.grp[other];
        if i == 1 {
            self.old_enabl = self.enabl;
        }
    }

    #[inline(never)]
    fn write_resmp(&mut self, i: usize, locked: bool, c: u32, screen: &mut Screen) {
        self.change(1 << (M0 + i), 3 * c, screen);
        if !locked {
            let middle = 4 * objects::scale(self.nusiz[i]);
            self.x[M0 + i] = objects::around(self.x[P0 + i], i32::from(middle));
        }
        self.resmp[i] = locked;
    }

    /// Writes `RESPx`: the player restarts just behind the beam. The rest of the line does not show
    /// the first copy, unless an old copy was about to start. A copy that is being drawn continues
    /// for 11 clocks. A write at the end of a line suppresses the next line's first copy only if an
    /// old copy is being drawn.
    #[inline(never)]
    fn reset_player(&mut self, i: usize, c: u32, screen: &mut Screen) {
        let clock = 3 * c;
        // all positions in the horizontal blank give the same start
        let beam = (clock as i32 - BLANK).max(-2);
        let width = 8 * i32::from(objects::scale(self.nusiz[i]));
        let mut running = false;
        let mut about_to_start = false;
        for start in objects::starts(self.x[i], self.nusiz[i]) {
            let behind = i32::from(start) - beam;
            let behind = if behind > 80 { behind - 160 } else { behind };
            running |= (2 - width..=1).contains(&behind);
            about_to_start |= (2..=5).contains(&behind);
        }
        self.change(
            1 << (P0 + i),
            if running { clock + 11 } else { clock },
            screen,
        );
        self.x[i] = ((beam + 5) % 160) as u8;
        self.without_main[i] = if c == 0 {
            self.without_main[i] || running
        } else {
            !about_to_start
        };
    }

    /// Writes `HMOVE`: each object moves by the number of pulses that its `HM` register selects. An
    /// `HMOVE` late in the line has fewer pulses.
    #[inline(never)]
    fn hmove(&mut self, c: u32, screen: &mut Screen) {
        let clock = 3 * c;
        self.reach(clock, screen);
        self.moved = self.line_start + u64::from(c);
        let c = c as i32;
        let shift = |m: i32| match c {
            ..=20 => 8 - m.min((70 - 3 * c) / 4),
            21..=54 => 0,
            55..=74 => -(m - (222 - 3 * c) / 4).max(0),
            _ => 8 - m,
        };
        // with all 8 pulses, only objects move whose `HM` register is not 0
        let candidates = match c {
            ..=12 | 75.. => self.in_motion,
            21..=54 => 0,
            _ => MOVABLE,
        };
        // suppressed first copies appear again
        let mut moved =
            u8::from(self.without_main[P0]) << P0 | u8::from(self.without_main[P1]) << P1;
        let mut x = self.x;
        for object in draw::bits(candidates) {
            let shift = shift(i32::from(self.hm[object] ^ 0x08));
            if shift != 0 {
                moved |= 1 << object;
                x[object] = objects::around(x[object], shift);
            }
        }
        if moved != 0 {
            self.change(moved, clock, screen);
            self.without_main = [false; 2];
            self.x = x;
        }
        if self.display.comb && (c <= 20 || c >= 75) {
            if c >= 75 {
                // shows the comb, the black start of a line after `HMOVE`, on the next line
                self.reach(CLOCKS_PER_LINE, screen);
            }
            self.comb = true;
        }
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
