//! Checks of the content of pictures.

use gym_core::render::{Frame, RenderMode, painter};
use gym_core::wrappers::Render;
use gym_core::{Env, EnvExt, Value};

use crate::subject::{SEEDS, Subject, alike};
use crate::verdict::{Verdict, broken, skipped};

/// Frames that are looked at for each seed.
const FRAMES: usize = 30;

pub(crate) fn visible(subject: &Subject<'_>) -> Verdict {
    each_frame(subject, |frame, _, place| {
        let mut pixels = frame.pixels().chunks_exact(3);
        let first = pixels.next();
        match pixels.all(|pixel| Some(pixel) == first) {
            true => broken(format!("{place}: the whole picture has one colour")),
            false => Ok(Next::Frame),
        }
    })
}

pub(crate) fn follows(subject: &Subject<'_>) -> Verdict {
    let mut first = None;
    let (mut changes, mut is_followed) = (false, false);
    each_frame(subject, |frame, observation, _| {
        let (picture, seen) = first.get_or_insert_with(|| (frame.clone(), observation.clone()));
        changes = changes || !alike(seen, observation);
        is_followed = picture != frame;
        Ok(if is_followed { Next::End } else { Next::Frame })
    })?;
    if changes && !is_followed { broken("different observations have the same picture") } else { Ok(()) }
}

/// The continuation of a check.
enum Next {
    Frame,
    End,
}

/// Calls `visit` with the frames of some steps, each with its observation and its place.
fn each_frame(
    subject: &Subject<'_>,
    mut visit: impl FnMut(&Frame, &Value, &str) -> Verdict<Next>,
) -> Verdict {
    let env = subject.make()?;
    if !env.metadata().render_modes.contains(&RenderMode::RgbArray) {
        return skipped("it cannot be drawn");
    }
    if painter().is_none() {
        return skipped("no crate that draws is linked: add gym-render and `use gym_render as _;`");
    }
    let mut env = Render::new(env, RenderMode::RgbArray)?;
    for seed in SEEDS {
        let mut actions = env.action_sampler(seed)?;
        let mut observation = env.reset(seed)?;
        for step in 0..FRAMES {
            let frame = frame(&mut env)?;
            if let Next::End = visit(&frame, &observation, &format!("seed {seed}, step {step}"))? {
                return Ok(());
            }
            let next = env.step(&actions.sample())?;
            observation = if next.done() { env.reset(())? } else { next.observation };
        }
    }
    Ok(())
}

fn frame(env: &mut Render) -> gym_core::Result<Frame> {
    env.render()?.into_frame().ok_or_else(|| gym_core::Error::custom("the mode rgb_array gives no frame"))
}
