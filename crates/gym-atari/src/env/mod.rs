//! The environments: ale-py's `AtariEnv` over the games of this crate.

mod action;
mod config;
pub(crate) mod ids;
pub(crate) mod keys;

use std::cell::Cell;

use gym_core::canvas::{Canvas, Color};
use gym_core::render::Metadata;
use gym_core::spaces::BoxSpace;
use gym_core::{
    Array, BoxEnv, Configure, DType, Env, EnvExt, Error, Generator, Inspect, Names, Outcome, Reset,
    Result, Seed, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::action::{Action, Command};
use crate::ale::{Ale, Moment, Settings, State};
use crate::console::{Pictures, Row};
use crate::games::Game;
use crate::rom::{self, Rom};
pub use action::AtariAction;
pub use config::{Config, Frameskip, ObsType};

/// Frames per second, as ale-py states.
const FPS: u32 = 30;

/// The name of the environment's type in ale-py.
const NAME: &str = "AtariEnv";

/// A game of the Atari 2600 as a task.
#[derive(Clone, Debug)]
pub struct AtariEnv {
    config: Config,
    md5: String,
    ale: Ale,
    episode: Option<Episode>,
}

/// The state that exists from the first reset on.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode {
    rng: Generator,
    /// The two words of the seed: set by a reset with a seed, cleared by the next step.
    #[serde(deserialize_with = "Option::deserialize")]
    seeds: Option<[u32; 2]>,
}

/// The stored form of an environment. The stored form has the checksum of the ROM, not the ROM.
#[derive(Serialize, Deserialize)]
struct Stored {
    md5: String,
    ale: State,
    screen: Pictures,
    #[serde(deserialize_with = "Option::deserialize")]
    episode: Option<Episode>,
}

impl AtariEnv {
    /// Makes the environment with the arguments `config`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an invalid argument, and for a missing ROM; the message says
    /// how to get one.
    pub fn new(config: Config) -> Result<Self> {
        let rom = rom::load(config.check()?, config.rom_dir.as_deref())?;
        Self::with_rom(config, &rom)
    }

    /// Makes the environment with a loaded ROM; [`Config::game`] becomes the ROM's game.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an invalid argument.
    pub fn with_rom(config: Config, rom: &Rom) -> Result<Self> {
        let config = Config {
            game: rom.game().name.to_owned(),
            ..config
        };
        let game = config.check()?;
        let mut ale = Ale::new(game, rom.bytes(), 0);
        let Config {
            mode,
            difficulty,
            max_num_frames_per_episode: max_frames,
            repeat_action_probability,
            ..
        } = config;
        ale.configure(Settings {
            mode,
            difficulty,
            max_frames,
            repeat_action_probability,
        });
        Ok(Self {
            config,
            md5: rom.md5().to_owned(),
            ale,
            episode: None,
        })
    }

    /// Returns the game.
    pub fn ale(&self) -> &Ale {
        &self.ale
    }

    /// Returns the game to play it directly; the environment continues from its new state.
    pub fn ale_mut(&mut self) -> &mut Ale {
        &mut self.ale
    }

    /// Returns the arguments.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Returns the actions by index.
    pub fn actions(&self) -> &'static [Action] {
        if self.config.full_action_space {
            self.game().legal
        } else {
            self.game().minimal
        }
    }

    fn game(&self) -> &'static Game {
        self.ale.game()
    }

    /// Returns the game's command for an agent's action.
    fn resolve(&self, action: &AtariAction) -> Result<Command> {
        match *action {
            AtariAction::Index(index)
                if !self.config.continuous && index < self.actions().len() =>
            {
                Ok(self.actions()[index].into())
            }
            AtariAction::Stick(stick)
                if self.config.continuous && stick.iter().all(|x| x.is_finite()) =>
            {
                let action =
                    action::from_stick(stick, self.config.continuous_action_threshold as f32);
                Ok(Command {
                    action,
                    paddle_strength: stick[0],
                })
            }
            _ => Err(self.action_space().refuse_action(action)),
        }
    }

    /// Starts an episode without computing an observation.
    pub(crate) fn start(&mut self, reset: &Reset) -> Result<()> {
        let seed = match (&reset.seed, &self.episode) {
            (Some(seed), _) => Some(seed.words()),
            (None, Some(_)) => None,
            (None, None) => Some(Seed::from_os()?.words()),
        };
        match seed {
            Some([first, second]) => {
                let seeds = reset.seed.is_some().then_some([first, second]);
                let rng = Generator::new(&Seed::from(u64::from(first)));
                self.episode = Some(Episode { rng, seeds });
                self.ale.reload(second);
            }
            None => {
                if let Some(episode) = &mut self.episode {
                    episode.seeds = None;
                }
                self.ale.reset();
            }
        }
        Ok(())
    }

    /// Takes a step without computing an observation.
    fn advance(&mut self, action: &AtariAction) -> Result<Outcome> {
        let command = self.resolve_for_step(action)?;
        let frames = match self.config.frameskip {
            Frameskip::Fixed(frames) => frames,
            Frameskip::Range([low, high]) => {
                let Some(episode) = &mut self.episode else {
                    return Err(Error::ResetNeeded("step"));
                };
                episode.rng.integers(low, high)
            }
        };
        let reward = self.ale.frames(command, frames as u32);
        Ok(self.outcome(reward))
    }

    /// Begins a step whose frames the caller plays with [`play_frame`](Self::play_frame); returns
    /// the game's command for the agent's action.
    pub(crate) fn resolve_for_step(&mut self, action: &AtariAction) -> Result<Command> {
        let command = self.resolve(action)?;
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        episode.seeds = None;
        Ok(command)
    }

    /// Plays one frame of a step.
    pub(crate) fn play_frame(&mut self, command: Command, seen: bool) -> Outcome {
        let executed = self.ale.stick(command);
        let reward = self.ale.play(executed, seen);
        self.outcome(reward)
    }

    /// Returns everything that frames change, except the pictures' contents.
    pub(crate) fn moment(&self) -> Moment {
        self.ale.moment()
    }

    /// Returns to a moment of this environment.
    pub(crate) fn set_moment(&mut self, moment: &Moment) {
        self.ale.set_moment(moment);
    }

    fn outcome(&self, reward: i32) -> Outcome {
        Outcome {
            reward: f64::from(reward),
            terminated: self.ale.game_over(),
            truncated: self.ale.is_truncated(),
        }
    }

    /// Writes the observation.
    fn observe(&self, observation: &mut Array) {
        let picture = self.ale.picture();
        let display = &self.game().display;
        match self.config.obs_type {
            ObsType::Ram => buffer(observation, &[128]).copy_from_slice(self.ale.ram().0),
            ObsType::Grayscale => {
                let out = buffer(observation, &[picture.len(), 160]);
                let grays = display.gray();
                for (gray, &index) in out.iter_mut().zip(picture.as_flattened()) {
                    *gray = grays[usize::from(index)];
                }
            }
            ObsType::Rgb => {
                let out = buffer(observation, &[picture.len(), 160, 3]);
                let colors = display.rgb();
                for (rgb, &index) in out
                    .as_chunks_mut::<3>()
                    .0
                    .iter_mut()
                    .zip(picture.as_flattened())
                {
                    *rgb = colors[usize::from(index)];
                }
            }
        }
    }
}

/// Returns the bytes of `array`. First replaces `array` if its shape or dtype is different.
pub(crate) fn buffer<'a>(array: &'a mut Array, shape: &[usize]) -> &'a mut [u8] {
    if array.shape() != shape || array.dtype() != DType::U8 {
        *array = Array::zeros(DType::U8, shape).unwrap_or_default();
    }
    array.as_mut_slice::<u8>().unwrap_or_default()
}

/// Returns the space of bytes with this shape.
pub(crate) fn bytes(shape: &[usize]) -> Space {
    Space::Box(BoxSpace::uniform(0.0, 255.0, shape, DType::U8).expect("a box of bytes"))
}

/// The state is the console's RAM, 128 bytes, and the number of lives. The state cannot be set,
/// because only a snapshot has the whole console.
impl Inspect for AtariEnv {
    fn state(&self) -> Option<Json> {
        self.episode.as_ref()?;
        Some(json!({"ram": self.ale.ram().0.as_slice(), "lives": self.ale.lives()}))
    }

    fn arguments(&self) -> Json {
        serde_json::to_value(&self.config).unwrap_or_default()
    }
}

impl Env for AtariEnv {
    type Observation = Array;
    type Action = AtariAction;

    fn observation_space(&self) -> Space {
        let rows = self.game().display.rows;
        match self.config.obs_type {
            ObsType::Rgb => bytes(&[rows, 160, 3]),
            ObsType::Grayscale => bytes(&[rows, 160]),
            ObsType::Ram => bytes(&[128]),
        }
    }

    fn action_space(&self) -> Space {
        if self.config.continuous {
            Space::boxed(
                [0.0, -action::MOST_ANGLE, 0.0],
                [1.0, action::MOST_ANGLE, 1.0],
            )
        } else {
            Space::discrete(self.actions().len() as i64)
        }
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Array) -> Result<()> {
        self.start(reset)?;
        self.observe(observation);
        Ok(())
    }

    fn step_into(&mut self, action: &AtariAction, observation: &mut Array) -> Result<Outcome> {
        let outcome = self.advance(action)?;
        self.observe(observation);
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let stored = Stored {
            md5: self.md5.clone(),
            ale: self.ale.state(),
            screen: self.ale.console().pictures(),
            episode: self.episode.clone(),
        };
        Snapshot::with_config(NAME, &self.config, &Some(stored))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let stored: Option<Stored> = snapshot.for_config(NAME, &self.config, |_| true)?;
        let not_a_state = || {
            Error::Snapshot(format!(
                "its content is not a state of {}",
                self.config.game
            ))
        };
        let Some(stored) = stored else {
            return Err(not_a_state());
        };
        if stored.md5 != self.md5 {
            let reason = format!(
                "it was taken with the ROM of MD5 {}, not {}",
                stored.md5, self.md5
            );
            return Err(Error::Snapshot(reason));
        }
        if !self.ale.restore(&stored.ale, &stored.screen) {
            return Err(not_a_state());
        }
        self.episode = stored.episode;
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        let Some(episode) = &self.episode else { return };
        visit("lives", Value::Int(self.ale.lives().into()));
        visit(
            "episode_frame_number",
            Value::Int(self.ale.episode_frame_number().into()),
        );
        visit("frame_number", Value::Int(self.ale.frame_number().into()));
        if let Some(seeds) = episode.seeds {
            visit(
                "seeds",
                Value::Tuple(seeds.map(|seed| Value::Int(seed.into())).to_vec()),
            );
        }
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(FPS, (160, self.game().display.rows as u32))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        draw(self.ale.picture(), self.game().display.rgb(), canvas);
    }

    fn describe(&self) -> String {
        NAME.to_owned()
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
    }

    fn inspect(&self) -> Option<&dyn Inspect> {
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        Some(self)
    }

    fn close(&mut self) {
        self.episode = None;
    }
}

impl Configure for AtariEnv {
    type Config = Config;

    fn configure(config: Config, _version: u32) -> Result<Self> {
        Self::new(config)
    }
}

/// The names of the bytes of an observed RAM, and of the numbers of a continuous action.
pub(crate) fn names(env: &BoxEnv) -> Names {
    let Some(config) = env.layer::<AtariEnv>().map(AtariEnv::config) else {
        return Names::default();
    };
    let action: &[_] = if config.continuous {
        &["radius of the stick", "angle of the stick (rad)", "fire"]
    } else {
        &[]
    };
    let mut names = Names::new(&[], action);
    if config.obs_type == ObsType::Ram {
        names.observation = (0x80..=0xff).map(|at| format!("byte at {at:#x}")).collect();
    }
    names
}

/// Draws a picture as rectangles of one colour: runs of equal pixels in runs of equal rows.
fn draw(picture: &[Row], colors: &[[u8; 3]; 256], canvas: &mut dyn Canvas) {
    canvas.clear(Color::BLACK);
    let mut top = 0;
    while top < picture.len() {
        let row = &picture[top];
        let height = picture[top..]
            .iter()
            .take_while(|other| *other == row)
            .count();
        let x = Cell::new(0);
        for run in row.chunk_by(|a, b| a == b) {
            let [red, green, blue] = colors[usize::from(run[0])];
            if run[0] > 1 {
                let color = Color::rgb(red, green, blue);
                canvas.rect(
                    [x.get() as f64, top as f64],
                    [run.len() as f64, height as f64],
                    color,
                );
            }
            x.set(x.get() + run.len());
        }
        top += height;
    }
}
