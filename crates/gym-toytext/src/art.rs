//! Figures of several environments, drawn with 64 units per cell.

use std::f64::consts::PI;

use gym_core::canvas::{Canvas, Color, Point, Segment, Shape, Transform, arc};

/// The colour of lines, eyes, boots and poles.
pub(crate) const INK: Color = Color::rgb(46, 52, 68);
const SKIN: Color = Color::rgb(244, 206, 172);

/// The direction in which a person looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facing {
    Left,
    Down,
    Right,
    Up,
}

/// Draws a person, 50 units tall, who stands at `feet` in a coat and a woollen hat of colour
/// `color`.
pub(crate) fn person(canvas: &mut dyn Canvas, feet: Point, facing: Facing, color: Color) {
    let profile = matches!(facing, Facing::Left | Facing::Right);
    let side = if facing == Facing::Left { -1.0 } else { 1.0 };
    canvas.push(Transform::translate(feet[0], feet[1]).then(Transform::scale(side, 1.0)));
    // the body
    if profile {
        canvas.round_rect([-6.0, -7.0], [15.0, 7.0], 3.0, INK);
    } else {
        for (boot, shoulder, hand) in [(-9.0, -8.0, -13.0), (1.0, 8.0, 13.0)] {
            canvas.round_rect([boot, -7.0], [8.0, 7.0], 3.0, INK);
            canvas.line([shoulder, -22.0], [hand, -11.0], 5.5, color);
        }
    }
    canvas.polygon(
        &[[-8.0, -25.0], [8.0, -25.0], [10.0, -5.0], [-10.0, -5.0]],
        color,
    );
    if profile {
        canvas.line([0.0, -20.0], [4.0, -11.0], 5.0, INK);
    }
    // the head
    canvas.circle([0.0, -31.0], 10.0, SKIN);
    match facing {
        Facing::Left | Facing::Right => {
            canvas.circle([10.0, -29.0], 2.5, SKIN);
            canvas.circle([5.0, -30.5], 1.7, INK);
        }
        Facing::Down => {
            canvas.circle([-4.0, -29.5], 1.7, INK);
            canvas.circle([4.0, -29.5], 1.7, INK);
        }
        Facing::Up => canvas.circle([0.0, -31.0], 10.0, color),
    }
    canvas.round_rect([-9.0, -23.0], [18.0, 5.0], 2.5, Color::WHITE);
    let hat: [Point; 12] = arc([0.0, -34.0], 10.5, PI, 2.0 * PI);
    canvas.polygon(&hat, color);
    canvas.circle([0.0, -45.5], 4.0, color);
    canvas.round_rect([-11.5, -37.0], [23.0, 5.0], 2.5, Color::WHITE);
    canvas.pop();
}

/// Draws a flag on a pole, 44 units tall, standing at `foot`.
pub(crate) fn flag(canvas: &mut dyn Canvas, foot: Point, color: Color) {
    canvas.push(Transform::translate(foot[0], foot[1]));
    let cloth = [
        Segment::Move([0.0, -41.0]),
        Segment::Cubic([9.0, -45.0], [16.0, -37.0], [26.0, -41.0]),
        Segment::Line([26.0, -25.0]),
        Segment::Cubic([16.0, -21.0], [9.0, -29.0], [0.0, -25.0]),
        Segment::Close,
    ];
    canvas.fill(Shape::Path(&cloth), color);
    canvas.rect([-1.5, -43.0], [3.0, 43.0], INK);
    canvas.circle([0.0, -43.5], 2.5, INK);
    canvas.pop();
}
