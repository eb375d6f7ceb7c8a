//! The keys of a game's actions: arrow keys and the space bar.

use gym_core::{BoxEnv, EnvExt, Keys};
use serde_json::json;

use super::AtariEnv;
use crate::action::Action;

const KEYS: [(&str, Action); 5] = [
    ("Space", Action::Fire),
    ("Up", Action::Up),
    ("Right", Action::Right),
    ("Left", Action::Left),
    ("Down", Action::Down),
];

pub(crate) fn keys(env: &BoxEnv) -> Keys {
    let env = env
        .layer::<AtariEnv>()
        .filter(|env| !env.config().continuous);
    let actions = env.map_or(&[][..], AtariEnv::actions);
    let number = |action| actions.iter().position(|other| *other == action);
    let keys = KEYS
        .iter()
        .filter_map(|(key, action)| Some(((*key).to_owned(), json!(number(*action)?))));
    Keys::new(keys.collect()).idle(json!(0))
}
