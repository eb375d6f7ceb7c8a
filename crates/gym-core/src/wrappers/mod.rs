//! Environments around environments: each changes one thing and forwards the rest.
//!
//! A wrapper takes any [`Env`](crate::Env), typed or erased, and is an `Env` again.

mod order_enforcing;
mod passive_env_checker;
mod record_episode_statistics;
mod render;
mod render_collection;
mod time_limit;

pub use order_enforcing::OrderEnforcing;
pub use passive_env_checker::PassiveEnvChecker;
pub use record_episode_statistics::RecordEpisodeStatistics;
pub use render::Render;
pub use render_collection::RenderCollection;
pub use time_limit::TimeLimit;

/// Implements methods of [`Env`](crate::Env) by calling the same method of a field.
///
/// ```text
/// gym_core::forward!(env: observation_space, action_space, info, metadata, draw, ansi, render, base, close);
/// ```
#[macro_export]
macro_rules! forward {
    ($field:tt: $($method:ident),+ $(,)?) => { $($crate::forward!(@ $field $method);)+ };
    (@ $field:tt observation_space) => {
        fn observation_space(&self) -> $crate::Space { self.$field.observation_space() }
    };
    (@ $field:tt action_space) => {
        fn action_space(&self) -> $crate::Space { self.$field.action_space() }
    };
    (@ $field:tt snapshot) => {
        fn snapshot(&self) -> $crate::Result<$crate::Snapshot> { self.$field.snapshot() }
    };
    (@ $field:tt restore) => {
        fn restore(&mut self, snapshot: &$crate::Snapshot) -> $crate::Result<()> {
            self.$field.restore(snapshot)
        }
    };
    (@ $field:tt info) => {
        fn info(&self, visit: &mut dyn FnMut(&str, $crate::Value)) { self.$field.info(visit); }
    };
    (@ $field:tt metadata) => {
        fn metadata(&self) -> $crate::render::Metadata { self.$field.metadata() }
    };
    (@ $field:tt draw) => {
        fn draw(&self, canvas: &mut dyn $crate::canvas::Canvas) { self.$field.draw(canvas); }
    };
    (@ $field:tt ansi) => {
        fn ansi(&self) -> Option<String> { self.$field.ansi() }
    };
    (@ $field:tt render) => {
        fn render(&mut self) -> $crate::Result<$crate::render::Rendered> { self.$field.render() }
    };
    (@ $field:tt spec) => {
        fn spec(&self) -> Option<$crate::EnvSpec> { self.$field.spec() }
    };
    (@ $field:tt base) => {
        fn base(&self) -> &dyn ::std::any::Any { self.$field.base() }
    };
    (@ $field:tt close) => {
        fn close(&mut self) { self.$field.close(); }
    };
    (@ $field:tt describe) => {
        fn describe(&self) -> String { $crate::wrappers::describe(self, &self.$field) }
    };
}

/// `<Wrapper<inner>>`, as Gymnasium prints a stack.
#[doc(hidden)]
pub fn describe<W, E: crate::Env>(_wrapper: &W, inner: &E) -> String {
    let inner = inner.describe();
    let inner = inner.strip_prefix('<').and_then(|s| s.strip_suffix('>')).unwrap_or(&inner);
    format!("<{}<{inner}>>", crate::env::short_type_name::<W>())
}
