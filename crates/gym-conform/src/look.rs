//! Every call that only looks.

use gym_core::canvas::{Align, Canvas, Color, Point, Shape, Transform};
use gym_core::{BoxEnv, Env};

/// Asks an environment for all that it shows.
pub(crate) fn look(env: &BoxEnv) {
    let _ = (env.observation_space(), env.action_space(), env.metadata(), env.describe());
    let _ = (env.info_map(), env.ansi(), env.snapshot().is_ok(), env.spec().is_some());
    env.draw(&mut Blank);
}

/// Takes every call and draws nothing.
struct Blank;

impl Canvas for Blank {
    fn clear(&mut self, _: Color) {}
    fn fill(&mut self, _: Shape<'_>, _: Color) {}
    fn stroke(&mut self, _: Shape<'_>, _: f64, _: Color) {}
    fn text(&mut self, _: &str, _: Point, _: f64, _: Align, _: Color) {}
    fn push(&mut self, _: Transform) {}
    fn pop(&mut self) {}
}
