//! The track: a random closed curve, and its tiles.

use std::f64::consts::PI;

use gym_core::Generator;
use gym_core::canvas::Point;
use gym_core::math::{atan2, cos, sin};
use serde::{Deserialize, Serialize};

use super::{PLAYFIELD, SCALE};
use crate::shapes::sign;

const CHECKPOINTS: usize = 12;
/// The radius of the circle around which the checkpoints lie.
const TRACK_RAD: f64 = 900.0 / SCALE;
const TRACK_DETAIL_STEP: f64 = 21.0 / SCALE;
const TRACK_TURN_RATE: f64 = 0.31;
/// The radius of the first and the last checkpoint, which lie outside of the circle.
const START_RAD: f64 = 1.5 * TRACK_RAD;
/// Generation stops after this number of points or laps.
const MAX_POINTS: usize = 2500;
const MAX_LAPS: u32 = 4;
/// The road turns only if the destination is further to the side than this, in scaled m.
const MIN_OFFSET: f64 = 0.3;
/// The turn of the road per scaled m of the destination's sideways distance, in rad.
const TURN_PER_OFFSET: f64 = 0.001;
/// The turn of a sharp bend per point, relative to [`TRACK_TURN_RATE`].
const SHARP_TURN: f64 = 0.2;
/// Half the width of the road.
const TRACK_WIDTH: f64 = 40.0 / SCALE;
const BORDER: f64 = 8.0 / SCALE;
const BORDER_MIN_COUNT: usize = 4;
const _: () = assert!(START_RAD < PLAYFIELD);

/// A point of the centre line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackPoint {
    /// The direction of the point from the middle of the playfield. Its last bits may differ from
    /// Gymnasium's, whose C library does not always round an arc tangent correctly.
    pub alpha: f64,
    /// The direction of the road: forward is (-sin, cos).
    pub beta: f64,
    /// The x coordinate, in m.
    pub x: f64,
    /// The y coordinate, in m.
    pub y: f64,
}

/// The part of the road between a track point and its predecessor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tile {
    pub(super) road: [Point; 4],
    /// The kerb at the outer side of a sharp turn.
    #[serde(deserialize_with = "Option::deserialize")]
    pub(super) border: Option<[Point; 4]>,
}

/// Generates random tracks until one closes.
pub(super) fn generate(rng: &mut Generator) -> Vec<TrackPoint> {
    loop {
        if let Some(track) = attempt(rng) {
            return track;
        }
    }
}

fn attempt(rng: &mut Generator) -> Option<Vec<TrackPoint>> {
    let mut checkpoints = [(0.0, 0.0, 0.0); CHECKPOINTS];
    for (c, checkpoint) in checkpoints.iter_mut().enumerate() {
        let noise = rng.uniform(0.0, 2.0 * PI * 1.0 / CHECKPOINTS as f64);
        let mut alpha = 2.0 * PI * c as f64 / CHECKPOINTS as f64 + noise;
        let mut rad = rng.uniform(TRACK_RAD / 3.0, TRACK_RAD);
        if c == 0 {
            alpha = 0.0;
            rad = START_RAD;
        }
        if c == CHECKPOINTS - 1 {
            alpha = 2.0 * PI * c as f64 / CHECKPOINTS as f64;
            rad = START_RAD;
        }
        *checkpoint = (alpha, rad * cos(alpha), rad * sin(alpha));
    }
    let start_alpha = 2.0 * PI * -0.5 / CHECKPOINTS as f64;
    let walk = walk(&checkpoints);

    // the last complete lap: between the last two passes of the start
    let mut passes = (1..walk.len())
        .rev()
        .filter(|i| walk[*i].alpha > start_alpha && walk[*i - 1].alpha <= start_alpha);
    let (i2, i1) = (passes.next()?, passes.next()?);
    let track = walk.get(i1..i2 - 1)?;

    let (first, last) = (track.first()?, track.last()?);
    // the gap between the first and the last point
    let (dx, dy) = (
        cos(first.beta) * (first.x - last.x),
        sin(first.beta) * (first.y - last.y),
    );
    let well_glued_together = (dx * dx + dy * dy).sqrt() <= TRACK_DETAIL_STEP;
    well_glued_together.then(|| track.to_vec())
}

/// Walks from checkpoint to checkpoint for several laps.
fn walk(checkpoints: &[(f64, f64, f64); CHECKPOINTS]) -> Vec<TrackPoint> {
    let (mut x, mut y, mut beta) = (START_RAD, 0.0, 0.0);
    let mut dest_i = 0;
    let mut laps = 0;
    let mut track = Vec::new();
    let mut visited_other_side = false;
    for _ in 0..MAX_POINTS {
        let mut alpha = atan2(y, x);
        if visited_other_side && alpha > 0.0 {
            laps += 1;
            visited_other_side = false;
        }
        if alpha < 0.0 {
            visited_other_side = true;
            alpha += 2.0 * PI;
        }
        // the next checkpoint; the first follows the last
        let (dest_x, dest_y) = 'found: loop {
            loop {
                let (dest_alpha, dest_x, dest_y) = checkpoints[dest_i % CHECKPOINTS];
                if alpha <= dest_alpha {
                    break 'found (dest_x, dest_y);
                }
                dest_i += 1;
                if dest_i % CHECKPOINTS == 0 {
                    break;
                }
            }
            alpha -= 2.0 * PI;
        };
        let (r1x, r1y) = (cos(beta), sin(beta));
        let (p1x, p1y) = (-r1y, r1x);
        // the destination's offset to the side of the road
        let mut proj = r1x * (dest_x - x) + r1y * (dest_y - y);
        while beta - alpha > 1.5 * PI {
            beta -= 2.0 * PI;
        }
        while beta - alpha < -1.5 * PI {
            beta += 2.0 * PI;
        }
        let prev_beta = beta;
        proj *= SCALE;
        if proj > MIN_OFFSET {
            beta -= TRACK_TURN_RATE.min((TURN_PER_OFFSET * proj).abs());
        }
        if proj < -MIN_OFFSET {
            beta += TRACK_TURN_RATE.min((TURN_PER_OFFSET * proj).abs());
        }
        x += p1x * TRACK_DETAIL_STEP;
        y += p1y * TRACK_DETAIL_STEP;
        track.push(TrackPoint {
            alpha,
            beta: prev_beta * 0.5 + beta * 0.5,
            x,
            y,
        });
        if laps > MAX_LAPS {
            break;
        }
    }
    track
}

/// Returns for each point whether the road turns sharply over the last few points.
fn borders(track: &[TrackPoint]) -> Vec<bool> {
    let n = track.len();
    let back = |i: usize, by: usize| (i + n - by % n) % n;
    let mut border: Vec<bool> = (0..n)
        .map(|i| {
            let turn = |neg| track[back(i, neg)].beta - track[back(i, neg + 1)].beta;
            let turns = std::array::from_fn::<f64, BORDER_MIN_COUNT, _>(turn);
            turns
                .iter()
                .all(|turn| turn.abs() > TRACK_TURN_RATE * SHARP_TURN)
                && (turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0))
        })
        .collect();
    for i in 0..n {
        for neg in 0..BORDER_MIN_COUNT {
            border[back(i, neg)] |= border[i];
        }
    }
    border
}

/// Returns the tiles of `track`.
pub(super) fn tiles(track: &[TrackPoint]) -> Vec<Tile> {
    let border = borders(track);
    let across = |p: &TrackPoint, d: f64| [p.x + d * cos(p.beta), p.y + d * sin(p.beta)];
    (0..track.len())
        .map(|i| {
            let (p1, p2) = (&track[i], &track[(i + track.len() - 1) % track.len()]);
            let road = [
                across(p1, -TRACK_WIDTH),
                across(p1, TRACK_WIDTH),
                across(p2, TRACK_WIDTH),
                across(p2, -TRACK_WIDTH),
            ];
            let border = border[i].then(|| {
                let side = sign(p2.beta - p1.beta);
                let (inner, outer) = (side * TRACK_WIDTH, side * (TRACK_WIDTH + BORDER));
                [
                    across(p1, inner),
                    across(p1, outer),
                    across(p2, outer),
                    across(p2, inner),
                ]
            });
            Tile { road, border }
        })
        .collect()
}
