//! What can be wrong with a model.

/// A `Result` whose error is [`enum@Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What is wrong with a model, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A compiled model whose parts do not fit together, or which is outside of what the engine supports.
    #[error("the compiled model is not valid: {0}")]
    Model(String),
    /// The state of another model.
    #[error("the data does not fit the model: {0}")]
    Data(String),
}
