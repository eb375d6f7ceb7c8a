//! From registers to lines, and from lines to the picture.
//!
//! A line is put together object by object: a change of one gives it other pixels from there on, and the rest of the
//! line stays what it was. So most lines are painted at once, at their end; only colours, `VBLANK` and whoever asks for
//! collisions need what lies before them painted earlier.

use super::paint::Colors;
use super::pixels::{Pixels, WIDTH, window};
use super::{BL, BLANK, CLOCKS_PER_LINE, M0, OBJECTS, P0, PF, Tia, objects};
use crate::screen::Screen;

impl Tia {
    /// Objects, one for each bit, are about to change at a clock of the beam's line, which may lie beyond its end.
    pub(super) fn change(&mut self, objects: u8, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen) as u8;
        for object in 0..OBJECTS {
            let bit = 1 << object;
            if objects & bit != 0 && self.from[object] < x {
                if self.stale & bit != 0 {
                    self.place(object);
                }
                self.from[object] = x;
            }
        }
        self.stale |= objects;
    }

    /// Paints up to a clock of the beam's line.
    pub(super) fn paint_to(&mut self, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, false, screen);
    }

    /// Completes the lines before that of a clock; gives its pixel.
    pub(super) fn reach(&mut self, clock: u32, screen: &mut Screen) -> usize {
        let (line, clock) = if clock < CLOCKS_PER_LINE {
            (self.line, clock)
        } else {
            (self.line + 1, clock - CLOCKS_PER_LINE)
        };
        // a line that nothing changes looks like the one above it
        let mut repeats = false;
        while self.drawn_line < line {
            let whole = self.painted == 0;
            self.paint(WIDTH, repeats, screen);
            repeats = whole & self.start_line(screen);
        }
        if self.drawn_line > line { 0 } else { (clock as usize).saturating_sub(BLANK as usize) }
    }

    /// Goes on to the next line; says whether all is on it as it was on this one.
    fn start_line(&mut self, screen: &mut Screen) -> bool {
        let comb = self.comb;
        // a comb ahead of the picture waits for its first row
        if self.comb
            && let Some(row) = self.row()
        {
            screen.blacken(row, 0..8);
            self.comb = false;
        }
        self.drawn_line += 1;
        self.painted = 0;
        self.stale |= std::mem::take(&mut self.mixed);
        self.from = [0; OBJECTS];
        let reflected = self.ctrlpf & 0x01 != 0;
        if self.reflected != reflected {
            self.reflected = reflected;
            self.stale |= 1 << PF;
        }
        for i in [0, 1] {
            if self.without_main[i] {
                self.without_main[i] = false;
                self.stale |= 1 << (P0 + i);
            }
        }
        self.stale == 0 && !comb
    }

    /// The row of the picture that is being drawn.
    pub(super) fn row(&self) -> Option<usize> {
        let row = self.drawn_line.checked_sub(self.display.first_line)? as usize;
        (row < self.display.rows).then_some(row)
    }

    /// Paints up to a pixel of the line; `repeats` if all is on it as it was on the line above.
    fn paint(&mut self, to: usize, repeats: bool, screen: &mut Screen) {
        let from = usize::from(self.painted);
        if from >= to {
            return;
        }
        self.painted = to as u8;
        let Some(row) = self.row() else { return };
        if repeats && row > 0 {
            screen.repeat_row(row);
            return;
        }
        if self.vblank & 0x02 != 0 {
            screen.blacken(row, from..to);
            return;
        }
        if self.stale != 0 {
            self.place_stale();
        }
        if self.touching & !self.collisions != 0 {
            self.collisions |= self.objects.collisions(window(from, to));
        }
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

    #[inline(never)]
    fn place_stale(&mut self) {
        let stale = self.stale;
        for object in 0..OBJECTS {
            if stale & 1 << object != 0 {
                self.place(object);
            }
        }
        self.touching = self.objects.collisions(Pixels::ALL);
    }

    /// Gives an object the pixels that it has from its last change on.
    fn place(&mut self, object: usize) {
        let pixels = match object {
            PF => objects::playfield(self.pf, self.reflected),
            BL if self.enabl[usize::from(self.vdelbl)] => objects::ball(self.x[BL], self.ctrlpf),
            BL => Pixels::default(),
            M0.. if self.enam[object - M0] && !self.resmp[object - M0] => {
                objects::missile(self.x[object], self.nusiz[object - M0])
            }
            M0.. => Pixels::default(),
            player => {
                let graphics = self.grp[player][usize::from(self.vdelp[player])];
                let without_main = self.without_main[player];
                objects::player(self.x[player], self.nusiz[player], graphics, self.refp[player], without_main)
            }
        };
        let bit = 1 << object;
        self.stale &= !bit;
        let placed = &mut self.objects.0[object];
        match self.from[object] {
            0 => *placed = pixels,
            from => {
                self.mixed |= bit;
                *placed = placed.until(from, pixels);
            }
        }
    }
}
