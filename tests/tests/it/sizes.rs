//! Frames of other sizes than Gymnasium's are not drawn like pygame's, but look similar.

use gym::render::{Frame, painter};
use gym::{Env, EnvExt, Registration};

use super::sample::one_per_module;

/// Returns the mean difference, in 255ths, between a frame and one of twice its size at `pixels`.
fn difference(small: &Frame, large: &Frame, pixels: impl Iterator<Item = (usize, usize)>) -> f64 {
    let width = small.width() as usize;
    let (mut sum, mut count) = (0.0, 0);
    for (x, y) in pixels {
        for channel in 0..3 {
            let large = |dx, dy| {
                f64::from(large.pixels()[3 * (2 * width * (2 * y + dy) + 2 * x + dx) + channel])
            };
            let mean = (large(0, 0) + large(1, 0) + large(0, 1) + large(1, 1)) / 4.0;
            sum += (mean - f64::from(small.pixels()[3 * (width * y + x) + channel])).abs();
            count += 1;
        }
    }
    sum / f64::from(count)
}

/// At half the size, an edge pixel shows a sixteenth of the background: fill and outline each leave
/// a quarter.
#[test]
fn pictures_of_other_sizes_are_alike_up_to_their_edges() {
    // a tile of gym-minigrid is made for one size, which the argument `tile_size` sets
    let is_scaled = |registration: &Registration| registration.source.package != "gym-minigrid";
    for registration in one_per_module().into_iter().filter(is_scaled) {
        let id = registration.id();
        let mut env = gym::make(id).unwrap();
        let mut actions = env.action_sampler(0).unwrap();
        env.reset(3).unwrap();
        for _ in 0..30 {
            if env.step(&actions.sample()).unwrap().done() {
                break;
            }
        }
        let size = env.metadata().render_size;
        let mut painter = painter().unwrap();
        let [half, own, double] = [1, 2, 4].map(|halves| {
            let mut frame = Frame::new(halves * size.0 / 2, halves * size.1 / 2).unwrap();
            painter.paint(size, &mut |canvas| env.draw(canvas), &mut frame);
            frame
        });
        for (small, large, most_at_edges) in [(&own, &double, 2.0), (&half, &own, 255.0 / 16.0)] {
            let (width, height) = (small.width() as usize, small.height() as usize);
            let row = |y| difference(small, large, (0..width).map(|x| (x, y)));
            let column = |x| difference(small, large, (0..height).map(|y| (x, y)));
            let all = difference(
                small,
                large,
                (0..width * height).map(|i| (i % width, i / width)),
            );
            for (place, difference, most) in [
                ("the picture", all, 2.0),
                ("the top", row(0), most_at_edges),
                ("the bottom", row(height - 1), most_at_edges),
                ("the left edge", column(0), most_at_edges),
                ("the right edge", column(width - 1), most_at_edges),
            ] {
                assert!(
                    difference < most,
                    "{id}, {width}x{height}: {place} differs by {difference}"
                );
            }
        }
    }
}
