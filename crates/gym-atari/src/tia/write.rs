//! Writes to registers: what each does, and from which clock.

use super::registers::*;
use super::{
    BL, BLANK, CLOCKS_PER_LINE, CYCLES_PER_LINE, M0, M1, MOVABLE, P0, P1, PF, Tia, draw, objects,
};
use crate::cpu::Ready;
use crate::screen::Screen;

impl Tia {
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
}
