//! The spec of a wrapper as data: its name and arguments.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::spec::{Argument, Arguments, Kwargs, arguments};
use crate::value::{Error, Result};

/// A wrapper by name, with its arguments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WrapperSpec {
    /// Gymnasium's name of the wrapper.
    pub name: String,
    /// Arguments of its constructor.
    #[serde(default, deserialize_with = "gym_numerics::unique::object")]
    pub kwargs: Kwargs,
}

impl WrapperSpec {
    /// A wrapper without arguments.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            kwargs: Kwargs::new(),
        }
    }

    /// Adds an argument.
    #[must_use]
    pub fn arg(mut self, name: &str, value: impl Into<Json>) -> Self {
        self.kwargs.insert(name.to_owned(), value.into());
        self
    }
}

/// The arguments of a wrapper, named by [`register_wrapper!`](crate::register_wrapper!).
pub trait WrapperConfig: Arguments {
    /// The wrapper's name in [`WrapperSpec`].
    const NAME: &'static str;

    /// The wrapper with these arguments, as a spec holds it.
    fn spec(&self) -> WrapperSpec {
        let kwargs = match serde_json::to_value(self) {
            Ok(Json::Object(kwargs)) => kwargs,
            _ => Kwargs::new(),
        };
        WrapperSpec {
            name: Self::NAME.to_owned(),
            kwargs,
        }
    }

    /// The arguments that a spec holds.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument that is missing, unknown, or of another type.
    fn from_kwargs(kwargs: &Kwargs) -> Result<Self> {
        let missing = Self::table()
            .into_iter()
            .find(|row| row.required && !kwargs.contains_key(row.name));
        match missing {
            Some(Argument { name, kind, .. }) => {
                Err(Self::refuse(format!("it needs `{name}`: {kind}")))
            }
            None => arguments::read(&Self::default(), 0, kwargs, Self::NAME),
        }
    }

    /// The error of an argument that the wrapper refuses.
    fn refuse(reason: impl Into<String>) -> Error {
        Error::argument(Self::NAME, reason)
    }
}
