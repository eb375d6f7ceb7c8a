//! The picture that is being drawn, and the previous picture.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// The visible pixels of a line.
pub(crate) const WIDTH: usize = 160;

/// The largest number of rows.
pub(crate) const HEIGHT: usize = 250;

/// A row of a picture: an even colour index for each pixel.
pub(crate) type Row = [u8; WIDTH];

/// Two pictures, drawn in turn. A frame that ends early does not overwrite the rest of its picture,
/// which keeps the content of two frames before.
#[derive(Clone, Debug)]
pub(crate) struct Screen {
    /// The rows of the first picture, then of the second.
    rows: Box<[Row]>,
    pub(crate) current: usize,
    /// Whether drawing is disabled.
    pub(crate) unseen: bool,
}

impl Screen {
    pub(crate) fn new() -> Self {
        Self {
            rows: vec![[0; WIDTH]; 2 * HEIGHT].into(),
            current: 0,
            unseen: false,
        }
    }

    pub(crate) fn swap(&mut self) {
        self.current = 1 - self.current;
    }

    pub(crate) fn picture(&self) -> &[Row] {
        &self.rows[self.current * HEIGHT..][..HEIGHT]
    }

    /// Makes `pixels` of a row black.
    pub(crate) fn blacken(&mut self, row: usize, pixels: Range<usize>) {
        if !self.unseen {
            self.row(row)[pixels].fill(0);
        }
    }

    /// Copies the previous row to a row.
    pub(crate) fn repeat_row(&mut self, row: usize) {
        if !self.unseen {
            let at = self.current * HEIGHT + row;
            self.rows[at] = self.rows[at - 1];
        }
    }

    pub(crate) fn row(&mut self, row: usize) -> &mut Row {
        &mut self.rows[self.current * HEIGHT + row]
    }
}

/// The pictures in stored form: run-length encoded.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pictures {
    current: usize,
    /// Length and colour of each run in both pictures.
    runs: Vec<(u32, u8)>,
}

impl Pictures {
    pub(crate) fn of(screen: &Screen) -> Self {
        let pixels = screen.rows.as_flattened();
        let runs = pixels
            .chunk_by(|a, b| a == b)
            .map(|run| (run.len() as u32, run[0]))
            .collect();
        Self {
            current: screen.current,
            runs,
        }
    }

    /// Decodes the pictures; `None` if they are damaged.
    pub(crate) fn screen(&self) -> Option<Screen> {
        let mut screen = Screen {
            current: (self.current < 2).then_some(self.current)?,
            ..Screen::new()
        };
        let mut rest = screen.rows.as_flattened_mut();
        for &(length, color) in &self.runs {
            let run;
            (run, rest) = rest.split_at_mut_checked(length as usize)?;
            run.fill(color);
        }
        rest.is_empty().then_some(screen)
    }
}
