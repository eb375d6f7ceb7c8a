//! The picture of the city, in pixels of a cell of 96 by 80, and its text.

use gym_core::canvas::{Align, Canvas, Color, Point, Transform};

use super::city::{IN_TAXI, MAP, SIZE, STANDS, decode, drive};
use super::{Action, State};
use crate::art::{self, Facing, INK};

const GRASS: Color = Color::rgb(154, 202, 104);
const ASPHALT: Color = Color::rgb(96, 102, 114);
const LANE: Color = Color::rgb(150, 156, 168);
const WALL: Color = Color::rgb(150, 84, 66);
const COAT: Color = Color::rgb(124, 86, 160);
const YELLOW: Color = Color::rgb(248, 196, 50);
const GREEN: Color = Color::rgb(84, 220, 110);
/// The colours of the locations.
const COLORS: [Color; 4] = [
    Color::rgb(214, 62, 62),
    Color::rgb(44, 150, 92),
    Color::rgb(226, 160, 40),
    Color::rgb(58, 110, 186),
];
/// The margin around the cells, which are 96 by 80.
const MARGIN: f64 = 28.0;

/// Writes the map and the last action. The taxi is yellow, or green with the passenger aboard;
/// a waiting passenger is blue, the destination magenta.
pub(super) fn ansi(state: &State) -> Option<String> {
    let (row, col, passenger, destination) = decode(state.encoded);
    let mut cells = MAP.map(|line| line.chars().map(String::from).collect::<Vec<_>>());
    let mut colorize = |(row, col): (usize, usize), code: &str| {
        if let Some(cell) = cells
            .get_mut(1 + row)
            .and_then(|line| line.get_mut(1 + 2 * col))
        {
            if code == "42" && cell == " " {
                "_".clone_into(cell);
            }
            *cell = format!("\x1b[{code}m{cell}\x1b[0m");
        }
    };
    if let Some(stand) = STANDS.get(passenger) {
        colorize((row, col), "43");
        colorize(*stand, "34;1");
    } else {
        colorize((row, col), "42");
    }
    colorize(STANDS[destination], "35");
    let map = cells.map(|line| line.concat()).join("\n");
    let action = state
        .last_action
        .map_or_else(String::new, |action| format!("  ({action:?})"));
    Some(format!("{map}\n{action}\n"))
}

/// Draws the city with the taxi and its passenger.
pub(super) fn city(state: &State, canvas: &mut dyn Canvas) {
    let (row, col, passenger, destination) = decode(state.encoded);
    streets(canvas);
    for (stand, name) in ["R", "G", "Y", "B"].into_iter().enumerate() {
        let [x, y] = corner(STANDS[stand]);
        if stand == destination {
            canvas.rect([x + 4.0, y + 4.0], [88.0, 72.0], Color::WHITE);
        }
        canvas.rect([x + 8.0, y + 8.0], [80.0, 64.0], COLORS[stand]);
        canvas.rect([x + 8.0, y + 8.0], [22.0, 22.0], Color::WHITE);
        canvas.text(name, [x + 19.0, y + 25.0], 12.0, Align::Center, INK);
    }

    let [x, y] = corner((row, col));
    canvas.push(Transform {
        origin: [x + 48.0, y + 40.0],
        ..ahead(state.heading)
    });
    car(canvas, passenger == IN_TAXI);
    canvas.pop();

    let [x, y] = corner(STANDS[destination]);
    finish(canvas, [x + 10.0, y + 74.0]);
    if let Some(stand) = STANDS.get(passenger) {
        let [x, y] = corner(*stand);
        art::person(canvas, [x + 76.0, y + 74.0], Facing::Down, COAT);
    }
}

/// Returns the position of a cell in the image.
fn corner((row, col): (usize, usize)) -> Point {
    [MARGIN + 96.0 * col as f64, MARGIN + 80.0 * row as f64]
}

fn streets(canvas: &mut dyn Canvas) {
    canvas.clear(GRASS);
    canvas.rect([MARGIN - 8.0, MARGIN - 8.0], [496.0, 416.0], WALL);
    canvas.rect([MARGIN, MARGIN], [480.0, 400.0], ASPHALT);
    for (row, col) in (0..SIZE * SIZE).map(|cell| (cell / SIZE, cell % SIZE)) {
        let [x, y] = corner((row, col));
        if row + 1 < SIZE {
            for dash in [8.0, 40.0, 72.0] {
                canvas.rect([x + dash, y + 79.0], [16.0, 2.0], LANE);
            }
        }
        if drive(row, col, Action::East) != (row, col) {
            for dash in [8.0, 34.0, 60.0] {
                canvas.rect([x + 95.0, y + dash], [2.0, 12.0], LANE);
            }
        } else if col + 1 < SIZE {
            canvas.rect([x + 92.0, y], [8.0, 80.0], WALL);
        }
    }
}

/// Returns the transform to coordinates whose x axis points ahead. (The car is symmetric.)
fn ahead(heading: Action) -> Transform {
    let (x, y) = match heading {
        Action::South => ([0.0, 1.0], [1.0, 0.0]),
        Action::North => ([0.0, -1.0], [1.0, 0.0]),
        Action::West => ([-1.0, 0.0], [0.0, 1.0]),
        _ => ([1.0, 0.0], [0.0, 1.0]),
    };
    Transform {
        x,
        y,
        origin: [0.0, 0.0],
    }
}

/// Draws a taxi from above, pointing right; the sign on its roof is green while a passenger is
/// inside.
fn car(canvas: &mut dyn Canvas, taken: bool) {
    for [x, y] in [[-24.0, -21.0], [13.0, -21.0], [-24.0, 16.0], [13.0, 16.0]] {
        canvas.rect([x, y], [12.0, 5.0], INK);
    }
    canvas.round_rect([-36.0, -19.0], [72.0, 38.0], 10.0, YELLOW);
    // windows all around, and the roof
    canvas.round_rect([-26.0, -16.0], [45.0, 32.0], 8.0, INK);
    canvas.round_rect([-18.0, -13.0], [26.0, 26.0], 5.0, YELLOW);
    for y in [-14.0, 7.0] {
        canvas.rect([32.0, y], [4.0, 7.0], Color::WHITE);
        canvas.rect([-36.0, y], [3.0, 7.0], COLORS[0]);
    }
    canvas.rect([-13.0, -10.0], [15.0, 20.0], INK);
    canvas.rect(
        [-11.0, -8.0],
        [11.0, 16.0],
        if taken { GREEN } else { Color::WHITE },
    );
}

/// Draws a chequered flag.
fn finish(canvas: &mut dyn Canvas, foot: Point) {
    let [x, y] = foot;
    canvas.rect([x, y - 42.0], [24.0, 18.0], Color::WHITE);
    for (col, row) in [(0, 0), (2, 0), (1, 1), (3, 1), (0, 2), (2, 2)] {
        canvas.rect(
            [x + 6.0 * f64::from(col), y - 42.0 + 6.0 * f64::from(row)],
            [6.0, 6.0],
            INK,
        );
    }
    canvas.rect([x - 3.0, y - 42.0], [3.0, 42.0], INK);
}

#[cfg(test)]
mod tests {
    use super::super::encode;
    use super::*;

    #[test]
    fn ansi_is_gymnasiums() {
        let mut state = State {
            encoded: encode(0, 0, 0, 3),
            fickle_step: false,
            last_action: None,
            heading: Action::South,
            probability: 1.0,
        };
        let waiting = "+---------+\n|\x1b[34;1m\x1b[43mR\x1b[0m\x1b[0m: | : :G|\n| : | : : |\n| : : : : |\n\
            | | : | : |\n|Y| : |\x1b[35mB\x1b[0m: |\n+---------+\n\n";
        assert_eq!(ansi(&state).unwrap(), waiting);
        state = State {
            encoded: encode(1, 0, IN_TAXI, 3),
            last_action: Some(Action::South),
            ..state
        };
        let aboard = "+---------+\n|R: | : :G|\n|\x1b[42m_\x1b[0m: | : : |\n| : : : : |\n\
            | | : | : |\n|Y| : |\x1b[35mB\x1b[0m: |\n+---------+\n  (South)\n";
        assert_eq!(ansi(&state).unwrap(), aboard);
    }
}
