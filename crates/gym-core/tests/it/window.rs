//! The mode `human` without a display: the environment stays unchanged.

use std::sync::atomic::{AtomicBool, Ordering};

use gym_core::canvas::Canvas;
use gym_core::render::{
    Frame, Metadata, Painter, PainterProvider, RenderMode, Screen, ScreenProvider,
};
use gym_core::wrappers::Render;
use gym_core::{Env, EnvExt, Error, Outcome, Reset, Result, Space};

/// An environment that counts its resets and its steps.
#[derive(Clone, Default)]
struct Counter {
    resets: i64,
    steps: i64,
}

impl Env for Counter {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(100)
    }

    fn action_space(&self) -> Space {
        Space::discrete(1)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        self.resets += 1;
        *observation = self.steps;
        Ok(())
    }

    fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome::default())
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(50, (4, 4))
    }
}

struct Nothing;

impl Painter for Nothing {
    fn paint(&mut self, _: (u32, u32), _: &mut dyn FnMut(&mut dyn Canvas), _: &mut Frame) {}
}

impl Screen for Nothing {
    fn show(&mut self, _: &Frame) -> bool {
        true
    }
}

static HAS_DISPLAY: AtomicBool = AtomicBool::new(false);

gym_core::inventory::submit! { PainterProvider { new: || Box::new(Nothing) } }
gym_core::inventory::submit! {
    ScreenProvider {
        open: |_, _, _| match HAS_DISPLAY.load(Ordering::Relaxed) {
            true => Ok(Box::new(Nothing)),
            false => Err(Error::custom("no display")),
        },
    }
}

#[test]
fn nothing_moves_where_the_window_cannot_be_opened() {
    let mut env = Render::new(Counter::default(), RenderMode::Human).unwrap();
    assert!(env.reset(0).is_err() && env.step(&0).is_err());
    assert_eq!((env.get_ref().resets, env.get_ref().steps), (0, 0));
    HAS_DISPLAY.store(true, Ordering::Relaxed);
    assert_eq!(env.reset(0).unwrap(), 0);
    assert_eq!(env.step(&0).unwrap().observation, 1);
    assert_eq!((env.get_ref().resets, env.get_ref().steps), (1, 1));
}
