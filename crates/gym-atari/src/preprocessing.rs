//! The usual preprocessing of Atari observations: Gymnasium's `AtariPreprocessing`.
//!
//! Source: Gymnasium 1.4.0, `wrappers/atari_preprocessing.py`; Machado et al., "Revisiting the
//! Arcade Learning Environment" (2018).

use std::any::TypeId;

use gym_core::registry::WrapperConfig;
use gym_core::{Array, Element, Env, Error, Outcome, Reset, Result, Snapshot, Space, WrapperSpec};
use serde::{Deserialize, Serialize};

use crate::action::{Action, Command};
use crate::env::{AtariAction, AtariEnv, Frameskip, buffer, bytes};
use crate::screen::WIDTH;
use crate::shrink::Shrink;

gym_core::arguments! {
    /// The arguments of the preprocessing.
    #[derive(Copy, Eq)]
    pub struct Preprocessing {
        /// The largest number of no-ops at the start of an episode. The number is random, at least
        /// 1; 0 disables no-ops.
        pub noop_max: u32 = 30,
        /// The number of frames per action.
        pub frame_skip: u32 = 4,
        /// Height and width of the observation.
        pub screen_size: [usize; 2] = [84, 84],
        /// Whether the loss of a life terminates the episode.
        pub terminal_on_life_loss: bool = false,
    }
}

/// Observes small gray images: the maximum of the last two frames of each step, scaled down.
///
/// Skipped frames are emulated but not drawn. In a spec the wrapper is named `AtariPreprocessing`,
/// with the arguments of [`Preprocessing`], around the environment of `make`.
///
/// ```no_run
/// use gym_atari::{AtariEnv, AtariPreprocessing, Config, Frameskip};
/// use gym_core::{Env, EnvExt};
/// use gym_wrappers::Wrap;
///
/// # fn main() -> gym_core::Result<()> {
/// let config = Config { game: "breakout".to_owned(), frameskip: Frameskip::Fixed(1), ..Config::default() };
/// let env = AtariPreprocessing::new(AtariEnv::new(config)?, Default::default())?;
/// let mut env = env.frame_stack(4)?;
/// env.reset(42)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct AtariPreprocessing<E: Env = AtariEnv> {
    env: E,
    /// The buffer for observations of `env`, which are not used.
    unused: E::Observation,
    settings: Preprocessing,
    shrink: Shrink,
    /// The colour indices of the last frame, and of the frame before. After the maximum over both
    /// frames, the first has the result.
    frames: [Vec<u8>; 2],
    lives: i32,
}

/// The snapshot of the environment, and the state of the wrapper.
#[derive(Serialize, Deserialize)]
struct Stored {
    env: Snapshot,
    settings: Preprocessing,
    frames: [String; 2],
    lives: i32,
}

/// The wrappers of `make` that only check calls.
const OF_MAKE: [&str; 2] = ["OrderEnforcing", "PassiveEnvChecker"];

gym_core::register_wrapper!(
    "AtariPreprocessing", "no-op starts, the brighter of two frames, small and in gray", Preprocessing,
    env: AtariPreprocessing::new
);

impl<E: Env> AtariPreprocessing<E> {
    /// Preprocesses an [`AtariEnv`] with `frameskip` 1, made directly or by `make`. It plays frames
    /// in the `AtariEnv` itself, so no other wrapper may be in between.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an environment that is not an [`AtariEnv`], another wrapper
    /// around it, another `frameskip`, a `frame_skip` of 0, or a `screen_size` that is not smaller
    /// than the picture.
    pub fn new(env: E, settings: Preprocessing) -> Result<Self> {
        let refuse = |reason: String| Err(Preprocessing::refuse(reason));
        let Some(atari) = within(&env) else {
            return refuse(format!("{} is not an Atari environment", env.describe()));
        };
        let (mut other, mut inside) = (None, "");
        env.visit_layers(&mut |layer| {
            // the last layer is the environment
            let outside = std::mem::replace(&mut inside, layer);
            if !outside.is_empty() && !OF_MAKE.contains(&outside) {
                other.get_or_insert(outside);
            }
        });
        if let Some(layer) = other {
            return refuse(format!(
                "the environment is wrapped in {layer}: wrap it in AtariPreprocessing first"
            ));
        }
        if atari.config().frameskip != Frameskip::Fixed(1) {
            return refuse(format!(
                "the environment's frameskip is {:?}: it must be 1",
                atari.config().frameskip
            ));
        }
        if !(1..=10_000).contains(&settings.frame_skip) {
            return refuse(format!(
                "frame_skip is {}: it must be at least 1 and at most 10000",
                settings.frame_skip
            ));
        }
        let rows = atari.ale().picture().len();
        let [height, width] = settings.screen_size;
        let Some(shrink) = Shrink::new(rows, (height, width), atari.ale().game().display.gray())
        else {
            return refuse(format!(
                "screen_size is {height}x{width}: it must be at most the picture's {rows}x{WIDTH}, and at least a 14th of it"
            ));
        };
        let frames = [vec![0; rows * WIDTH], vec![0; rows * WIDTH]];
        Ok(Self {
            env,
            unused: E::Observation::empty(),
            settings,
            shrink,
            frames,
            lives: 0,
        })
    }

    /// Returns the arguments.
    pub fn settings(&self) -> &Preprocessing {
        &self.settings
    }

    /// Returns the inner environment.
    pub fn get_ref(&self) -> &E {
        &self.env
    }

    /// Returns the inner environment and drops the wrapper.
    pub fn into_inner(self) -> E {
        self.env
    }

    /// Plays the frames of a step, draws the frames from number `first_seen` on, and copies the
    /// last two. Returns the sum of the rewards with the flags of the end, and whether an undrawn
    /// frame may have left an incomplete picture.
    fn play(&mut self, command: Command, first_seen: u32) -> (Outcome, bool) {
        let Self {
            env,
            settings,
            frames,
            lives,
            ..
        } = self;
        let env = within_mut(env);
        let (mut total, mut incomplete) = (Outcome::default(), false);
        for frame in 0..settings.frame_skip {
            let outcome = env.play_frame(command, frame >= first_seen);
            total = Outcome {
                reward: total.reward + outcome.reward,
                ..outcome
            };
            if settings.terminal_on_life_loss {
                let left = env.ale().lives();
                total.terminated |= left < *lives;
                *lives = left;
            }
            if total.done() {
                incomplete = true;
                break;
            }
            if frame + 2 >= settings.frame_skip {
                incomplete |= env.ale().console().is_short();
                look(env, &mut frames[(settings.frame_skip - 1 - frame) as usize]);
            }
        }
        (total, incomplete && first_seen > 0)
    }

    fn observe(&mut self, observation: &mut Array) {
        let [last, before] = &mut self.frames;
        if self.settings.frame_skip > 1 {
            brighter(last, before, self.shrink.shades);
        }
        self.shrink
            .shrink(last, buffer(observation, &self.settings.screen_size));
    }
}

/// Copies the picture of `env` to `out`.
fn look(env: &AtariEnv, out: &mut [u8]) {
    out.copy_from_slice(env.ale().picture().as_flattened());
}

/// Computes the maximum of two pictures: replaces each index of `picture` by the index of `other`
/// if the colour of `other` is brighter.
fn brighter(picture: &mut [u8], other: &[u8], grays: &[u8; 256]) {
    let cells = picture
        .as_chunks_mut::<32>()
        .0
        .iter_mut()
        .zip(other.as_chunks::<32>().0);
    for (cell, other) in cells.filter(|(cell, other)| cell != other) {
        for (index, &other) in cell.iter_mut().zip(other) {
            if grays[usize::from(*index)] < grays[usize::from(other)] {
                *index = other;
            }
        }
    }
}

/// Returns the game's environment, which may be inside the wrappers of `make`.
fn within<E: Env>(env: &E) -> Option<&AtariEnv> {
    env.any_layer(TypeId::of::<AtariEnv>())?.downcast_ref()
}

fn within_mut<E: Env>(env: &mut E) -> &mut AtariEnv {
    let layer = env
        .any_layer_mut(TypeId::of::<AtariEnv>())
        .and_then(|layer| layer.downcast_mut());
    layer.expect("the constructor found it")
}

impl<E: Env> gym_core::Wrapper for AtariPreprocessing<E> {
    type Inner = E;
    type Observation = Array;
    type Action = AtariAction;

    fn inner(&self) -> &E {
        &self.env
    }

    fn inner_mut(&mut self) -> &mut E {
        &mut self.env
    }

    fn on_observation_space(&self) -> Space {
        bytes(&self.settings.screen_size)
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut Array) -> Result<()> {
        self.env.reset_into(reset, &mut self.unused)?;
        let noops = match (self.settings.noop_max, self.env.generator()) {
            (1.., Some(rng)) => rng.integers(1, i64::from(self.settings.noop_max) + 1),
            _ => 0,
        };
        for _ in 0..noops {
            if within_mut(&mut self.env)
                .play_frame(Action::Noop.into(), true)
                .done()
            {
                self.env.reset_into(reset, &mut self.unused)?;
            }
        }
        let atari = within_mut(&mut self.env);
        self.lives = atari.ale().lives();
        look(atari, &mut self.frames[0]);
        self.frames[1].fill(0);
        self.observe(observation);
        Ok(())
    }

    fn on_step(&mut self, action: &AtariAction, observation: &mut Array) -> Result<Outcome> {
        let atari = within_mut(&mut self.env);
        let command = atari.resolve_for_step(action)?;
        let first_seen = self.settings.frame_skip.saturating_sub(2);
        let (before, lives) = (atari.moment(), self.lives);
        let (mut outcome, incomplete) = self.play(command, first_seen);
        if incomplete {
            within_mut(&mut self.env).set_moment(&before);
            self.lives = lives;
            (outcome, _) = self.play(command, 0);
        }
        self.observe(observation);
        Ok(outcome)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.settings.spec())
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        let frames = [0, 1].map(|i| crate::bytes::encode(&self.frames[i]));
        Snapshot::of(&Stored {
            env: self.env.snapshot()?,
            settings: self.settings,
            frames,
            lives: self.lives,
        })
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let Stored {
            env,
            settings,
            frames: [last, before],
            lives,
        } = snapshot.get()?;
        if settings != self.settings {
            return Err(Error::Snapshot(
                "it was taken with other settings of AtariPreprocessing".to_owned(),
            ));
        }
        let pixels = self.frames[0].len();
        let decode = |text: &str| {
            crate::bytes::decode_vec(text, pixels)
                .ok_or_else(|| Error::Snapshot(format!("its frames must have {pixels} bytes each")))
        };
        let frames = [decode(&last)?, decode(&before)?];
        self.env.restore(&env)?;
        self.frames = frames;
        self.lives = lives;
        Ok(())
    }
}
