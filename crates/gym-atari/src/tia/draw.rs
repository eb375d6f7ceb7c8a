//! From registers to lines, and from lines to the picture.
//!
//! A line is composed object by object: a change of an object changes its pixels from there on, and
//! the rest of the line stays. So most lines are painted at once, at their end; only colours,
//! `VBLANK` and reads of collisions need the pixels before them painted earlier.
//!
//! A line starts as a copy of the one above it, and only those pixels are painted that may differ
//! from it.

use super::paint::{Colors, Objects};
use super::pixels::{Pixels, window};
use super::{BL, BLANK, CLOCKS_PER_LINE, M0, M1, OBJECTS, P0, P1, PF, Tia, objects};
use crate::screen::{Screen, WIDTH};

/// Pixels that may differ from those above them, on the line that is being drawn and on the one
/// below it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Differing {
    here: Pixels,
    below: Pixels,
}

impl Differing {
    /// Nothing is known of the line above.
    pub(super) const ALL: Self = Self {
        here: Pixels::ALL,
        below: Pixels::ALL,
    };

    /// Pixels look otherwise than before, from `x` on: on this line those to the right, and on the
    /// next those to the left.
    #[inline(always)]
    fn add(&mut self, pixels: Pixels, x: usize) {
        let Self { here, below } = self;
        if x == 0 {
            *here = here.union(pixels);
        } else {
            let left = pixels.intersection(window(0, x));
            *below = below.union(left);
            *here = here.union(pixels.difference(left));
        }
    }
}

impl Tia {
    /// Objects, one for each bit, are about to change at a clock of the beam's line, which may lie
    /// beyond its end.
    pub(super) fn change(&mut self, objects: u8, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen) as u8;
        if x > 0 {
            self.keep_until(x, objects);
        }
        self.stale |= objects;
        self.searched = false;
    }

    /// Keeps the objects unchanged up to a pixel.
    fn keep_until(&mut self, x: u8, objects: u8) {
        for object in bits(objects) {
            if self.from[object] < x {
                if self.stale & 1 << object != 0 {
                    self.place(object);
                }
                self.from[object] = x;
            }
        }
    }

    /// The colours of some objects, one for each bit, are about to change at a clock of the beam's
    /// line.
    #[inline(always)]
    pub(super) fn change_colors(&mut self, objects: u8, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, screen);
        let pixels = bits(objects).fold(Pixels::default(), |pixels, object| {
            pixels.union(self.objects.get(object))
        });
        self.differing.add(pixels, x);
    }

    /// The colours of the whole line are about to change at a clock of the beam's line.
    #[inline(never)]
    pub(super) fn change_all_colors(&mut self, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, screen);
        self.differing.add(Pixels::ALL, x);
    }

    /// Paints up to a clock of the beam's line.
    pub(super) fn paint_to(&mut self, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, screen);
    }

    /// Completes the lines before a clock's line; returns the clock's pixel.
    #[inline]
    pub(super) fn reach(&mut self, clock: u32, screen: &mut Screen) -> usize {
        let (line, clock) = if clock < CLOCKS_PER_LINE {
            (self.line, clock)
        } else {
            (self.line + 1, clock - CLOCKS_PER_LINE)
        };
        if self.drawn_line < line {
            self.complete_lines(line, screen);
        }
        if self.drawn_line > line {
            0
        } else {
            (clock as usize).saturating_sub(BLANK as usize)
        }
    }

    #[inline(never)]
    fn complete_lines(&mut self, line: u32, screen: &mut Screen) {
        while self.drawn_line < line {
            self.paint(WIDTH, screen);
            self.start_line(screen);
        }
    }

    /// Goes on to the next line.
    fn start_line(&mut self, screen: &mut Screen) {
        let Differing { here, below } = &mut self.differing;
        *here = std::mem::take(below);
        let [first, second] = self.without_main;
        if self.comb || first || second || self.reflected != (self.ctrlpf & 0x01 != 0) {
            self.start_row(screen);
        }
        self.drawn_line += 1;
        self.painted = 0;
        if self.mixed != 0 {
            self.stale |= std::mem::take(&mut self.mixed);
            self.searched = false;
        }
        self.from = [0; OBJECTS];
    }

    /// Applies changes that wait for a line to start, or for a visible line to end.
    #[inline(never)]
    fn start_row(&mut self, screen: &mut Screen) {
        // a comb ahead of the picture waits for its first row
        if self.comb
            && let Some(row) = self.row()
        {
            screen.blacken(row, 0..8);
            self.comb = false;
            self.differing.here.0[0] |= 0xff;
        }
        // pending changes wait for the end of a visible line
        if self.row().is_some() {
            let reflected = self.ctrlpf & 0x01 != 0;
            if self.reflected != reflected {
                self.reflected = reflected;
                self.stale |= 1 << PF;
                self.searched = false;
            }
            for i in [0, 1] {
                if self.without_main[i] {
                    self.without_main[i] = false;
                    self.stale |= 1 << (P0 + i);
                    self.searched = false;
                }
            }
        }
    }

    /// The row of the picture that is being drawn.
    pub(super) fn row(&self) -> Option<usize> {
        let row = self.drawn_line.checked_sub(self.display.first_line)? as usize;
        (row < self.display.rows).then_some(row)
    }

    /// Paints up to a pixel of the line.
    fn paint(&mut self, to: usize, screen: &mut Screen) {
        let from = usize::from(self.painted);
        if from >= to {
            return;
        }
        self.painted = to as u8;
        let Some(row) = self.row() else { return };
        if self.vblank & 0x02 != 0 {
            screen.blacken(row, from..to);
            return;
        }
        if !self.searched {
            self.search(from, to, screen.unseen);
        }
        if screen.unseen {
            return;
        }
        // the playfield's priority ends the score mode only where there is something to be before
        let (score, first) = (self.ctrlpf & 0x02 != 0, self.ctrlpf & 0x04 != 0);
        if row == 0 || score && first {
            self.differing.here = Pixels::ALL;
        }
        let everything = to - from == WIDTH && self.differing.here == Pixels::ALL;
        if row > 0 && from == 0 && !everything {
            screen.repeat_row(row);
        }
        let mut pixels = self.differing.here;
        if pixels.is_empty() {
            return;
        }
        if to - from < WIDTH {
            pixels = pixels.intersection(window(from, to));
        }
        let colors = Colors {
            p0: self.colup[0] | self.colorless,
            p1: self.colup[1] | self.colorless,
            pf: self.colupf | self.colorless,
            bk: self.colubk | self.colorless,
            playfield_first: first,
            score: score && (!first || !self.shows_others()),
        };
        self.objects.paint(screen.row(row), pixels, &colors);
    }

    /// Places what changed, and searches a part of the line for collisions. If the line is not
    /// drawn, only objects that may still collide is placed.
    fn search(&mut self, from: usize, to: usize, unseen: bool) {
        let needed = if unseen {
            Objects::with_collisions(self.possible_collisions())
        } else {
            u8::MAX
        };
        for object in bits(self.stale & needed) {
            self.place(object);
        }
        let candidates = self.objects.possible_collisions() & !self.collisions;
        if candidates != 0 {
            self.collisions |= self.objects.collisions(candidates, window(from, to));
        }
        self.searched = to - from == WIDTH;
    }

    /// The collisions that there can be once all objects are placed, of those that were not yet.
    fn possible_collisions(&self) -> u16 {
        let shown = [
            self.graphics(P0) != 0,
            self.graphics(P1) != 0,
            self.enam[0] && !self.resmp[0],
            self.enam[1] && !self.resmp[1],
            self.shows_ball(),
            self.pf != 0,
        ];
        let shown = (0..OBJECTS).fold(0, |set, object| set | u8::from(shown[object]) << object);
        // objects changed within the line still show their old state
        let present = self.objects.present() | shown & self.stale;
        Objects::collisions_of(present) & !self.collisions
    }

    /// Places all that changed. A stored state is the same for lines that were seen and lines that
    /// were not.
    pub(crate) fn place_all(&mut self) {
        for object in bits(self.stale) {
            self.place(object);
        }
    }

    /// Whether there is anything but the playfield on the line, be it a player whose only copy is
    /// left out.
    fn shows_others(&self) -> bool {
        let left_out = |i: usize| self.without_main[i] && self.graphics(i) != 0;
        !self.objects.only_playfield() || left_out(0) || left_out(1)
    }

    /// The byte of a player that shows.
    fn graphics(&self, i: usize) -> u8 {
        if self.vdelp[i] {
            self.old_grp[i]
        } else {
            self.grp[i]
        }
    }

    fn shows_ball(&self) -> bool {
        if self.vdelbl {
            self.old_enabl
        } else {
            self.enabl
        }
    }

    /// Gives an object the pixels that it has from its last change on.
    #[inline(never)]
    fn place(&mut self, object: usize) {
        match object {
            P0 | P1 => {
                let graphics = self.graphics(object);
                let without_main = self.without_main[object];
                self.put(
                    object,
                    objects::player(
                        self.x[object],
                        self.nusiz[object],
                        graphics,
                        self.refp[object],
                        without_main,
                    ),
                );
            }
            M0 | M1 if self.enam[object - M0] && !self.resmp[object - M0] => {
                self.put(
                    object,
                    objects::missile(self.x[object], self.nusiz[object - M0]),
                );
            }
            BL if self.shows_ball() => self.put(object, objects::ball(self.x[BL], self.ctrlpf)),
            PF => self.put(object, objects::playfield(self.pf, self.reflected)),
            _ => self.put(object, Pixels::default()),
        }
    }

    /// It is a part of each arm that calls it: pixels that went through memory on their way would
    /// take twice as long.
    #[inline(always)]
    fn put(&mut self, object: usize, pixels: Pixels) {
        let bit = 1 << object;
        self.stale &= !bit;
        let (from, before) = (self.from[object], self.objects.get(object));
        let pixels = if from == 0 {
            pixels
        } else {
            self.mixed |= bit;
            before.until(from, pixels)
        };
        self.differing.here = self.differing.here.union(before.difference(pixels));
        self.objects.set(object, pixels);
    }
}

/// The objects whose bits are set.
#[inline]
pub(super) fn bits(mut set: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let object = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (object < OBJECTS).then_some(object)
    })
}
