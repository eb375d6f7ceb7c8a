//! Checks of the content of pictures.

use std::collections::BTreeSet;

use gym_core::render::{Frame, RenderMode, painter};
use gym_core::wrappers::Render;
use gym_core::{Env, EnvExt};

use crate::subject::{SEEDS, Subject};
use crate::verdict::{Verdict, broken, skipped};

/// Frames that are looked at for each seed.
const FRAMES: usize = 30;

pub(crate) fn visible(subject: &Subject<'_>) -> Verdict {
    each_frame(subject, |frame, _, place| {
        let mut pixels = frame.pixels().chunks_exact(3);
        let first = pixels.next();
        match pixels.all(|pixel| Some(pixel) == first) {
            true => broken(format!("{place}: the whole picture has one colour")),
            false => Ok(()),
        }
    })
}

pub(crate) fn follows(subject: &Subject<'_>) -> Verdict {
    let (mut frames, mut observations) = (BTreeSet::new(), BTreeSet::new());
    each_frame(subject, |frame, observation, _| {
        frames.insert(frame.pixels().to_vec());
        observations.insert(observation.to_owned());
        Ok(())
    })?;
    match (frames.len(), observations.len()) {
        (1, 2..) => broken(format!("{} different observations have the same picture", observations.len())),
        _ => Ok(()),
    }
}

/// Calls `visit` with the frames of some steps, each with the text of its observation and its place.
fn each_frame(subject: &Subject<'_>, mut visit: impl FnMut(&Frame, &str, &str) -> Verdict) -> Verdict {
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
            visit(&frame, &format!("{observation:?}"), &format!("seed {seed}, step {step}"))?;
            let next = env.step(&actions.sample())?;
            observation = if next.done() { env.reset(())? } else { next.observation };
        }
    }
    Ok(())
}

fn frame(env: &mut Render) -> gym_core::Result<Frame> {
    env.render()?.into_frame().ok_or_else(|| gym_core::Error::custom("the mode rgb_array gives no frame"))
}
