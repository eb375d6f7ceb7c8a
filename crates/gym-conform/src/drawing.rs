//! Checks of drawings and render modes.

use crate::calls::Calls;
use crate::subject::{SEEDS, STEPS, Subject, carry_on, same, tour};
use crate::verdict::{Trouble, Verdict, broken, skipped};
use gym_core::render::{RenderMode, Rendered, painter};
use gym_core::wrappers::Render;
use gym_core::{BoxEnv, Env, EnvExt};

/// The largest width and height of a frame that [`Render`] accepts.
const MAX_SIDE: u32 = 16384;

pub(crate) fn metadata_complete(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    let metadata = env.metadata();
    let modes = metadata.render_modes;
    if let Some(list) = modes.iter().find(|mode| mode.is_list()) {
        return broken(format!(
            "`render_modes` names {list}, which follows from {}",
            list.single()
        ));
    }
    if let Some((i, mode)) = modes
        .iter()
        .enumerate()
        .find(|(i, mode)| modes[..*i].contains(mode))
    {
        return broken(format!("`render_modes` names {mode} again as number {i}"));
    }
    let verdict = tour(&mut env, 0, STEPS, |env, step| match env.metadata() {
        now if now == metadata => Ok(()),
        now => broken(format!(
            "the metadata is {metadata:?} at first and {now:?} after step {step}"
        )),
    });
    match verdict {
        // another check reports failing steps
        Ok(()) | Err(Trouble::Error(_)) => (),
        verdict => return verdict,
    }
    env.reset(0)?;
    if metadata.render_fps == 0 {
        return broken("`render_fps` is 0: even without render modes it divides a second");
    }
    if modes.is_empty() {
        return match (Calls::of(&env).count, env.ansi()) {
            (0, None) => Ok(()),
            (0, _) => broken("`ansi` returns a text, but `render_modes` lacks ansi: add it"),
            _ => broken("`draw` draws, but `render_modes` lacks rgb_array: add it"),
        };
    }
    let (width, height) = metadata.render_size;
    let valid = 1..=MAX_SIDE;
    if !(valid.contains(&width) && valid.contains(&height)) {
        return broken(format!(
            "`render_size` is {width}x{height}: both must be between 1 and {MAX_SIDE}"
        ));
    }
    Ok(())
}

pub(crate) fn frame_rate(subject: &Subject<'_>) -> Verdict {
    /// The highest frame rate of common screens.
    const MAX: u32 = 240;
    match subject.make()?.metadata().render_fps {
        fps if fps > MAX => broken(format!("`render_fps` is {fps}")),
        _ => Ok(()),
    }
}

pub(crate) fn sound(subject: &Subject<'_>) -> Verdict {
    let is_drawn = is_drawn(&subject.make()?);
    for seed in SEEDS {
        tour(&mut subject.make()?, seed, STEPS, |env, step| {
            let place = format!("seed {seed}, step {step}");
            let calls = Calls::of(env);
            if let Some(fault) = calls.fault {
                return broken(format!("{place}: {fault}"));
            }
            if calls.depth != 0 {
                return broken(format!(
                    "{place}: {} of the `push`es have no `pop`",
                    calls.depth
                ));
            }
            if is_drawn && calls.count == 0 {
                return broken(format!("{place}: nothing is drawn"));
            }
            Ok(())
        })?;
    }
    subject.long_runs()?.drawing()
}

pub(crate) fn pure(subject: &Subject<'_>) -> Verdict {
    for seed in SEEDS {
        let (mut env, mut unseen) = (subject.reset(seed)?, subject.reset(seed)?);
        env.frames_drawn(0);
        for step in 0..30 {
            let (first, second) = (Calls::of(&env), Calls::of(&env));
            if first.record != second.record {
                return broken(format!(
                    "seed {seed}, step {step}: drawing one state twice makes different calls"
                ));
            }
            if env.ansi() != env.ansi() {
                return broken(format!(
                    "seed {seed}, step {step}: two calls of `ansi` for one state return different texts"
                ));
            }
            env.frames_drawn(step + 1);
            let what = "an episode that was drawn";
            same(
                &carry_on(&mut unseen, seed + step, 1)?,
                &carry_on(&mut env, seed + step, 1)?,
                what,
            )?;
        }
    }
    Ok(())
}

pub(crate) fn render_modes(subject: &Subject<'_>) -> Verdict {
    let env = subject.reset(0)?;
    let metadata = env.metadata();
    let mut unpainted = false;
    for &mode in metadata.render_modes {
        if mode != RenderMode::Ansi && painter().is_none() {
            unpainted = true;
            continue;
        }
        if mode == RenderMode::Human {
            // this mode opens a window, and shows the frames of rgb_array
            if !metadata.render_modes.contains(&RenderMode::RgbArray) {
                return broken(
                    "`render_modes` names human without rgb_array, though both show the same drawing",
                );
            }
            continue;
        }
        let rendered = Render::new(env.clone(), mode).and_then(|mut render| render.render());
        match rendered {
            Ok(Rendered::Frame(frame))
                if (frame.width(), frame.height()) == metadata.render_size => {}
            Ok(Rendered::Depth(depth) | Rendered::Rgbd(_, depth))
                if (depth.width, depth.height) == metadata.render_size
                    && depth.metres.len() as u64
                        == u64::from(depth.width) * u64::from(depth.height) => {}
            Ok(Rendered::Text(text)) if !text.trim().is_empty() => written(subject)?,
            Ok(other) => return broken(format!("the mode {mode} gives {other:?}")),
            Err(error) => return broken(format!("the mode {mode}: {error}")),
        }
    }
    if unpainted {
        return skipped("no crate that draws is linked: add gym-render and `use gym_render as _;`");
    }
    Ok(())
}

/// Checks that each state has a text, the last of an episode too.
fn written(subject: &Subject<'_>) -> Verdict {
    tour(&mut subject.make()?, SEEDS[0], STEPS, |env, step| match env
        .ansi()
        .filter(|text| !text.trim().is_empty())
    {
        Some(_) => Ok(()),
        None => broken(format!("seed {}, step {step}: there is no text", SEEDS[0])),
    })
}

fn is_drawn(env: &BoxEnv) -> bool {
    env.metadata()
        .render_modes
        .iter()
        .any(|mode| *mode != RenderMode::Ansi)
}
