//! Wrappers: each changes one thing and forwards the rest.
//!
//! A wrapper takes any [`Env`](crate::Env), typed or erased, and is an `Env` again.

pub mod order_enforcing;
pub mod passive_env_checker;
mod registration;
mod render;
pub mod render_collection;
pub mod time_limit;

pub use order_enforcing::OrderEnforcing;
pub use passive_env_checker::PassiveEnvChecker;
pub use registration::{WrapEnv, WrapVector, WrapperRegistration, wrappers};
pub use render::Render;
pub use render_collection::RenderCollection;
pub use time_limit::{StepCount, TimeLimit};

/// The accessors of a wrapper whose inner environment or vector is its field `inner`: `inner!(E)`
/// for a [`Wrapper`](crate::Wrapper), `inner!(dyn)` for a [`VectorWrapper`](crate::VectorWrapper),
/// `inner!(impl Name<E>)` for inherent methods of the type.
#[doc(hidden)]
#[macro_export]
macro_rules! inner {
    (dyn) => {
        fn inner(&self) -> &dyn $crate::VectorEnv {
            &self.inner
        }

        fn inner_mut(&mut self) -> &mut dyn $crate::VectorEnv {
            &mut self.inner
        }
    };
    (impl $name:ident<$inner:ident $(: $bound:path)? $(, $parameter:ident $(: $limit:path)?)*>) => {
        impl<$inner $(: $bound)? $(, $parameter $(: $limit)?)*> $name<$inner $(, $parameter)*> {
            /// The inner environment or vector.
            pub fn get_ref(&self) -> &$inner {
                &self.inner
            }

            /// The inner environment or vector, mutable. The wrapper does not see resets and steps
            /// made through it.
            pub fn get_mut(&mut self) -> &mut $inner {
                &mut self.inner
            }

            /// The inner environment or vector, without the wrapper.
            pub fn into_inner(self) -> $inner {
                self.inner
            }
        }
    };
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
