//! The track: a random closed curve, and the tiles it is paved with.

use std::f64::consts::PI;

use gym_core::Generator;
use gym_core::canvas::Point;
use gym_core::math::{atan2, cos, sin};
use serde::{Deserialize, Serialize};

use super::{PLAYFIELD, SCALE};
use crate::common::sign;

const CHECKPOINTS: usize = 12;
/// The track is a heavily morphed circle of this radius.
const TRACK_RAD: f64 = 900.0 / SCALE;
const TRACK_DETAIL_STEP: f64 = 21.0 / SCALE;
const TRACK_TURN_RATE: f64 = 0.31;
/// Half the width of the road.
const TRACK_WIDTH: f64 = 40.0 / SCALE;
const BORDER: f64 = 8.0 / SCALE;
const BORDER_MIN_COUNT: usize = 4;
const _: () = assert!(1.5 * TRACK_RAD < PLAYFIELD);

/// A point of the centre line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackPoint {
    /// The direction of the point from the middle of the field; its last digit may differ from
    /// Gymnasium's, whose C library does not always round an arc tangent correctly.
    pub alpha: f64,
    /// The direction of the road: forward is (-sin, cos).
    pub beta: f64,
    /// Where it is.
    pub x: f64,
    /// Where it is.
    pub y: f64,
}

/// The part of the road between a point and the one before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tile {
    pub(super) road: [Point; 4],
    /// The kerb at the outer side of a hard turn.
    pub(super) border: Option<[Point; 4]>,
}

/// Draws tracks until one closes.
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
            rad = 1.5 * TRACK_RAD;
        }
        if c == CHECKPOINTS - 1 {
            alpha = 2.0 * PI * c as f64 / CHECKPOINTS as f64;
            rad = 1.5 * TRACK_RAD;
        }
        *checkpoint = (alpha, rad * cos(alpha), rad * sin(alpha));
    }
    let start_alpha = 2.0 * PI * -0.5 / CHECKPOINTS as f64;
    let walk = walk(&checkpoints);

    // the last whole lap: between the last two times that the start was passed
    let mut passes = (1..walk.len())
        .rev()
        .filter(|i| walk[*i].alpha > start_alpha && walk[*i - 1].alpha <= start_alpha);
    let (i2, i1) = (passes.next()?, passes.next()?);
    let track = walk.get(i1..i2 - 1)?;

    let (first, last) = (track.first()?, track.last()?);
    // how far head and tail are apart
    let (dx, dy) = (
        cos(first.beta) * (first.x - last.x),
        sin(first.beta) * (first.y - last.y),
    );
    let well_glued_together = (dx * dx + dy * dy).sqrt() <= TRACK_DETAIL_STEP;
    well_glued_together.then(|| track.to_vec())
}

/// Goes from one checkpoint to the next, for some laps.
fn walk(checkpoints: &[(f64, f64, f64); CHECKPOINTS]) -> Vec<TrackPoint> {
    let (mut x, mut y, mut beta) = (1.5 * TRACK_RAD, 0.0, 0.0);
    let mut dest_i = 0;
    let mut laps = 0;
    let mut track = Vec::new();
    let mut visited_other_side = false;
    for _ in 0..2500 {
        let mut alpha = atan2(y, x);
        if visited_other_side && alpha > 0.0 {
            laps += 1;
            visited_other_side = false;
        }
        if alpha < 0.0 {
            visited_other_side = true;
            alpha += 2.0 * PI;
        }
        // the next checkpoint, from the first again after the last
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
        // the way to the destination, across the road
        let mut proj = r1x * (dest_x - x) + r1y * (dest_y - y);
        while beta - alpha > 1.5 * PI {
            beta -= 2.0 * PI;
        }
        while beta - alpha < -1.5 * PI {
            beta += 2.0 * PI;
        }
        let prev_beta = beta;
        proj *= SCALE;
        if proj > 0.3 {
            beta -= TRACK_TURN_RATE.min((0.001 * proj).abs());
        }
        if proj < -0.3 {
            beta += TRACK_TURN_RATE.min((0.001 * proj).abs());
        }
        x += p1x * TRACK_DETAIL_STEP;
        y += p1y * TRACK_DETAIL_STEP;
        track.push(TrackPoint {
            alpha,
            beta: prev_beta * 0.5 + beta * 0.5,
            x,
            y,
        });
        if laps > 4 {
            break;
        }
    }
    track
}

/// The sharp turns, counted back from each point over the last few.
fn borders(track: &[TrackPoint]) -> Vec<bool> {
    let n = track.len();
    let back = |i: usize, by: usize| (i + n - by % n) % n;
    let mut border: Vec<bool> = (0..n)
        .map(|i| {
            let turn = |neg| track[back(i, neg)].beta - track[back(i, neg + 1)].beta;
            let turns = std::array::from_fn::<f64, BORDER_MIN_COUNT, _>(turn);
            turns.iter().all(|turn| turn.abs() > TRACK_TURN_RATE * 0.2)
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

/// Paves a track.
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
