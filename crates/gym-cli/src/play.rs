//! `cargo xtask play ID`

#[cfg(all(feature = "human", feature = "families"))]
mod sliders;
#[cfg(feature = "human")]
mod window;

use std::io::BufRead;
use std::path::PathBuf;
#[cfg(feature = "human")]
use std::time::Duration;

use gym::render::{Frame, RenderMode, Video, file};
use gym::trace::{Event, Trace};
use gym::{BoxEnv, Env, EnvExt, Error, Kwargs, Reset, Result, Seed};
use serde_json::{Value as Json, json};

use gym::keys::{Idle, Keys};

use crate::inputs;
use crate::keys;
use crate::output::{self, say};

/// The duration for which a window shows the end of an episode.
#[cfg(feature = "human")]
const PAUSE: Duration = Duration::from_millis(800);

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environment.
    id: String,
    /// Seeds the first episode. Without it, a trace records a seed that is drawn.
    #[arg(long, allow_negative_numbers = true, value_parser = inputs::parse_seed)]
    seed: Option<u64>,
    /// Arguments of the environment, as a JSON object.
    #[arg(long, value_parser = inputs::parse_kwargs, default_value = "{}")]
    kwargs: Kwargs,
    /// Plays in the terminal, for environments that have a text form.
    #[arg(long)]
    terminal: bool,
    /// Frames per second, if not the environment's own.
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=1000))]
    fps: Option<u32>,
    /// Enlarges the picture.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=8))]
    zoom: u32,
    /// Gives a key an action in JSON, as in `--key A=0` or `--key Space=[1.0]`.
    #[arg(long = "key", value_parser = parse_key)]
    keys: Vec<(String, Json)>,
    /// The action while no key is down; `null` waits for a key.
    #[arg(long, value_parser = parse_json)]
    idle: Option<Json>,
    /// Stops after this number of episodes.
    #[arg(long, allow_negative_numbers = true, value_parser = inputs::parse_count)]
    episodes: Option<u64>,
    /// Records the frames to this file: .gif, .png (animated) or .mp4.
    #[arg(long)]
    record: Option<PathBuf>,
    /// Records the actions and results to this file, for `replay`.
    #[arg(long)]
    trace: Option<PathBuf>,
}

impl Arguments {
    /// Returns the reset that begins the first episode. With a trace but without `--seed`, draws a
    /// seed, because a trace without a seed cannot be replayed.
    fn first_reset(&self) -> Result<Reset> {
        Ok(match (self.seed, &self.trace) {
            (None, Some(_)) => Reset::from(u64::from(Seed::from_os()?.words()[0])),
            (seed, _) => Reset::from(seed),
        })
    }
}

fn parse_json(text: &str) -> Result<Json, String> {
    inputs::parse_json(text).map_err(|error| format!("not JSON: {error}"))
}

fn parse_key(text: &str) -> Result<(String, Json), String> {
    let (name, action) = text
        .split_once('=')
        .ok_or("write NAME=ACTION, as in Left=0")?;
    Ok((name.to_owned(), parse_json(action)?))
}

pub(crate) fn play(arguments: &Arguments) -> Result<()> {
    if !arguments.terminal && !cfg!(feature = "human") {
        return Err(Error::custom(
            "this program was built without windows: run `cargo xtask play`, or add `--terminal`",
        ));
    }
    let mut session = Session::start(arguments)?;
    let played = game(&mut session, arguments);
    if played.is_err() && session.trace.events.len() < 2 {
        // nothing was played: there is nothing to record
        if let Some(video) = session.video {
            video.abandon();
        }
        return played;
    }
    // finish the recordings even if the game ended with an error
    played.and(session.finish(arguments))
}

/// Plays in the terminal or in a window, with the keys of the environment and of the user.
fn game(session: &mut Session, arguments: &Arguments) -> Result<()> {
    let mut keys = keys::of(&session.trace.id, &session.env)?;
    for (i, (key, action)) in arguments.keys.iter().enumerate() {
        let is_it = |(other, _): &(String, Json)| other.eq_ignore_ascii_case(key);
        if arguments.keys[..i].iter().any(is_it) {
            let reason = format!("`{key}` has two actions: give it one");
            return Err(Error::argument("--key", reason));
        }
        keys::set(&mut keys, key, action.clone());
    }
    match &arguments.idle {
        None => {}
        Some(Json::Null) => keys.idle = Idle::Wait,
        Some(action) => keys.idle = Idle::Action(action.clone()),
    }
    if arguments.terminal || !has_sliders(session) || !keys.actions.is_empty() {
        keys::check(&keys, &session.env.action_space())?;
        say(format_args!("{}", keys::describe(&keys)))?;
    }
    if arguments.terminal {
        in_terminal(session, &keys)
    } else {
        in_window(session, &keys, arguments)
    }
}

/// The running game and its recordings.
struct Session {
    env: BoxEnv,
    frame: Frame,
    video: Option<Video>,
    trace: Trace,
    episode: u64,
    episodes: Option<u64>,
    steps: u64,
    reward: f64,
    score: f64,
}

impl Session {
    /// Makes the environment and resets it.
    fn start(arguments: &Arguments) -> Result<Self> {
        let builder = gym::builder(&arguments.id).args(arguments.kwargs.clone());
        let spec = builder.clone().spec()?;
        let (width, height) = builder.clone().build()?.metadata().render_size;
        let builder = builder.render_mode(RenderMode::RgbArray);
        let env = builder
            .render_size(width * arguments.zoom, height * arguments.zoom)
            .build()?;
        let fps = arguments.fps.unwrap_or(env.metadata().render_fps);
        let files = [
            ("--record", &arguments.record),
            ("--trace", &arguments.trace),
        ];
        inputs::check_distinct(files)?;
        if let Some(path) = &arguments.trace {
            inputs::check_writable(path)?;
        }
        let video = arguments
            .record
            .as_ref()
            .map(|path| Video::create(path, fps))
            .transpose()?;
        let mut session = Self {
            env,
            frame: Frame::default(),
            video,
            trace: Trace {
                id: spec.id,
                kwargs: arguments.kwargs.clone(),
                ..Trace::default()
            },
            episode: 0,
            episodes: arguments.episodes,
            steps: 0,
            reward: 0.0,
            score: 0.0,
        };
        session.reset(arguments.first_reset()?)?;
        Ok(session)
    }

    fn reset(&mut self, reset: Reset) -> Result<()> {
        let request = (&reset).into();
        let observation = self.env.reset(reset)?;
        (self.steps, self.reward, self.score) = (0, 0.0, 0.0);
        self.episode += 1;
        self.record(Event {
            reset: Some(request),
            observation: Some(observation.to_json()),
            ..Event::default()
        })
    }

    /// Takes a step. Returns whether the episode is over.
    fn step(&mut self, action: &Json) -> Result<bool> {
        let step = self.env.step(&self.env.action_space().from_json(action)?)?;
        self.steps += 1;
        self.reward = step.reward;
        self.score += step.reward;
        let done = step.done();
        self.record(Event {
            step: Some(action.clone()),
            observation: Some(step.observation.to_json()),
            reward: Some(json!(step.reward)),
            terminated: Some(json!(step.terminated)),
            truncated: Some(json!(step.truncated)),
            ..Event::default()
        })?;
        if done {
            say(format_args!("{}", self.status()))?;
        }
        Ok(done)
    }

    fn record(&mut self, event: Event) -> Result<()> {
        let info = self
            .env
            .info_map()
            .into_iter()
            .map(|(key, value)| (key, value.to_json()))
            .collect();
        self.trace.events.push(Event {
            info: Some(info),
            ..event
        });
        let frame = self.env.render()?.into_frame();
        self.frame =
            frame.ok_or_else(|| Error::Contract("`rgb_array` rendered no frame".into()))?;
        self.video
            .as_mut()
            .map_or(Ok(()), |video| video.write(&self.frame))
    }

    /// Whether this episode is the last.
    fn is_last(&self) -> bool {
        self.episodes
            .is_some_and(|episodes| self.episode >= episodes)
    }

    /// The duration of a step in a window.
    #[cfg(feature = "human")]
    fn period(&self, arguments: &Arguments) -> Duration {
        let fps = arguments.fps.unwrap_or(self.env.metadata().render_fps);
        Duration::from_secs(1) / fps.max(1)
    }

    fn status(&self) -> String {
        format!(
            "{}  episode {}  step {}  score {:.2}",
            self.trace.id, self.episode, self.steps, self.score
        )
    }

    /// Completes the recordings.
    fn finish(self, arguments: &Arguments) -> Result<()> {
        let recorded = match (self.video, &arguments.record) {
            (Some(video), Some(path)) => video
                .finish()
                .and_then(|()| say(format_args!("{}", path.display()))),
            _ => Ok(()),
        };
        let events = self.trace.events.len();
        let write = |path: &PathBuf| {
            let json = serde_json::to_vec(&self.trace)
                .map_err(|error| Error::custom(error.to_string()))?;
            file::write(path, &json)?;
            say(format_args!("{}: {events} events", path.display()))
        };
        let traced = arguments.trace.as_ref().map_or(Ok(()), write);
        recorded.and(traced)
    }
}

/// Plays line by line. Each line is the name of a key or the start of a name.
fn in_terminal(session: &mut Session, keys: &Keys) -> Result<()> {
    say(format_args!(
        "write a key's name or the start of it and press Enter; or `restart`, or `q` to quit"
    ))?;
    let mut lines = std::io::stdin().lock().lines();
    let mut done = false;
    loop {
        let text = session.env.ansi();
        let text =
            text.ok_or_else(|| Error::custom("it has no text form: play without --terminal"))?;
        output::write(format_args!(
            "\n{}\n{}> ",
            text.trim_end_matches('\n'),
            session.status()
        ))?;
        if done {
            if session.is_last() {
                say(format_args!(""))?;
                return Ok(());
            }
            session.reset(Reset::default())?;
            done = false;
            continue;
        }
        let Some(Ok(line)) = lines.next() else {
            return Ok(());
        };
        let word = line.trim().to_lowercase();
        let starts =
            |name: &&(String, Json)| !word.is_empty() && name.0.to_lowercase().starts_with(&word);
        match word.as_str() {
            "q" | "escape" => return Ok(()),
            "restart" => session.reset(Reset::default())?,
            _ => match keys.actions.iter().find(starts) {
                Some((_, action)) => done = session.step(action)?,
                None => say(format_args!("keys: {}, restart, q", keys::describe(keys)))?,
            },
        }
    }
}

/// Whether a window has a slider for each number of an action.
fn has_sliders(session: &Session) -> bool {
    #[cfg(all(feature = "human", feature = "families"))]
    return sliders::sliders(&session.trace.id, &session.env).is_some();
    #[cfg(not(all(feature = "human", feature = "families")))]
    {
        let _ = session;
        false
    }
}

#[cfg(feature = "human")]
fn in_window(session: &mut Session, keys: &Keys, arguments: &Arguments) -> Result<()> {
    #[cfg(feature = "families")]
    if let Some(sliders) = sliders::sliders(&session.trace.id, &session.env) {
        return sliders::play(session, keys, arguments, sliders);
    }
    say(format_args!("R = restart, Escape = quit"))?;
    window::play(session, keys, arguments)
}

/// Never called: [`play`] refuses to play in a window without the feature `human`.
#[cfg(not(feature = "human"))]
fn in_window(_: &mut Session, _: &Keys, _: &Arguments) -> Result<()> {
    Ok(())
}
