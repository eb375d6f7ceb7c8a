//! From registers to lines, and from lines to the picture.
//!
//! A line is composed object by object: a change of an object replaces its pixels from the change
//! on. So most lines are painted once, at their end; only colours, `VBLANK` and reads of collisions
//! require that earlier pixels are painted before.
//!
//! A line starts as a copy of the line above, and only pixels that may differ are painted.

use super::paint::{Colors, Objects};
use super::pixels::{Pixels, window};
use super::registers::bit;
use super::{BL, BLANK, CLOCKS_PER_LINE, M0, M1, OBJECTS, P0, P1, PF, Tia, objects};
use crate::screen::{Screen, WIDTH};

/// The pixels of the current line, and of the next line, that may differ from the line above.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Differing {
    here: Pixels,
    below: Pixels,
}

impl Differing {
    /// All pixels: the line above is unknown.
    pub(super) const ALL: Self = Self {
        here: Pixels::ALL,
        below: Pixels::ALL,
    };

    /// Marks `pixels` as changed: the pixels from `x` on in the current line, the pixels left of
    /// `x` in the next line.
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
    /// Announces that `objects` (one bit each) change at `clock` of the beam's line, which may lie
    /// beyond the line's end.
    pub(super) fn change(&mut self, objects: u8, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen) as u8;
        if x > 0 {
            self.keep_until(x, objects);
        }
        self.stale |= objects;
        self.searched = false;
    }

    /// Keeps the objects' current pixels left of `x`.
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

    /// Announces that the colours of `objects` (one bit each) change at `clock` of the beam's line.
    #[inline(always)]
    pub(super) fn change_colors(&mut self, objects: u8, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, screen);
        let pixels = bits(objects).fold(Pixels::default(), |pixels, object| {
            pixels.union(self.objects.get(object))
        });
        self.differing.add(pixels, x);
    }

    /// Announces that the colours of all pixels change at `clock` of the beam's line.
    #[inline(never)]
    pub(super) fn change_all_colors(&mut self, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, screen);
        self.differing.add(Pixels::ALL, x);
    }

    /// Paints the pixels before `clock` of the beam's line.
    pub(super) fn paint_to(&mut self, clock: u32, screen: &mut Screen) {
        let x = self.reach(clock, screen);
        self.paint(x, screen);
    }

    /// Paints the lines before the line of `clock`; returns the pixel of `clock`.
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

    /// Starts the next line.
    fn start_line(&mut self, screen: &mut Screen) {
        let Differing { here, below } = &mut self.differing;
        *here = std::mem::take(below);
        let [first, second] = self.without_main;
        if self.comb
            || first
            || second
            || self.reflected != (self.ctrlpf & bit::REFLECT_PLAYFIELD != 0)
        {
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

    /// Applies changes that take effect at the start of a line, or at the end of a visible line.
    #[inline(never)]
    fn start_row(&mut self, screen: &mut Screen) {
        // the comb of an `HMOVE` above the picture appears on the picture's first row
        if self.comb
            && let Some(row) = self.row()
        {
            screen.blacken(row, 0..8);
            self.comb = false;
            self.differing.here.0[0] |= 0xff;
        }
        // pending changes take effect at the end of a visible line
        if self.row().is_some() {
            let reflected = self.ctrlpf & bit::REFLECT_PLAYFIELD != 0;
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

    /// Returns the picture's row that is being drawn, if the line is visible.
    pub(super) fn row(&self) -> Option<usize> {
        let row = self.drawn_line.checked_sub(self.display.first_line)? as usize;
        (row < self.display.rows).then_some(row)
    }

    /// Paints the pixels before `to`.
    fn paint(&mut self, to: usize, screen: &mut Screen) {
        let from = usize::from(self.painted);
        if from >= to {
            return;
        }
        self.painted = to as u8;
        let Some(row) = self.row() else { return };
        if self.vblank & bit::BLANK != 0 {
            screen.blacken(row, from..to);
            return;
        }
        if !self.searched {
            self.search(from, to, screen.unseen);
        }
        if screen.unseen {
            return;
        }
        // the playfield's priority ends the score mode only where the line has other objects
        let (score, first) = (
            self.ctrlpf & bit::SCORE != 0,
            self.ctrlpf & bit::PRIORITY != 0,
        );
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

    /// Places changed objects and searches the pixels from `from` to `to` for collisions. With
    /// `unseen`, places only objects that can have new collisions.
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

    /// Returns the collisions that were not found yet but are possible once all objects are placed.
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
        // objects that changed within the line still show their old state
        let present = self.objects.present() | shown & self.stale;
        Objects::collisions_of(present) & !self.collisions
    }

    /// Places all changed objects, so that a stored state does not depend on whether lines were
    /// drawn.
    pub(crate) fn place_all(&mut self) {
        for object in bits(self.stale) {
            self.place(object);
        }
    }

    /// Whether the line has any object except the playfield. A player whose only copy is suppressed
    /// counts.
    fn shows_others(&self) -> bool {
        let left_out = |i: usize| self.without_main[i] && self.graphics(i) != 0;
        !self.objects.only_playfield() || left_out(0) || left_out(1)
    }

    /// Returns the graphics byte that player `i` shows.
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

    /// Sets an object's pixels from its last change on.
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

    /// Stores an object's pixels. The function is inlined into each arm of the caller: passing the
    /// pixels through memory would take twice as long.
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

/// Iterates over the objects whose bits are set.
#[inline]
pub(super) fn bits(mut set: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let object = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (object < OBJECTS).then_some(object)
    })
}
