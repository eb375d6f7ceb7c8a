//! The picture of the table.

use gym_core::canvas::{Align, Canvas, Color, Label, Point, Segment, Shape, Transform};

use super::{Face, SUITS, State, Suit};

const FELT: Color = Color::rgb(36, 110, 76);
const FELT_LINE: Color = Color::rgb(88, 152, 116);
const CARD: [f64; 2] = [80.0, 112.0];
const RED: Color = Color::rgb(204, 52, 56);
const BLACK: Color = Color::rgb(38, 40, 52);
const BACK: Color = Color::rgb(56, 84, 150);

/// Draws the cards of dealer and player.
pub(super) fn table(state: &State, canvas: &mut dyn Canvas) {
    let State {
        dealer,
        player,
        suit,
        face,
    } = state;
    canvas.clear(FELT);
    let edge = Shape::Rect {
        min: [10.0, 10.0],
        size: [364.0, 356.0],
        corner: 16.0,
    };
    canvas.stroke(edge, 2.0, FELT_LINE);

    let open = dealer.cards()[0];
    canvas.text("DEALER", [32.0, 46.0], 12.0, Align::Left, Color::WHITE);
    card(canvas, [32.0, 58.0], open, *face, *suit);
    back(canvas, [124.0, 58.0]);
    canvas.text(
        &Label::new(format_args!("{open}")),
        [296.0, 134.0],
        40.0,
        Align::Center,
        Color::WHITE,
    );

    canvas.text("PLAYER", [32.0, 210.0], 12.0, Align::Left, Color::WHITE);
    let hidden = player.cards().len() - 1;
    let shift = (92.0 / hidden as f64).min(23.0);
    for (i, value) in player.cards().iter().enumerate() {
        // Gymnasium does not choose their suits, so any suit will do
        let suit = SUITS[(*suit as usize + 1 + i) % SUITS.len()];
        card(canvas, [32.0 + shift * i as f64, 222.0], *value, None, suit);
    }
    canvas.text(
        &Label::new(format_args!("{}", player.sum())),
        [296.0, 298.0],
        40.0,
        Align::Center,
        Color::WHITE,
    );
    let note = match (player.is_bust(), player.usable_ace()) {
        (true, _) => "bust",
        (_, true) => "usable ace",
        _ => "",
    };
    canvas.text(note, [296.0, 326.0], 12.0, Align::Center, Color::WHITE);
}

/// Draws an open card.
fn card(canvas: &mut dyn Canvas, corner: Point, value: u8, face: Option<Face>, suit: Suit) {
    let color = if matches!(suit, Suit::Hearts | Suit::Diamonds) {
        RED
    } else {
        BLACK
    };
    let rank = match (value, face) {
        (1, _) => Label::new(format_args!("A")),
        (_, Some(Face::Jack)) => Label::new(format_args!("J")),
        (_, Some(Face::Queen)) => Label::new(format_args!("Q")),
        (_, Some(Face::King)) => Label::new(format_args!("K")),
        _ => Label::new(format_args!("{value}")),
    };
    blank(canvas, corner);
    canvas.push(Transform::translate(corner[0], corner[1]));
    canvas.text(&rank, [11.0, 19.0], 11.0, Align::Center, color);
    pip(canvas, suit, [11.0, 30.0], 10.0, color);
    if face.is_some() {
        canvas.text(&rank, [44.0, 76.0], 40.0, Align::Center, color);
        pip(canvas, suit, [66.0, 96.0], 14.0, color);
    } else if value == 1 {
        pip(canvas, suit, [46.0, 56.0], 36.0, color);
    } else {
        let (outer, middle) = pips(value);
        for (x, column) in [(31.0, outer), (46.0, middle), (61.0, outer)] {
            for &y in column {
                // pips below the middle are upside down
                let height = if y > 0.5 { -15.0 } else { 15.0 };
                pip(canvas, suit, [x, 20.0 + 72.0 * y], height, color);
            }
        }
    }
    canvas.pop();
}

/// Returns the vertical positions, from 0 to 1, of a number card's pips: in both outer columns, and
/// in the middle.
fn pips(value: u8) -> (&'static [f64], &'static [f64]) {
    match value {
        2 => (&[], &[0.0, 1.0]),
        3 => (&[], &[0.0, 0.5, 1.0]),
        4 => (&[0.0, 1.0], &[]),
        5 => (&[0.0, 1.0], &[0.5]),
        6 => (&[0.0, 0.5, 1.0], &[]),
        7 => (&[0.0, 0.5, 1.0], &[0.25]),
        8 => (&[0.0, 0.5, 1.0], &[0.25, 0.75]),
        9 => (&[0.0, 0.33, 0.67, 1.0], &[0.5]),
        10 => (&[0.0, 0.33, 0.67, 1.0], &[0.17, 0.83]),
        _ => (&[], &[]),
    }
}

/// Draws a suit's symbol; with a negative `height` upside down.
fn pip(canvas: &mut dyn Canvas, suit: Suit, center: Point, height: f64, color: Color) {
    let half = height / 2.0;
    canvas.push(Transform {
        x: [half, 0.0],
        y: [0.0, half],
        origin: center,
    });
    match suit {
        Suit::Diamonds => {
            canvas.polygon(&[[0.0, -1.0], [0.75, 0.0], [0.0, 1.0], [-0.75, 0.0]], color);
        }
        Suit::Hearts => heart(canvas, color),
        Suit::Spades => {
            canvas.push(Transform {
                x: [1.0, 0.0],
                y: [0.0, -0.8],
                origin: [0.0, -0.2],
            });
            heart(canvas, color);
            canvas.pop();
            stem(canvas, color);
        }
        Suit::Clubs => {
            for center in [[0.0, -0.5], [-0.5, 0.2], [0.5, 0.2]] {
                canvas.circle(center, 0.48, color);
            }
            canvas.polygon(&[[0.0, -0.4], [0.4, 0.3], [-0.4, 0.3]], color);
            stem(canvas, color);
        }
    }
    canvas.pop();
}

fn heart(canvas: &mut dyn Canvas, color: Color) {
    let outline = [
        Segment::Move([0.0, 1.0]),
        Segment::Cubic([-0.4, 0.5], [-0.9, 0.2], [-0.9, -0.35]),
        Segment::Cubic([-0.9, -1.05], [-0.15, -1.15], [0.0, -0.5]),
        Segment::Cubic([0.15, -1.15], [0.9, -1.05], [0.9, -0.35]),
        Segment::Cubic([0.9, 0.2], [0.4, 0.5], [0.0, 1.0]),
        Segment::Close,
    ];
    canvas.fill(Shape::Path(&outline), color);
}

fn stem(canvas: &mut dyn Canvas, color: Color) {
    let outline = [
        Segment::Move([0.0, 0.1]),
        Segment::Quad([0.05, 0.8], [0.45, 1.0]),
        Segment::Line([-0.45, 1.0]),
        Segment::Quad([-0.05, 0.8], [0.0, 0.1]),
        Segment::Close,
    ];
    canvas.fill(Shape::Path(&outline), color);
}

/// Draws a card, face down.
fn back(canvas: &mut dyn Canvas, corner: Point) {
    blank(canvas, corner);
    let [x, y] = corner;
    canvas.round_rect(
        [x + 6.0, y + 6.0],
        [CARD[0] - 12.0, CARD[1] - 12.0],
        4.0,
        BACK,
    );
    for row in 0..6 {
        for col in 0..4 {
            let center = [
                x + 16.0 + 16.0 * f64::from(col),
                y + 16.0 + 16.0 * f64::from(row),
            ];
            pip(canvas, Suit::Diamonds, center, 12.0, Color::WHITE);
        }
    }
}

fn blank(canvas: &mut dyn Canvas, corner: Point) {
    canvas.round_rect(
        [corner[0] - 1.0, corner[1] - 1.0],
        [CARD[0] + 2.0, CARD[1] + 2.0],
        8.0,
        FELT_LINE,
    );
    canvas.round_rect(corner, CARD, 7.0, Color::WHITE);
}
