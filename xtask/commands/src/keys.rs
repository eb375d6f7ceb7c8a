//! Which key is which action.

use gym::{Error, Result, Space};
use serde_json::{Value as Json, json};

/// The keys of an environment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Keys {
    pub(crate) actions: Vec<(String, Json)>,
    pub(crate) idle: Idle,
}

/// What happens while no key is down.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Idle {
    /// Nothing: the environment waits for a key.
    Wait,
    /// The last action again.
    Repeat,
    /// This action.
    Action(Json),
}

impl Keys {
    /// The keys of an environment that is known by name; otherwise the digits, for actions that are
    /// numbers.
    pub(crate) fn of(id: &str, space: &Space) -> Self {
        // the same task has the same keys on another engine, `rapier/`
        let name = id.rsplit('/').next().unwrap_or(id);
        let (name, _) = name.rsplit_once("-v").unwrap_or((name, ""));
        let discrete = matches!(space, Space::Discrete(_));
        let (actions, idle) = match name {
            // ale-py's actions: what a key does depends on which of them the game has
            _ if id.starts_with("ALE/") && discrete => (atari(id), Idle::Action(json!(0))),
            "CartPole" => (json!({"Left": 0, "Right": 1}), Idle::Repeat),
            "MountainCar" | "Acrobot" => (json!({"Left": 0, "Right": 2}), Idle::Action(json!(1))),
            "MountainCarContinuous" => (json!({"Left": [-1], "Right": [1]}), Idle::Action(json!([0]))),
            // a positive torque turns to the left
            "Pendulum" => (json!({"Left": [2], "Right": [-2]}), Idle::Action(json!([0]))),
            "LunarLander" if discrete => (json!({"Left": 1, "Up": 2, "Right": 3}), Idle::Action(json!(0))),
            "LunarLander" | "LunarLanderContinuous" => {
                (json!({"Up": [1, 0], "Left": [0, -1], "Right": [0, 1]}), Idle::Action(json!([0, 0])))
            }
            // hip and knee of one leg, then of the other
            "BipedalWalker" | "BipedalWalkerHardcore" => (
                json!({
                    "Q": [1, 0, 0, 0], "A": [-1, 0, 0, 0], "W": [0, 1, 0, 0], "S": [0, -1, 0, 0],
                    "O": [0, 0, 1, 0], "L": [0, 0, -1, 0], "I": [0, 0, 0, 1], "K": [0, 0, 0, -1],
                }),
                Idle::Action(json!([0, 0, 0, 0])),
            ),
            "CarRacing" if discrete => {
                (json!({"Right": 1, "Left": 2, "Up": 3, "Down": 4}), Idle::Action(json!(0)))
            }
            "CarRacing" => (
                json!({"Left": [-1, 0, 0], "Right": [1, 0, 0], "Up": [0, 1, 0], "Down": [0, 0, 0.8]}),
                Idle::Action(json!([0, 0, 0])),
            ),
            "FrozenLake" | "FrozenLake8x8" => {
                (json!({"Left": 0, "Down": 1, "Right": 2, "Up": 3}), Idle::Wait)
            }
            "CliffWalking" | "CliffWalkingSlippery" => {
                (json!({"Up": 0, "Right": 1, "Down": 2, "Left": 3}), Idle::Wait)
            }
            "Taxi" => (
                json!({"Down": 0, "Up": 1, "Right": 2, "Left": 3, "P": 4, "Space": 4, "D": 5, "Enter": 5}),
                Idle::Wait,
            ),
            "Blackjack" => (json!({"S": 0, "Down": 0, "H": 1, "Up": 1}), Idle::Wait),
            _ => (digits(space), Idle::Wait),
        };
        let Json::Object(actions) = actions else { return Self { actions: Vec::new(), idle } };
        Self { actions: actions.into_iter().collect(), idle }
    }

    /// Gives a key another action.
    pub(crate) fn set(&mut self, key: &str, action: Json) {
        self.actions.retain(|(name, _)| !name.eq_ignore_ascii_case(key));
        self.actions.push((key.to_owned(), action));
    }

    /// Whether every action is one of the space.
    pub(crate) fn check(&self, space: &Space) -> Result<()> {
        if self.actions.is_empty() {
            return Err(Error::argument(
                "play",
                format!("no keys are known for {space}: add `--key NAME=ACTION`"),
            ));
        }
        let idle = match &self.idle {
            Idle::Action(action) => Some(action),
            Idle::Wait | Idle::Repeat => None,
        };
        self.actions.iter().map(|(_, action)| action).chain(idle).try_for_each(|action| {
            let action = space.from_json(action)?;
            if space.contains(&action) {
                return Ok(());
            }
            Err(Error::argument("play", format!("a key has the action {action}, which is not in {space}")))
        })
    }

    /// The action of the keys that are down, if one of them has an action. Those of several keys are
    /// added if they are vectors; otherwise the first counts.
    #[cfg_attr(not(any(feature = "human", test)), expect(dead_code, reason = "for windows"))]
    pub(crate) fn action(&self, down: &[String]) -> Option<Json> {
        let is_down = |name: &str| down.iter().any(|key| key.eq_ignore_ascii_case(name));
        let mut actions = self.actions.iter().filter(|(name, _)| is_down(name)).map(|(_, action)| action);
        let first = actions.next()?.clone();
        Some(actions.fold(first, |sum, action| add(&sum, action).unwrap_or(sum)))
    }

    /// The keys and their actions, for people.
    pub(crate) fn describe(&self) -> String {
        let keys: Vec<_> = self.actions.iter().map(|(name, action)| format!("{name} = {action}")).collect();
        keys.join(", ")
    }
}

/// Arrow keys and the space bar, for those actions that a game of the Atari 2600 has.
#[cfg(feature = "families")]
fn atari(id: &str) -> Json {
    use gym::atari::{Action, games};

    let title = id.trim_start_matches("ALE/").rsplit_once("-v").map_or(id, |(title, _)| title);
    let Some(game) = games::GAMES.iter().find(|game| game.title == title) else { return json!({}) };
    let keys = [
        ("Space", Action::Fire),
        ("Up", Action::Up),
        ("Right", Action::Right),
        ("Left", Action::Left),
        ("Down", Action::Down),
    ];
    let has = |action| game.minimal.iter().position(|other| *other == action);
    keys.iter().filter_map(|(key, action)| Some(((*key).to_owned(), json!(has(*action)?)))).collect()
}

#[cfg(not(feature = "families"))]
fn atari(_: &str) -> Json {
    json!({})
}

/// `Key0` to `Key9` for the first actions of a discrete space.
fn digits(space: &Space) -> Json {
    let Space::Discrete(space) = space else { return json!({}) };
    (0..space.n().min(10)).map(|i| (format!("Key{i}"), json!(space.start() + i))).collect()
}

/// The sum of two vectors of one length.
fn add(a: &Json, b: &Json) -> Option<Json> {
    let (a, b) = (a.as_array()?, b.as_array()?);
    if a.len() != b.len() {
        return None;
    }
    let sum = a.iter().zip(b).map(|(a, b)| Some(json!(a.as_f64()? + b.as_f64()?)));
    sum.collect::<Option<Vec<_>>>().map(Json::Array)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_linked_environment_has_keys_that_fit() {
        // MuJoCo's bodies have more joints than there are keys to know
        let is_played = |entry: &&gym::Registration| entry.crate_name() != "gym-mujoco";
        for registration in gym::registry::self_contained().iter().filter(is_played) {
            let space = gym::Env::action_space(&gym::make(registration.id()).unwrap());
            Keys::of(registration.id(), &space).check(&space).unwrap();
        }
    }

    #[test]
    fn keys_choose_actions() {
        let down = |keys: &[&str]| keys.iter().map(|&key| key.to_owned()).collect::<Vec<_>>();
        let racing = Keys::of("CarRacing-v3", &Space::boxed([-1.0; 3], [1.0; 3]));
        assert_eq!(racing.action(&down(&["Left", "Up", "Q"])), Some(json!([-1.0, 1.0, 0.0])));
        assert_eq!(racing.action(&down(&["Q"])), None);
        let mut lake = Keys::of("FrozenLake-v1", &Space::discrete(4));
        assert_eq!(lake.action(&down(&["Right"])), Some(json!(2)));
        lake.set("right", json!(9));
        assert_eq!(lake.action(&down(&["Right"])), Some(json!(9)));
        assert!(lake.check(&Space::discrete(4)).is_err());
        assert_eq!(Keys::of("Other-v0", &Space::discrete(3)).action(&down(&["Key2"])), Some(json!(2)));
    }
}
