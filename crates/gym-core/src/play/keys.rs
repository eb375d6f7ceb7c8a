//! The keys with which a person plays an environment.

use serde_json::Value as Json;

/// Writes an action in JSON.
pub use serde_json::json;

/// The keys of an environment, for [`Registration::keys`](crate::Registration::keys).
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    /// The name of each key, such as `Left` or `Q`, and its action in JSON. The actions of keys
    /// held together are added if they are vectors; otherwise the first counts.
    pub actions: Vec<(String, Json)>,
    /// The action while no key is down.
    pub idle: Idle,
}

/// The action while no key is down.
#[derive(Clone, Debug, PartialEq)]
pub enum Idle {
    /// Nothing: the environment waits for a key.
    Wait,
    /// The last action again.
    Repeat,
    /// This action.
    Action(Json),
}

impl Keys {
    /// Keys by name, as in `json!({"Left": 0, "Right": 2})`; the environment waits while none is
    /// down.
    pub fn new(actions: Json) -> Self {
        let Json::Object(actions) = actions else {
            return Self {
                actions: Vec::new(),
                idle: Idle::Wait,
            };
        };
        Self {
            actions: actions.into_iter().collect(),
            idle: Idle::Wait,
        }
    }

    /// While no key is down, the last action again.
    #[must_use]
    pub fn repeat(self) -> Self {
        Self {
            idle: Idle::Repeat,
            ..self
        }
    }

    /// While no key is down, this action.
    #[must_use]
    pub fn idle(self, action: Json) -> Self {
        Self {
            idle: Idle::Action(action),
            ..self
        }
    }
}
