//! Wrappers: each changes one thing and forwards the rest.
//!
//! A wrapper takes any [`Env`](crate::Env), typed or erased, and is an `Env` again.

mod clock;
pub mod order_enforcing;
pub mod passive_env_checker;
pub mod record_episode_statistics;
mod registration;
mod render;
pub mod render_collection;
pub mod time_limit;

pub use order_enforcing::OrderEnforcing;
pub use passive_env_checker::PassiveEnvChecker;
pub use record_episode_statistics::{EpisodeStatistics, RecordEpisodeStatistics};
pub use registration::{WrapEnv, WrapVector, WrapperRegistration, wrappers};
pub use render::Render;
pub use render_collection::RenderCollection;
pub use time_limit::{StepCount, TimeLimit};

/// The accessors of a [`Wrapper`](crate::Wrapper) whose inner environment is its field `inner`, of
/// type `$inner`.
macro_rules! within {
    ($inner:ident) => {
        type Inner = $inner;

        fn inner(&self) -> &$inner {
            &self.inner
        }

        fn inner_mut(&mut self) -> &mut $inner {
            &mut self.inner
        }
    };
}
use within;

/// `get_ref`, `get_mut` and `into_inner` of a wrapper with a field `inner`.
macro_rules! reach {
    ($name:ident<$env:ident $(: $bound:path)? $(, $parameter:ident)*>) => {
        impl<$env $(: $bound)? $(, $parameter)*> $name<$env $(, $parameter)*> {
            /// The inner environment.
            pub fn get_ref(&self) -> &$env {
                &self.inner
            }

            /// The inner environment, mutable. The wrapper's own state does not follow changes.
            pub fn get_mut(&mut self) -> &mut $env {
                &mut self.inner
            }

            /// The inner environment, without the wrapper.
            pub fn into_inner(self) -> $env {
                self.inner
            }
        }
    };
}
use reach;
