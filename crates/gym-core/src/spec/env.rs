//! The spec of an environment as data: its id, arguments and wrappers.

use serde::{Deserialize, Serialize};

use crate::drawing::render::RenderMode;
use crate::spec::{Kwargs, WrapperSpec};

/// Everything needed to rebuild an environment with its wrappers. JSON uses Gymnasium's names;
/// reading ignores Gymnasium's other fields (`entry_point`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnvSpec {
    /// The id, with its version.
    pub id: String,
    /// The mean return at which the task counts as solved.
    #[serde(default)]
    pub reward_threshold: Option<f64>,
    /// Whether the same seed can give different episodes.
    #[serde(default)]
    pub nondeterministic: bool,
    /// The steps after which an episode is truncated; `None` for no limit.
    #[serde(default)]
    pub max_episode_steps: Option<u32>,
    /// Whether [`OrderEnforcing`](crate::wrappers::OrderEnforcing) is part of the stack.
    #[serde(default = "yes")]
    pub order_enforce: bool,
    /// Whether [`PassiveEnvChecker`](crate::wrappers::PassiveEnvChecker) is left out.
    #[serde(default)]
    pub disable_env_checker: bool,
    /// Arguments of the constructor.
    #[serde(default, deserialize_with = "gym_numerics::unique::object")]
    pub kwargs: Kwargs,
    /// The render mode, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub render_mode: Option<RenderMode>,
    /// Width and height of rendered frames, if not the environment's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub render_size: Option<(u32, u32)>,
    /// Wrappers around the default stack, innermost first.
    #[serde(default)]
    pub additional_wrappers: Vec<WrapperSpec>,
}

fn yes() -> bool {
    true
}

impl EnvSpec {
    /// The steps after which the outermost time limit truncates an episode.
    pub fn time_limit(&self) -> Option<u32> {
        let outermost = self
            .additional_wrappers
            .iter()
            .rev()
            .find(|wrapper| wrapper.name == "TimeLimit");
        let limit = outermost.and_then(|wrapper| wrapper.kwargs.get("max_episode_steps")?.as_u64());
        limit
            .and_then(|limit| u32::try_from(limit).ok())
            .or(self.max_episode_steps)
    }

    /// The spec of this environment in one more wrapper.
    #[must_use]
    pub fn wrapped(mut self, wrapper: WrapperSpec) -> Self {
        // with a list mode, `make` adds a `RenderCollection` outside all other wrappers, and the
        // new wrapper is further outside
        if let Some(mode) = self.render_mode.filter(|mode| mode.is_list()) {
            self.render_mode = Some(mode.single());
            self.additional_wrappers
                .push(WrapperSpec::new("RenderCollection"));
        }
        self.additional_wrappers.push(wrapper);
        self
    }
}
