//! Measures drawing and GIF encoding of a moving cart with a pole: `cargo run --release --example
//! drawing_speed [FILE.gif]`.

use std::path::PathBuf;
use std::time::Instant;

use gym_core::canvas::{Canvas, Color, Transform};
use gym_core::render::{Frame, Painter};
use gym_render::{Raster, Video};

const SIZE: (u32, u32) = (600, 400);
const FRAMES: u32 = 500;
const FPS: u32 = 50;

/// The state of CartPole under a simple controller, which pushes to the side to which the pole
/// falls.
struct CartPole {
    x: f64,
    x_dot: f64,
    theta: f64,
    theta_dot: f64,
}

impl CartPole {
    /// Takes one step, as in Gymnasium's `cartpole.py`.
    fn step(&mut self) {
        let side = 0.1 * self.x + 0.2 * self.x_dot + self.theta + 0.5 * self.theta_dot;
        let force = if side > 0.0 { 10.0 } else { -10.0 };
        let (sin, cos) = self.theta.sin_cos();
        let temp = (force + 0.05 * self.theta_dot * self.theta_dot * sin) / 1.1;
        let theta_acc = (9.8 * sin - cos * temp) / (0.5 * (4.0 / 3.0 - 0.1 * cos * cos / 1.1));
        let x_acc = temp - 0.05 * theta_acc * cos / 1.1;
        self.x += 0.02 * self.x_dot;
        self.x_dot += 0.02 * x_acc;
        self.theta += 0.02 * self.theta_dot;
        self.theta_dot += 0.02 * theta_acc;
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        canvas.clear(Color::WHITE);
        canvas.line([0.0, 300.0], [600.0, 300.0], 1.0, Color::BLACK);
        canvas.push(Transform::translate(300.0 + 125.0 * self.x, 300.0));
        canvas.polygon(
            &[[-25.0, -15.0], [25.0, -15.0], [25.0, 15.0], [-25.0, 15.0]],
            Color::BLACK,
        );
        canvas.push(Transform::translate(0.0, -7.5));
        canvas.push(Transform::rotate(self.theta));
        canvas.polygon(
            &[[-5.0, 5.0], [5.0, 5.0], [5.0, -120.0], [-5.0, -120.0]],
            Color::rgb(202, 152, 101),
        );
        canvas.pop();
        canvas.circle([0.0, 0.0], 5.0, Color::rgb(129, 132, 203));
        canvas.pop();
        canvas.pop();
    }
}

fn main() -> gym_core::Result<()> {
    let path = std::env::args_os()
        .nth(1)
        .map_or_else(|| std::env::temp_dir().join("speed.gif"), PathBuf::from);
    let mut raster = Raster::new();
    let mut frame = Frame::new(SIZE.0, SIZE.1)?;
    let mut env = CartPole {
        x: 0.03,
        x_dot: -0.02,
        theta: 0.04,
        theta_dot: 0.01,
    };
    let mut paint = |frame: &mut Frame| {
        env.step();
        raster.paint(SIZE, &mut |canvas| env.draw(canvas), frame);
    };

    let frames: Vec<Frame> = (0..FRAMES)
        .map(|_| {
            paint(&mut frame);
            frame.clone()
        })
        .collect();
    let start = Instant::now();
    let mut video = Video::create(&path, FPS)?;
    frames.iter().try_for_each(|frame| video.write(frame))?;
    video.finish()?;
    let bytes = std::fs::metadata(&path).map_or(0, |file| file.len());
    println!(
        "{FRAMES} frames: {:.3} s, {bytes} bytes, {}",
        start.elapsed().as_secs_f64(),
        path.display()
    );

    let count = 20_000;
    let start = Instant::now();
    (0..count).for_each(|_| paint(&mut frame));
    println!(
        "drawing: {:.0} frames/s",
        f64::from(count) / start.elapsed().as_secs_f64()
    );
    Ok(())
}
