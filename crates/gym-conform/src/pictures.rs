//! Checks of the content of frames.

use std::ops::ControlFlow;

use gym_core::render::{Frame, RenderMode, painter};
use gym_core::wrappers::Render;
use gym_core::{Env, EnvExt, Value};

use crate::subject::{SEEDS, Subject, alike};
use crate::verdict::{Verdict, broken, skipped};

/// The number of frames for each seed.
const FRAMES: usize = 30;

pub(crate) fn visible(subject: &Subject<'_>) -> Verdict {
    each_frame(subject, |frame, _, place| {
        let mut pixels = frame.pixels().chunks_exact(3);
        let first = pixels.next();
        match pixels.all(|pixel| Some(pixel) == first) {
            true => broken(format!("{place}: the whole picture has one colour")),
            false => Ok(ControlFlow::Continue(())),
        }
    })
    .map(drop)
}

pub(crate) fn follows(subject: &Subject<'_>) -> Verdict {
    let (mut first, mut changes) = (None, false);
    let frames = each_frame(subject, |frame, observation, _| {
        let (picture, seen) = first.get_or_insert_with(|| (frame.clone(), observation.clone()));
        changes = changes || !alike(seen, observation);
        Ok(if picture == frame {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        })
    })?;
    match changes && frames.is_continue() {
        true => broken("different observations have the same picture"),
        false => Ok(()),
    }
}

/// Calls `visit` after each reset and step with the frame, the observation and a description of the
/// place. Stops when `visit` returns `Break`.
fn each_frame(
    subject: &Subject<'_>,
    mut visit: impl FnMut(&Frame, &Value, &str) -> Verdict<ControlFlow<()>>,
) -> Verdict<ControlFlow<()>> {
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
            if visit(&frame, &observation, &format!("seed {seed}, step {step}"))?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
            let next = env.step(&actions.sample())?;
            observation = if next.done() {
                let place = format!("seed {seed}, after the end in step {step}");
                let last = self::frame(&mut env)?;
                if visit(&last, &next.observation, &place)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                env.reset(())?
            } else {
                next.observation
            };
        }
    }
    Ok(ControlFlow::Continue(()))
}

fn frame(env: &mut Render) -> gym_core::Result<Frame> {
    env.render()?
        .into_frame()
        .ok_or_else(|| gym_core::Error::custom("the mode rgb_array gives no frame"))
}
