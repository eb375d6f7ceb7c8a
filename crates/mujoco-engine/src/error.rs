//! Errors of models and states.

use gym_numerics::text::{brief, shortened};

/// A `Result` whose error is [`enum@Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An error of a model, with its place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A compiled model whose fields are inconsistent, or with an unsupported feature.
    #[error("the compiled model is not valid: {}", brief(.0))]
    Model(String),
    /// A text that is not a model, or that uses an unsupported part of MJCF.
    #[error(
        "line {line}: <{}>{}: {}",
        shortened(element),
        attribute.as_ref().map_or_else(String::new, |name| format!(" attribute {:?}", shortened(name))),
        brief(reason)
    )]
    Mjcf {
        /// The line of the text, from 1.
        line: u32,
        /// The element.
        element: String,
        /// The attribute, if one is at fault.
        attribute: Option<String>,
        /// The reason, and the supported values.
        reason: String,
    },
    /// A file that cannot be read.
    #[error("{}: {}", brief(path), brief(reason))]
    File {
        /// The file.
        path: String,
        /// The error of the system, or of the XML parser.
        reason: String,
    },
    /// The data of another model.
    #[error("the data does not fit the model: {}", brief(.0))]
    Data(String),
}

/// Returns an error with this text unless the condition holds.
macro_rules! ensure {
    ($condition:expr, $($text:tt)+) => {
        if !$condition {
            return Err($crate::Error::Model(format!($($text)+)));
        }
    };
}
pub(crate) use ensure;
