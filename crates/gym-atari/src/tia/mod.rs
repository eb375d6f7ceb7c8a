//! The Television Interface Adaptor: draws the picture, line by line, while the program runs.
//!
//! Registers have the names and addresses of the Stella Programmer's Guide (1979). When a write shows, and what happens to
//! objects that are moved while they are drawn, was measured: see `NOTICE.md`.
//!
//! Time is counted in the processor's cycles, of which a line has 76, or in colour clocks, three to a cycle. The first 68
//! clocks of a line are blank; pixel `x` is clock `68 + x`. `c` is the number of cycles of the line that have passed
//! at the end of an access.
//!
//! Nothing is drawn until something changes: a write first paints what lies before it with what was.

mod objects;
mod paint;
mod pixels;

use serde::{Deserialize, Serialize};

use paint::{Colors, Objects};
pub(crate) use pixels::WIDTH;

use crate::screen::Screen;

/// The rows of most games' pictures.
const NTSC_ROWS: usize = 210;

const CYCLES_PER_LINE: u32 = 76;
const CLOCKS_PER_LINE: u32 = 228;
/// The clocks of a line ahead of its first pixel.
const BLANK: i32 = 68;
/// A write in this line of the frame ends the frame, whatever the program thinks.
const LAST_LINE: u32 = 291;

/// What depends on the game, and not on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Display {
    /// The line of the frame that is the first row of the picture.
    pub first_line: u32,
    /// The rows of the picture, 250 at most.
    pub rows: usize,
    /// Whether `HMOVE` blackens the first 8 pixels of its line.
    pub comb: bool,
}

impl Display {
    /// What nearly all games have.
    pub const NTSC: Self = Self { first_line: 34, rows: NTSC_ROWS, comb: true };
}

impl Default for Display {
    fn default() -> Self {
        Self::NTSC
    }
}

/// What a write asks of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Request {
    /// Go on.
    None,
    /// `WSYNC`: let this many cycles pass.
    Wait(u32),
    /// The frame is complete.
    FrameEnd,
}

/// A player or a missile, or the ball: which one a register is of.
const P0: usize = 0;
const P1: usize = 1;
const M0: usize = 2;
const BL: usize = 4;

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
    pf: [u8; 3],
    /// Whether this line's right half mirrors the left.
    reflected: bool,
    /// What was written, and what the vertical delay shows.
    grp: [[u8; 2]; 2],
    enam: [bool; 2],
    enabl: [bool; 2],
    hm: [u8; 5],
    vdelp: [bool; 2],
    vdelbl: bool,
    resmp: [bool; 2],
    collisions: u16,
    /// Where each object starts.
    x: [u8; 5],
    /// Whether a player's first copy is left out on this line.
    without_main: [bool; 2],
    // the beam
    line: u32,
    line_start: u64,
    vsync_since: u64,
    /// Until where the picture is drawn: the line, and the clock in it.
    drawn: (u32, u32),
    comb: bool,
    /// Whether the last frame ended before its picture was complete.
    short: bool,
    // what is on the line now
    objects: Objects,
    // inputs
    pub(crate) fire: [bool; 2],
    latched: [bool; 2],
    /// After how many clocks each paddle's capacitor is charged; `None` where nothing charges it.
    pub(crate) charge: [Option<u32>; 4],
    /// The clock at which the capacitors were last let go.
    released: u64,
}

impl Tia {
    pub(crate) fn new(display: Display) -> Self {
        let none = pixels::Pixels::default();
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
            pf: [0; 3],
            reflected: false,
            grp: [[0; 2]; 2],
            enam: [false; 2],
            enabl: [false; 2],
            hm: [0; 5],
            vdelp: [false; 2],
            vdelbl: false,
            resmp: [false; 2],
            collisions: 0,
            x: [0; 5],
            without_main: [false; 2],
            line: 0,
            line_start: 0,
            vsync_since: 0,
            drawn: (0, 0),
            comb: false,
            short: false,
            objects: Objects { p0: none, p1: none, m0: none, m1: none, bl: none, pf: none },
            fire: [false; 2],
            latched: [false; 2],
            charge: [None; 4],
            released: 0,
        }
    }

    pub(crate) fn display(&self) -> &Display {
        &self.display
    }

    pub(crate) fn set_display(&mut self, display: Display) {
        self.display = display;
    }

    /// Whether this can be the chip of a console at `cycle`: one that was stored may have been damaged.
    pub(crate) fn is_valid(&self, cycle: u64) -> bool {
        // far from where the arithmetic of times would overflow
        const LONG: u64 = 1 << 60;
        cycle < LONG
            && self.line_start <= cycle
            && cycle - self.line_start < 1 << 30
            && self.vsync_since <= cycle
            && self.released <= 3 * cycle
            && self.line < 1 << 30
            && self.drawn.0 <= self.line + 1
            && self.line - self.drawn.0.min(self.line) < 1 << 16
            && self.drawn.1 <= CLOCKS_PER_LINE
            && self.x.iter().all(|&x| usize::from(x) < WIDTH)
            && self.hm.iter().all(|&nibble| nibble < 16)
    }

    /// Reads a register: its bits, and which of the byte's bits it drives.
    pub(crate) fn read(&mut self, address: u16, cycle: u64, screen: &mut Screen) -> (u8, u8) {
        match address & 0x0f {
            // CXM0P, CXM1P, CXP0FB, CXP1FB, CXM0FB, CXM1FB, CXBLPF, CXPPMM
            register @ 0..8 => {
                self.beam(cycle);
                self.draw(self.clock(cycle), screen);
                (((self.collisions >> (2 * register)) as u8) << 6, 0xc0)
            }
            // INPT0, INPT1, INPT2, INPT3
            paddle @ 8..12 => (self.paddle(usize::from(paddle) - 8, cycle), 0x80),
            // INPT4, INPT5
            trigger @ 12..14 => (self.trigger(usize::from(trigger) - 12), 0x80),
            _ => (0, 0),
        }
    }

    fn paddle(&self, paddle: usize, cycle: u64) -> u8 {
        let charged = match self.charge[paddle] {
            Some(clocks) => self.vblank & 0x80 == 0 && 3 * cycle >= self.released + u64::from(clocks),
            None => false,
        };
        if charged { 0x80 } else { 0 }
    }

    fn trigger(&mut self, trigger: usize) -> u8 {
        let mut pressed = self.fire[trigger];
        if self.vblank & 0x40 != 0 {
            self.latched[trigger] |= pressed;
            pressed = self.latched[trigger];
        }
        if pressed { 0 } else { 0x80 }
    }

    /// Writes a register.
    pub(crate) fn write(&mut self, address: u16, value: u8, cycle: u64, screen: &mut Screen) -> Request {
        let c = self.beam(cycle);
        if self.line >= LAST_LINE {
            self.end_frame(cycle, screen);
            self.register(address, value, cycle, c, screen);
            return Request::FrameEnd;
        }
        self.register(address, value, cycle, c, screen)
    }

    fn register(&mut self, address: u16, value: u8, cycle: u64, c: u32, screen: &mut Screen) -> Request {
        let clock = 3 * c;
        match address & 0x3f {
            0x00 => return self.write_vsync(value, cycle, screen), // VSYNC
            0x01 => self.write_vblank(value, cycle, screen),       // VBLANK
            // WSYNC
            0x02 if c > 0 => return Request::Wait(CYCLES_PER_LINE - c),
            // RSYNC is not modelled
            // NUSIZ0, NUSIZ1
            register @ (0x04 | 0x05) => {
                let i = usize::from(register) - 0x04;
                self.draw(clock + 8, screen);
                self.nusiz[i] = value;
                self.place_player(i);
                self.place_missile(i);
            }
            // COLUP0, COLUP1
            register @ (0x06 | 0x07) => {
                self.draw(clock, screen);
                self.colup[usize::from(register) - 0x06] = value & 0xfe;
            }
            // COLUPF
            0x08 => {
                self.draw(clock, screen);
                self.colupf = value & 0xfe;
            }
            // COLUBK
            0x09 => {
                self.draw(clock, screen);
                self.colubk = value & 0xfe;
            }
            // CTRLPF
            0x0a => {
                self.draw(clock, screen);
                self.ctrlpf = value;
                // the right half keeps what it began with
                if (clock as i32) < BLANK + WIDTH as i32 / 2 {
                    self.reflected = value & 0x01 != 0;
                }
                self.place_playfield();
                self.place_ball();
            }
            // REFP0, REFP1
            register @ (0x0b | 0x0c) => {
                let i = usize::from(register) - 0x0b;
                self.draw(clock + 1, screen);
                self.refp[i] = value & 0x08 != 0;
                self.place_player(i);
            }
            // PF0, PF1, PF2
            register @ 0x0d..=0x0f => {
                self.draw(clock + [4, 5, 2, 3][c as usize % 4], screen);
                self.pf[usize::from(register) - 0x0d] = value;
                self.place_playfield();
            }
            // RESP0, RESP1
            register @ (0x10 | 0x11) => self.reset_player(usize::from(register) - 0x10, c, screen),
            // RESM0, RESM1, RESBL
            register @ 0x12..=0x14 => {
                self.draw(clock, screen);
                self.x[usize::from(register) - 0x10] =
                    if c >= 23 { ((clock as i32 - BLANK + 4) % 160) as u8 } else { 2 };
                self.place_all();
            }
            // AUDC0, AUDC1, AUDF0, AUDF1, AUDV0, AUDV1: there is no sound
            0x15..=0x1a => {}
            // GRP0
            0x1b => self.write_grp(0, value, clock, screen),
            // GRP1
            0x1c => self.write_grp(1, value, clock, screen),
            // ENAM0, ENAM1
            register @ (0x1d | 0x1e) => {
                let i = usize::from(register) - 0x1d;
                self.draw(clock, screen);
                self.enam[i] = value & 0x02 != 0;
                self.place_missile(i);
            }
            // ENABL
            0x1f => {
                self.draw(clock, screen);
                self.enabl[0] = value & 0x02 != 0;
                self.place_ball();
            }
            // HMP0, HMP1, HMM0, HMM1, HMBL
            register @ 0x20..=0x24 => self.hm[usize::from(register) - 0x20] = value >> 4,
            // VDELP0, VDELP1
            register @ (0x25 | 0x26) => {
                let i = usize::from(register) - 0x25;
                self.draw(clock, screen);
                self.vdelp[i] = value & 0x01 != 0;
                self.place_player(i);
            }
            // VDELBL
            0x27 => {
                self.draw(clock, screen);
                self.vdelbl = value & 0x01 != 0;
                self.place_ball();
            }
            // RESMP0, RESMP1
            register @ (0x28 | 0x29) => self.write_resmp(usize::from(register) - 0x28, value, clock, screen),
            // HMOVE
            0x2a => self.hmove(c, screen),
            // HMCLR
            0x2b => self.hm = [0; 5],
            // CXCLR
            0x2c => {
                self.draw(clock, screen);
                self.collisions = 0;
            }
            _ => {}
        }
        Request::None
    }

    fn write_vsync(&mut self, value: u8, cycle: u64, screen: &mut Screen) -> Request {
        let (was, is) = (self.vsync & 0x02 != 0, value & 0x02 != 0);
        self.vsync = value;
        if is && !was {
            self.vsync_since = cycle;
        }
        if was && !is && cycle - self.vsync_since >= u64::from(CYCLES_PER_LINE) {
            self.end_frame(cycle, screen);
            return Request::FrameEnd;
        }
        Request::None
    }

    fn write_vblank(&mut self, value: u8, cycle: u64, screen: &mut Screen) {
        self.draw(self.clock(cycle) + 1, screen);
        if self.vblank & 0x80 != 0 && value & 0x80 == 0 {
            self.released = 3 * cycle;
        }
        if value & 0x40 == 0 {
            self.latched = [false; 2];
        }
        self.vblank = value;
    }

    fn write_grp(&mut self, i: usize, value: u8, clock: u32, screen: &mut Screen) {
        self.draw(clock + 1, screen);
        self.grp[i][0] = value;
        // the vertical delay: a write to one player shows the other's last
        self.grp[1 - i][1] = self.grp[1 - i][0];
        if i == 1 {
            self.enabl[1] = self.enabl[0];
            self.place_ball();
        }
        self.place_player(0);
        self.place_player(1);
    }

    fn write_resmp(&mut self, i: usize, value: u8, clock: u32, screen: &mut Screen) {
        self.draw(clock, screen);
        let locked = value & 0x02 != 0;
        if self.resmp[i] && !locked {
            let middle = 4 * objects::scale(self.nusiz[i]);
            self.x[M0 + i] = objects::around(self.x[P0 + i], i32::from(middle));
        }
        self.resmp[i] = locked;
        self.place_missile(i);
    }

    /// `RESPx`: the player starts anew just behind the beam. The rest of the line shows no first copy of it, unless an
    /// old copy was about to start; one that is being drawn goes on for a while.
    fn reset_player(&mut self, i: usize, c: u32, screen: &mut Screen) {
        let clock = 3 * c;
        let beam = clock as i32 - BLANK;
        let mut running = false;
        let mut about_to_start = false;
        if beam >= 0 {
            let width = 8 * i32::from(objects::scale(self.nusiz[i]));
            let late = i32::from(width > 8);
            for start in objects::starts(self.x[i], self.nusiz[i]) {
                let passed = beam - i32::from(start);
                running |= (0..width - 1 + late).contains(&passed);
                about_to_start |= (-5..0).contains(&passed);
            }
        }
        self.draw(if running { clock + 11 } else { clock }, screen);
        self.x[i] = if c >= 23 { ((beam + 5) % 160) as u8 } else { 3 };
        self.without_main[i] = !about_to_start;
        self.place_player(i);
    }

    /// `HMOVE`: each object moves by the pulses that its `HM` register leaves it, of which an `HMOVE` late in the line
    /// gives fewer.
    fn hmove(&mut self, c: u32, screen: &mut Screen) {
        // the last cycle of a line is the first of the next
        self.draw(if c == CYCLES_PER_LINE - 1 { CLOCKS_PER_LINE } else { 3 * c }, screen);
        let c = c as i32;
        let shift = |m: i32| match c {
            ..=20 => 8 - m.min((70 - 3 * c) / 4),
            21..=54 => 0,
            55..=74 => -(m - (222 - 3 * c) / 4).max(0),
            _ => 8 - m,
        };
        for (x, hm) in self.x.iter_mut().zip(self.hm) {
            *x = objects::around(*x, shift(i32::from(hm ^ 0x08)));
        }
        if self.display.comb && (c <= 20 || c >= 75) {
            self.comb = true;
        }
        self.place_all();
    }

    fn place_all(&mut self) {
        for i in 0..2 {
            self.place_player(i);
            self.place_missile(i);
        }
        self.place_ball();
    }

    fn place_player(&mut self, i: usize) {
        let graphics = self.grp[i][usize::from(self.vdelp[i])];
        let pixels = objects::player(self.x[i], self.nusiz[i], graphics, self.refp[i], self.without_main[i]);
        *[&mut self.objects.p0, &mut self.objects.p1][i] = pixels;
    }

    fn place_missile(&mut self, i: usize) {
        let pixels = if self.enam[i] && !self.resmp[i] {
            objects::missile(self.x[M0 + i], self.nusiz[i])
        } else {
            pixels::Pixels::default()
        };
        *[&mut self.objects.m0, &mut self.objects.m1][i] = pixels;
    }

    fn place_ball(&mut self) {
        self.objects.bl = if self.enabl[usize::from(self.vdelbl)] {
            objects::ball(self.x[BL], self.ctrlpf)
        } else {
            pixels::Pixels::default()
        };
    }

    fn place_playfield(&mut self) {
        self.objects.pf = objects::playfield(self.pf, self.reflected);
    }

    /// Brings the beam to `cycle`; gives the cycles of its line that have passed.
    fn beam(&mut self, cycle: u64) -> u32 {
        let mut c = (cycle - self.line_start) as u32;
        while c >= CYCLES_PER_LINE {
            c -= CYCLES_PER_LINE;
            self.line_start += u64::from(CYCLES_PER_LINE);
            self.line += 1;
        }
        c
    }

    /// The clock of the beam's line.
    fn clock(&self, cycle: u64) -> u32 {
        3 * (cycle - self.line_start) as u32
    }

    /// Whether the picture lacks rows yet.
    pub(crate) fn is_short(&self) -> bool {
        self.short
    }

    /// The beam's line becomes the first of a new frame.
    fn end_frame(&mut self, cycle: u64, screen: &mut Screen) {
        self.beam(cycle);
        self.draw(self.clock(cycle), screen);
        self.short = self.row().is_some() || self.drawn.0 < self.display.first_line;
        self.drawn.0 = self.drawn.0.saturating_sub(self.line);
        self.line = 0;
    }

    /// Draws up to a clock of the beam's line, which may lie beyond its end.
    fn draw(&mut self, clock: u32, screen: &mut Screen) {
        let ahead = clock / CLOCKS_PER_LINE;
        let (line, clock) = (self.line + ahead, clock % CLOCKS_PER_LINE);
        if self.drawn.0 > line {
            return;
        }
        while self.drawn.0 < line {
            self.draw_within_line(CLOCKS_PER_LINE, screen);
            self.start_line(screen);
        }
        self.draw_within_line(clock, screen);
    }

    fn start_line(&mut self, screen: &mut Screen) {
        // a comb ahead of the picture waits for its first row
        if self.comb
            && let Some(row) = self.row()
        {
            screen.row(row)[..8].fill(0);
            self.comb = false;
        }
        self.drawn = (self.drawn.0 + 1, 0);
        let reflected = self.ctrlpf & 0x01 != 0;
        if self.reflected != reflected {
            self.reflected = reflected;
            self.place_playfield();
        }
        for i in [P0, P1] {
            if self.without_main[i] {
                self.without_main[i] = false;
                self.place_player(i);
            }
        }
    }

    /// The row of the picture that is being drawn.
    fn row(&self) -> Option<usize> {
        let row = self.drawn.0.checked_sub(self.display.first_line)? as usize;
        (row < self.display.rows).then_some(row)
    }

    fn draw_within_line(&mut self, clock: u32, screen: &mut Screen) {
        let from = (self.drawn.1 as usize).saturating_sub(BLANK as usize);
        let to = (clock as usize).saturating_sub(BLANK as usize);
        self.drawn.1 = self.drawn.1.max(clock);
        if from >= to {
            return;
        }
        let Some(row) = self.row() else { return };
        if self.vblank & 0x02 != 0 {
            screen.row(row)[from..to].fill(0);
            return;
        }
        self.collisions |= self.objects.collisions(from, to);
        if !screen.unseen {
            let colors = Colors {
                p0: self.colup[0],
                p1: self.colup[1],
                pf: self.colupf,
                bk: self.colubk,
                playfield_first: self.ctrlpf & 0x04 != 0,
                // the playfield's priority ends the score mode only where there is something to be before
                score: self.ctrlpf & 0x02 != 0 && (self.ctrlpf & 0x04 == 0 || self.objects.only_playfield()),
            };
            self.objects.paint(screen.row(row), from, to, &colors);
        }
    }
}
