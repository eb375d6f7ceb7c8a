//! The picture of one cell: shapes drawn at three times the size, then averaged.

use super::shapes::Shape;
use crate::{Cell, Kind, State};

/// The factor by which shapes are drawn larger.
const SUBDIVISIONS: usize = 3;

/// The content of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Scene {
    /// Kind, colour and state.
    object: [u8; 3],
    /// The direction of the agent, if it is on this cell.
    agent: Option<u8>,
    /// Whether the agent sees the cell.
    highlight: bool,
}

/// A rectangle of one colour within a tile: column, row, width, height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) place: [u16; 4],
    pub(super) color: [u8; 3],
}

type Layers = Vec<(Shape, [u8; 3])>;

const BLACK: [u8; 3] = [0; 3];

impl Scene {
    pub(super) fn new(cell: Cell, agent: Option<u8>, highlight: bool) -> Self {
        Self {
            object: cell.encode(),
            agent,
            highlight,
        }
    }

    /// Draws the tile of `size` by `size` pixels as patches, without black patches.
    pub(super) fn patches(&self, cell: Cell, size: usize) -> Vec<Patch> {
        let pixels = self.pixels(cell, size);
        let rows: Vec<&[[u8; 3]]> = pixels.chunks(size).collect();
        let mut patches = Vec::new();
        let mut top = 0;
        for same in rows.chunk_by(|a, b| a == b) {
            let mut left = 0;
            for run in same[0].chunk_by(|a, b| a == b) {
                if run[0] != BLACK {
                    patches.push(Patch {
                        place: [left, top, run.len(), same.len()].map(|n| n as u16),
                        color: run[0],
                    });
                }
                left += run.len();
            }
            top += same.len();
        }
        patches
    }

    fn pixels(&self, cell: Cell, size: usize) -> Vec<[u8; 3]> {
        let fine = size * SUBDIVISIONS;
        let layers = self.layers(cell);
        let at = |n: usize| (n as f64 + 0.5) / fine as f64;
        let color = |column: usize, row: usize| {
            let (x, y) = (at(column), at(row));
            let top = layers.iter().rev().find(|(shape, _)| shape.has(x, y));
            let color = top.map_or(BLACK, |(_, color)| *color);
            if self.highlight {
                color.map(|c| (f64::from(c) + 0.3 * f64::from(255 - c)) as u8)
            } else {
                color
            }
        };
        let array: Vec<[u8; 3]> = (0..fine * fine)
            .map(|i| color(i % fine, i / fine))
            .collect();
        // numpy's order: the mean of each row of three, then the mean of the three rows
        let mean = |three: [f64; 3]| (three[0] + three[1] + three[2]) / SUBDIVISIONS as f64;
        let average = |i: usize| {
            let (column, row) = (i % size * SUBDIVISIONS, i / size * SUBDIVISIONS);
            [0, 1, 2].map(|channel| {
                let row = |y: usize| {
                    mean(
                        [0, 1, 2].map(|x| f64::from(array[(row + y) * fine + column + x][channel])),
                    )
                };
                mean([row(0), row(1), row(2)]) as u8
            })
        };
        (0..size * size).map(average).collect()
    }

    /// Returns the shapes of the tile; later shapes cover earlier shapes.
    fn layers(&self, cell: Cell) -> Layers {
        let grey = [100; 3];
        let mut layers = vec![
            (Shape::Rect([0.0, 0.031, 0.0, 1.0]), grey),
            (Shape::Rect([0.0, 1.0, 0.0, 0.031]), grey),
        ];
        object(cell, &mut layers);
        if let Some(direction) = self.agent {
            layers.push((Shape::Agent(direction), [255, 0, 0]));
        }
        layers
    }
}

/// Adds the shapes of an object.
fn object(cell: Cell, layers: &mut Layers) {
    let color = cell.color().rgb();
    let mut rect = |edges: [f64; 4], color| layers.push((Shape::Rect(edges), color));
    let whole = [0.0, 1.0, 0.0, 1.0];
    match cell.kind() {
        Kind::Unseen | Kind::Empty | Kind::Agent => {}
        Kind::Wall | Kind::Goal => rect(whole, color),
        Kind::Floor => rect([0.031, 1.0, 0.031, 1.0], color.map(|c| c / 2)),
        Kind::Lava => {
            rect(whole, [255, 128, 0]);
            for wave in 0..3 {
                let [low, high] = [0.3, 0.4].map(|y| y + 0.2 * f64::from(wave));
                for ends in [
                    [0.1, low, 0.3, high],
                    [0.3, high, 0.5, low],
                    [0.5, low, 0.7, high],
                    [0.7, high, 0.9, low],
                ] {
                    layers.push((Shape::Line(ends, 0.03), BLACK));
                }
            }
        }
        Kind::Door if cell.is_door(State::Open) => {
            rect([0.88, 1.0, 0.0, 1.0], color);
            rect([0.92, 0.96, 0.04, 0.96], BLACK);
        }
        Kind::Door if cell.is_door(State::Locked) => {
            rect(whole, color);
            rect(
                [0.06, 0.94, 0.06, 0.94],
                color.map(|c| (0.45 * f64::from(c)) as u8),
            );
            rect([0.52, 0.75, 0.5, 0.56], color);
        }
        Kind::Door => {
            rect(whole, color);
            rect([0.04, 0.96, 0.04, 0.96], BLACK);
            rect([0.08, 0.92, 0.08, 0.92], color);
            rect([0.12, 0.88, 0.12, 0.88], BLACK);
            layers.push((Shape::Circle([0.75, 0.5, 0.08]), color));
        }
        Kind::Key => {
            rect([0.5, 0.63, 0.31, 0.88], color);
            rect([0.38, 0.5, 0.59, 0.66], color);
            rect([0.38, 0.5, 0.81, 0.88], color);
            layers.push((Shape::Circle([0.56, 0.28, 0.19]), color));
            layers.push((Shape::Circle([0.56, 0.28, 0.064]), BLACK));
        }
        Kind::Ball => layers.push((Shape::Circle([0.5, 0.5, 0.31]), color)),
        Kind::Box => {
            rect([0.12, 0.88, 0.12, 0.88], color);
            rect([0.18, 0.82, 0.18, 0.82], BLACK);
            rect([0.16, 0.84, 0.47, 0.53], color);
        }
    }
}
