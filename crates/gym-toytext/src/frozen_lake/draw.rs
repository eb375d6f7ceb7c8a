//! The picture of the lake, with 64 units per cell.

use gym_core::Task;
use gym_core::canvas::{Canvas, Color, Point, Transform};

use super::{Action, FrozenLakeDynamics, State};
use crate::art::{self, Facing};

const ICE: Color = Color::rgb(206, 230, 246);
const SHADE: Color = Color::rgb(168, 204, 230);
const WATER: Color = Color::rgb(44, 92, 148);
const DEEP: Color = Color::rgb(30, 66, 114);
const COAT: Color = Color::rgb(214, 62, 62);
const FLAG: Color = Color::rgb(44, 150, 92);

impl FrozenLakeDynamics {
    /// Draws the map with the agent on it.
    pub(super) fn draw_lake(&self, state: &State, canvas: &mut dyn Canvas) {
        let (nrow, ncol) = self.shape();
        let (width, height) = self.metadata().render_size;
        let [w, h] = [
            f64::from(width) / ncol as f64,
            f64::from(height) / nrow as f64,
        ];
        let scale = w.min(h) / 64.0;
        canvas.clear(SHADE);
        for (cell, letter) in self.desc.iter().flat_map(|row| row.bytes()).enumerate() {
            let (row, col) = (cell / ncol, cell % ncol);
            let corner = [w * col as f64, h * row as f64];
            canvas.rect(
                [corner[0] + scale, corner[1] + scale],
                [w - 2.0 * scale, h - 2.0 * scale],
                ICE,
            );
            // from here on, the cell's centre is the origin, and its shorter side is 64
            let center = Transform::translate(corner[0] + w / 2.0, corner[1] + h / 2.0);
            canvas.push(center.then(Transform::scale(scale, scale)));
            match letter {
                b'S' => snow(canvas),
                b'G' => art::flag(canvas, [-20.0, 26.0], FLAG),
                b'H' => hole(canvas),
                _ => scratches(canvas, 3 * row + 5 * col),
            }
            if cell == state.cell {
                agent(canvas, state.last_action, letter);
            }
            canvas.pop();
        }
    }
}

/// Draws a drift of snow with footprints.
fn snow(canvas: &mut dyn Canvas) {
    canvas.round_rect([-29.0, -26.0], [58.0, 55.0], 14.0, SHADE);
    canvas.round_rect([-29.0, -29.0], [58.0, 55.0], 14.0, Color::WHITE);
    for [x, y] in [[-22.0, -20.0], [14.0, -22.0], [18.0, 6.0], [-23.0, 12.0]] {
        canvas.rect([x, y], [6.0, 2.0], SHADE);
    }
}

/// Draws the marks of skates, on some cells.
fn scratches(canvas: &mut dyn Canvas, pattern: usize) {
    let lines: &[[Point; 2]] = match pattern % 7 {
        0 => &[[[-22.0, 10.0], [-8.0, -4.0]], [[-14.0, 12.0], [-4.0, 2.0]]],
        2 => &[[[4.0, -20.0], [20.0, -8.0]], [[12.0, -22.0], [22.0, -14.0]]],
        5 => &[[[6.0, 22.0], [22.0, 6.0]]],
        _ => &[],
    };
    for [from, to] in lines {
        canvas.line(*from, *to, 2.0, Color::WHITE);
    }
}

/// Draws a hole: the far edge of the ice, the water, and its depth.
fn hole(canvas: &mut dyn Canvas) {
    canvas.round_rect([-28.0, -28.0], [56.0, 56.0], 22.0, SHADE);
    canvas.round_rect([-28.0, -20.0], [56.0, 48.0], 22.0, WATER);
    canvas.round_rect([-22.0, -8.0], [44.0, 31.0], 15.0, DEEP);
}

/// Draws the agent, which looks in the direction of the last move: next to the flag; in a hole, up
/// to the neck in water.
fn agent(canvas: &mut dyn Canvas, last_action: Option<Action>, letter: u8) {
    let facing = match last_action {
        Some(Action::Left) => Facing::Left,
        Some(Action::Right) => Facing::Right,
        Some(Action::Up) => Facing::Up,
        Some(Action::Down) | None => Facing::Down,
    };
    match letter {
        b'H' => {
            for side in [-1.0, 1.0] {
                canvas.line([8.0 * side, 6.0], [17.0 * side, -12.0], 5.5, COAT);
            }
            art::person(canvas, [0.0, 22.0], Facing::Down, COAT);
            canvas.round_rect([-22.0, 5.0], [44.0, 18.0], 8.0, DEEP);
            canvas.round_rect([-20.0, 4.0], [40.0, 3.0], 1.5, SHADE);
        }
        b'G' => art::person(canvas, [12.0, 27.0], facing, COAT),
        _ => art::person(canvas, [0.0, 25.0], facing, COAT),
    }
}
