//! The requests of the page.

use std::collections::BTreeMap;

use gym::trace::Trace;
use gym::{Error, Kwargs, Result, Seed, registry};
use serde::Deserialize;
use serde_json::{Value as Json, json};

use crate::describe;
use crate::learn::{Learner, Lesson};
use crate::player::{By, Player};
#[cfg(feature = "robot")]
use crate::robot::{self, Robot};

/// The open environments and learners, each under a number that the page chooses.
#[derive(Default)]
pub struct Session {
    players: BTreeMap<u32, Player>,
    learners: BTreeMap<u32, Learner>,
    #[cfg(feature = "robot")]
    robot: Robot,
}

/// A request. `env` is the number of an open environment, `learner` the number of an open learner.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
enum Request {
    /// Lists all environments, in the order of the gallery.
    List,
    /// Lists the arguments of an environment.
    Arguments { id: String },
    /// Opens an environment. Its pictures fit into a square of `fit` pixels.
    Make {
        env: u32,
        id: String,
        kwargs: Kwargs,
        fit: Option<u32>,
    },
    /// Closes an environment.
    Close { env: u32 },
    /// Starts an episode from a seed, given in any number of decimal digits.
    Reset { env: u32, seed: String },
    /// Takes `count` steps, fewer if the episode ends.
    Step {
        env: u32,
        by: Who,
        action: Option<Json>,
        learner: Option<u32>,
        count: u32,
    },
    /// Takes these actions in order, until the episode ends.
    Act { env: u32, actions: Vec<Json> },
    /// Goes to the state after `step` steps of the episode.
    Seek { env: u32, step: usize },
    /// Turns the camera: degrees of azimuth and elevation, and the factor of the distance.
    Turn { env: u32, by: [f64; 3] },
    /// Draws the state, attached as RGBA.
    Frame { env: u32 },
    /// Attaches the observation as RGBA, if it is a picture.
    Sight { env: u32 },
    /// Lists the actions of the episode.
    Actions { env: u32 },
    /// Attaches the episode as a trace. The trace is text, because JavaScript would change digits
    /// of the numbers.
    Trace { env: u32 },
    /// Attaches the episode as a GIF.
    Gif { env: u32, frames: usize },
    /// Compares a recorded trace, whose text is attached, with the environment.
    Replay,
    /// Stores an Atari ROM, whose bytes are attached.
    Rom,
    /// Opens a learner.
    Learn {
        learner: u32,
        id: String,
        kwargs: Kwargs,
        seed: u64,
        lesson: Lesson,
    },
    /// Changes the parameters of a learner.
    Tune { learner: u32, lesson: Lesson },
    /// Trains for `episodes` episodes or `steps` steps, whichever ends first.
    Train {
        learner: u32,
        episodes: u32,
        steps: u32,
    },
    /// Attaches the learned numbers as `f64`.
    Learned { learner: u32 },
    /// Asks about the reader's own robot.
    #[cfg(feature = "robot")]
    Robot { ask: robot::Request },
}

/// The source of actions.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Who {
    Random,
    Good,
    Action,
    Learner,
}

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "Session({} environments, {} learners)",
            self.players.len(),
            self.learners.len()
        )
    }
}

impl Session {
    /// Answers a request in JSON: `{"ok": answer}` or `{"error": text}`. Bytes go to `attachment`.
    pub fn call(&mut self, request: &[u8], bytes: &[u8], attachment: &mut Vec<u8>) -> Vec<u8> {
        let answer = serde_json::from_slice(request)
            .map_err(|error| Error::custom(format!("not a request: {error}")))
            .and_then(|request| self.answer(request, bytes, attachment));
        let answer = match answer {
            Ok(answer) => json!({"ok": answer}),
            Err(error) => json!({"error": error.to_string()}),
        };
        answer.to_string().into_bytes()
    }

    fn player(&mut self, env: u32) -> Result<&mut Player> {
        self.players
            .get_mut(&env)
            .ok_or_else(|| Error::custom(format!("environment {env} is not open")))
    }

    fn learner(&mut self, learner: u32) -> Result<&mut Learner> {
        self.learners
            .get_mut(&learner)
            .ok_or_else(|| Error::custom(format!("learner {learner} is not open")))
    }

    fn answer(&mut self, request: Request, bytes: &[u8], attachment: &mut Vec<u8>) -> Result<Json> {
        Ok(match request {
            Request::List => describe::list(),
            Request::Arguments { id } => describe::arguments(&registry::find(&id)?)?,
            Request::Make {
                env,
                id,
                kwargs,
                fit,
            } => {
                let player = Player::new(&id, &kwargs, fit)?;
                let description = player.describe();
                self.players.insert(env, player);
                description
            }
            Request::Close { env } => json!(self.players.remove(&env).is_some()),
            Request::Reset { env, seed } => {
                let player = self.player(env)?;
                player.reset(seed.parse::<Seed>()?)?;
                player.state()
            }
            Request::Step {
                env,
                by,
                action,
                learner,
                count,
            } => {
                for _ in 0..count {
                    let learner = learner.and_then(|learner| self.learners.get(&learner));
                    let player = self.players.get_mut(&env);
                    let player = player
                        .ok_or_else(|| Error::custom(format!("environment {env} is not open")))?;
                    let by = match (&by, &action, learner) {
                        (Who::Random, _, _) => By::Random,
                        (Who::Good, _, _) => By::Good,
                        (Who::Action, Some(action), _) => By::Action(player.action(action)?),
                        (Who::Learner, _, Some(learner)) => {
                            By::Action(learner.act(player.observation())?)
                        }
                        _ => return Err(Error::custom("a step needs an action or a learner")),
                    };
                    player.step(by)?;
                    if player.done() {
                        break;
                    }
                }
                self.player(env)?.state()
            }
            Request::Act { env, actions } => {
                let player = self.player(env)?;
                for action in &actions {
                    if player.done() {
                        break;
                    }
                    player.step(By::Action(player.action(action)?))?;
                }
                player.state()
            }
            Request::Seek { env, step } => {
                let player = self.player(env)?;
                player.seek(step)?;
                player.state()
            }
            Request::Turn { env, by } => {
                self.player(env)?.turn(by);
                Json::Null
            }
            Request::Frame { env } => self.player(env)?.frame(attachment)?,
            Request::Sight { env } => self.player(env)?.sight(attachment),
            Request::Actions { env } => self.player(env)?.actions()?,
            Request::Trace { env } => {
                let trace = self.player(env)?.trace()?;
                *attachment =
                    serde_json::to_vec(&trace).map_err(|error| Error::custom(error.to_string()))?;
                Json::Null
            }
            Request::Gif { env, frames } => {
                *attachment = self.player(env)?.gif(frames)?;
                Json::Null
            }
            Request::Replay => {
                let trace: Trace = serde_json::from_slice(bytes)
                    .map_err(|error| Error::custom(format!("not a trace: {error}")))?;
                let answers = trace.replay()?;
                json!({"events": trace.events.len(), "difference": trace.first_difference(&answers)})
            }
            Request::Rom => provide(bytes)?,
            Request::Learn {
                learner,
                id,
                kwargs,
                seed,
                lesson,
            } => {
                let opened = Learner::new(&id, kwargs, seed, lesson)?;
                let description = opened.describe();
                self.learners.insert(learner, opened);
                description
            }
            Request::Tune { learner, lesson } => {
                self.learner(learner)?.tune(lesson)?;
                Json::Null
            }
            Request::Train {
                learner,
                episodes,
                steps,
            } => {
                json!(self.learner(learner)?.train(episodes, steps)?)
            }
            Request::Learned { learner } => {
                let learner = self.learner(learner)?;
                attachment.extend(
                    learner
                        .learned()
                        .iter()
                        .flat_map(|number| number.to_le_bytes()),
                );
                learner.describe()
            }
            #[cfg(feature = "robot")]
            Request::Robot { ask } => self.robot.answer(ask, bytes, attachment)?,
        })
    }
}

/// Stores a ROM. Returns the name of its game.
#[cfg(feature = "families")]
fn provide(bytes: &[u8]) -> Result<Json> {
    let rom = gym::atari::rom::Rom::from_bytes(bytes)?;
    let title = rom.game().title;
    gym::atari::rom::provide(rom);
    Ok(json!(title))
}

#[cfg(not(feature = "families"))]
fn provide(_: &[u8]) -> Result<Json> {
    Err(Error::custom("this gallery has no Atari"))
}
