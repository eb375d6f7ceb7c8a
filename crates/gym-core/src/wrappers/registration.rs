//! Wrappers by name, for specs and for the book's table.

use crate::env::BoxEnv;
use crate::spec::{Argument, Kwargs, WrapperConfig, WrapperSpec, arguments, nearest};
use crate::value::error::quoted;
use crate::value::{Error, Result};
use crate::vector::VectorEnv;

/// Puts a wrapper around an environment, with the arguments in a spec.
pub type WrapEnv = fn(BoxEnv, &Kwargs) -> Result<BoxEnv>;

/// Puts a wrapper around a vector, with the arguments in a spec.
pub type WrapVector = fn(Box<dyn VectorEnv>, &Kwargs) -> Result<Box<dyn VectorEnv>>;

/// A wrapper that specs can name; [`register_wrapper!`](crate::register_wrapper!) submits it.
#[derive(Clone, Copy, Debug)]
pub struct WrapperRegistration {
    /// The name in [`WrapperSpec`].
    pub name: &'static str,
    /// Its effect, in a few words.
    pub description: &'static str,
    arguments: fn() -> Vec<Argument>,
    env: Option<WrapEnv>,
    vector: Option<WrapVector>,
}

inventory::collect!(WrapperRegistration);

impl WrapperRegistration {
    /// An entry with these arguments and description, without functions yet.
    pub const fn new<C: WrapperConfig>(description: &'static str) -> Self {
        let arguments = || arguments::table(&C::default(), 0);
        Self {
            name: C::NAME,
            description,
            arguments,
            env: None,
            vector: None,
        }
    }

    /// Its arguments, with their defaults.
    pub fn arguments(&self) -> Vec<Argument> {
        (self.arguments)()
    }

    /// Goes around environments.
    #[must_use]
    pub const fn env(self, wrap: WrapEnv) -> Self {
        Self {
            env: Some(wrap),
            ..self
        }
    }

    /// Goes around vectors.
    #[must_use]
    pub const fn vector(self, wrap: WrapVector) -> Self {
        Self {
            vector: Some(wrap),
            ..self
        }
    }

    /// Whether it goes around environments.
    pub const fn wraps_envs(&self) -> bool {
        self.env.is_some()
    }

    /// Whether it goes around vectors.
    pub const fn wraps_vectors(&self) -> bool {
        self.vector.is_some()
    }
}

/// All linked wrappers, by name; of two with one name, the wrapper of environments comes first.
pub fn wrappers() -> Vec<&'static WrapperRegistration> {
    let mut wrappers: Vec<_> = inventory::iter::<WrapperRegistration>.into_iter().collect();
    wrappers.sort_by_key(|wrapper| (wrapper.name, wrapper.env.is_none()));
    wrappers
}

/// Registers a wrapper at link time, so that specs can name it: its name, its description, the type
/// of its [arguments](crate::arguments!), and the functions that put it around an environment, a
/// vector, or either.
///
/// ```
/// use gym_core::wrappers::TimeLimit;
///
/// gym_core::arguments! {
///     /// The arguments.
///     pub struct Config {
///         /// After how many minutes, at 60 steps per second.
///         pub minutes: u32,
///     }
/// }
///
/// gym_core::register_wrapper!(
///     "my_envs/Minutes", "truncates after some minutes", Config,
///     env: |env, config: Config| TimeLimit::new(env, 3600 * config.minutes)
/// );
/// ```
#[macro_export]
macro_rules! register_wrapper {
    ($name:literal, $description:literal, $config:ty $(, env: $env:expr)? $(, vector: $vector:expr)? $(,)?) => {
        impl $crate::registry::WrapperConfig for $config {
            const NAME: &'static str = $name;
        }

        $crate::inventory::submit! {
            $crate::wrappers::WrapperRegistration::new::<$config>($description)
                $(.env(|env, kwargs| {
                    let config = <$config as $crate::registry::WrapperConfig>::from_kwargs(kwargs)?;
                    let wrapped: $crate::Result<_> = ($env)(env, config);
                    Ok($crate::BoxEnv::new(wrapped?))
                }))?
                $(.vector(|envs, kwargs| {
                    let config = <$config as $crate::registry::WrapperConfig>::from_kwargs(kwargs)?;
                    let wrapped: $crate::Result<_> = ($vector)(envs, config);
                    Ok(Box::new(wrapped?))
                }))?
        }
    };
}

impl WrapperSpec {
    /// Puts the wrapper of this name around an environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an unknown name or a bad argument, and the wrapper's own
    /// errors.
    pub fn wrap(&self, env: BoxEnv) -> Result<BoxEnv> {
        self.find("additional_wrappers", |wrapper| wrapper.env)?(env, &self.kwargs)
    }

    /// Puts the wrapper of this name around a vector.
    ///
    /// # Errors
    /// The errors of [`wrap`](Self::wrap).
    pub fn wrap_vector(&self, envs: Box<dyn VectorEnv>) -> Result<Box<dyn VectorEnv>> {
        self.find("a vector's wrappers", |wrapper| wrapper.vector)?(envs, &self.kwargs)
    }

    fn find<T>(&self, of: &str, wrap: fn(&WrapperRegistration) -> Option<T>) -> Result<T> {
        let known: Vec<_> = wrappers()
            .into_iter()
            .filter(|wrapper| wrap(wrapper).is_some())
            .collect();
        let found = known.iter().find(|wrapper| wrapper.name == self.name);
        found.and_then(|wrapper| wrap(wrapper)).ok_or_else(|| {
            let names = known.iter().map(|wrapper| wrapper.name);
            let hint = match nearest(&self.name, names.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known are {}", names.collect::<Vec<_>>().join(", ")),
            };
            Error::argument(
                of,
                format!("unknown wrapper `{}`: {hint}", quoted(&self.name)),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_wrapper_is_told_the_nearest_and_not_all() {
        let told = |name: &str| {
            let found = WrapperSpec::new(name).find("the wrappers", |_| Some(()));
            found.expect_err("no wrapper").to_string()
        };
        let near = told("TimeLimt");
        assert!(
            near.ends_with("unknown wrapper `TimeLimt`: did you mean `TimeLimit`?"),
            "{near}"
        );
        let far = told("Nope");
        assert!(
            far.contains(": known are ") && far.contains("TimeLimit"),
            "{far}"
        );
    }
}
