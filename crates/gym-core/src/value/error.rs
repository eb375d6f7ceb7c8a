//! The one error type. Each message names the fault and the remedy.

use std::borrow::Cow;
use std::fmt;
use std::io::ErrorKind;
use std::sync::Arc;

use gym_numerics::SeedError;
use gym_numerics::text::brief;
pub use gym_numerics::text::printable;
pub(crate) use gym_numerics::text::shortened;
use thiserror::Error as ThisError;

/// A `Result` whose error is [`enum@Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Everything that can go wrong in an environment, a space, a wrapper or the registry.
///
/// The variants follow Gymnasium's `gymnasium.error`.
#[derive(Clone, ThisError)]
#[non_exhaustive]
pub enum Error {
    /// The id does not follow the grammar `[namespace/]name[-vN]`.
    #[error(
        "malformed environment id `{}`: ids have the form [namespace/]name[-vN], as in `CartPole-v1`",
        quoted(.0)
    )]
    MalformedId(String),

    /// No environment of that namespace is linked.
    #[error("namespace `{}` not found{hint}", quoted(namespace))]
    NamespaceNotFound {
        /// The requested namespace.
        namespace: String,
        /// A near name, or how to link the crate.
        hint: String,
    },

    /// No environment of that name is linked.
    #[error("unknown environment `{}`{hint}", quoted(id))]
    NameNotFound {
        /// The requested id.
        id: String,
        /// A near name, and how to link the crate.
        hint: String,
    },

    /// The name exists, but not in that version.
    #[error("{}", version_not_found(name, *version, available))]
    VersionNotFound {
        /// Namespace and name, without version.
        name: String,
        /// The requested version; `None` for an id without one.
        version: Option<u32>,
        /// The ids that exist.
        available: String,
    },

    /// The requested version was superseded and is no longer provided.
    #[error("version {version} of `{name}` is no longer provided: use `{latest}`")]
    DeprecatedVersion {
        /// Namespace and name, without version.
        name: String,
        /// The requested version.
        version: u32,
        /// The id to use instead.
        latest: String,
    },

    /// Two crates register the same id.
    #[error(
        "environment `{id}` is registered more than once ({crates}): link one of the crates, or give one id a namespace"
    )]
    Duplicate {
        /// The id.
        id: String,
        /// The crates that register it.
        crates: String,
    },

    /// A runtime registration that the registry refuses.
    #[error("cannot register `{}`: {reason}", quoted(id))]
    Registration {
        /// The id.
        id: String,
        /// The reason.
        reason: String,
    },

    /// A constructor argument or reset option that does not exist or has a bad value.
    #[error("invalid argument for {}: {}", brief(target), told(reason))]
    InvalidArgument {
        /// The thing being built or reset.
        target: String,
        /// The fault, and the valid values.
        reason: String,
    },

    /// A space cannot be built from these parts.
    #[error("invalid space: {}", told(.0))]
    InvalidSpace(String),

    /// A value does not belong to a space.
    #[error(
        "{reason}: {} is not an element of {}",
        shortened(value),
        shortened(space)
    )]
    NotInSpace {
        /// The value, printed.
        value: String,
        /// The space, printed.
        space: String,
        /// The fault, and the remedy.
        reason: String,
    },

    /// An action that the environment cannot execute.
    #[error("{}", invalid_action(action, space, hint))]
    InvalidAction {
        /// The action, printed.
        action: String,
        /// The action space, printed.
        space: String,
        /// The fault and its place in the action; empty if unknown.
        hint: String,
    },

    /// `step`, `render` or similar before the first `reset`.
    #[error("cannot call `{0}` before `reset`: call `env.reset(seed)` first")]
    ResetNeeded(&'static str),

    /// Use of an environment after `close`.
    #[error("cannot call `{0}` on a closed environment: make a new one")]
    Closed(&'static str),

    /// A seed that is not a whole number of zero or more.
    #[error("invalid seed `{}`: a seed is a whole number, zero or greater", quoted(.0))]
    InvalidSeed(String),

    /// A render mode that the environment does not have, or was not made with.
    #[error("{target} cannot render as {mode}: {reason}")]
    UnsupportedMode {
        /// The environment.
        target: String,
        /// The requested mode.
        mode: String,
        /// The remedy.
        reason: String,
    },

    /// A snapshot that does not fit the environment it is restored into.
    #[error("cannot restore this snapshot: {}", told(.0))]
    Snapshot(String),

    /// The environment breaks the rules of its own interface.
    #[error("the environment breaks its contract: {0}")]
    Contract(String),

    /// One environment of a vector failed.
    #[error("sub-environment {index}: {source}")]
    SubEnvironment {
        /// Its index.
        index: usize,
        /// Its error.
        source: Box<Error>,
    },

    /// Reading or writing a file failed.
    #[error("{path}: {source}{}", advice(source))]
    Io {
        /// The file.
        path: String,
        /// The operating system's error.
        source: Arc<std::io::Error>,
    },

    /// Any error of another crate's environment.
    #[error("{0}")]
    Custom(String),
}

impl Error {
    /// An error with its message.
    pub fn custom(message: impl Into<String>) -> Self {
        Self::Custom(message.into())
    }

    /// [`Error::InvalidArgument`] from its two parts.
    pub fn argument(target: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::InvalidArgument {
            target: target.into(),
            reason: reason.into(),
        }
    }

    /// [`Error::SubEnvironment`] of an environment's own error.
    pub fn at_env(self, index: usize) -> Self {
        Self::SubEnvironment {
            index,
            source: Box::new(self),
        }
    }

    /// [`Error::Io`] of a file.
    pub fn io(path: &std::path::Path, source: std::io::Error) -> Self {
        Self::Io {
            path: path.display().to_string(),
            source: Arc::new(source),
        }
    }
}

/// Prints the message, so that `fn main() -> gym::Result<()>` does.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Types of Rust in messages of serde, and words for them.
const TYPES: [(&[&str], &str); 4] = [
    (
        &["usize", "u64", "u32", "u16", "u8"],
        "expected a whole number, zero or greater",
    ),
    (
        &["isize", "i64", "i32", "i16", "i8"],
        "expected a whole number",
    ),
    (&["f64", "f32"], "expected a number"),
    // (how serde calls an enum of names)
    (&["string or map"], "expected a text"),
];

/// Types of Rust with fewer whole numbers than JSON, and their largest number.
const SMALL_TYPES: [(&str, u64); 6] = [
    ("u32", u32::MAX as u64),
    ("u16", u16::MAX as u64),
    ("u8", u8::MAX as u64),
    ("i32", i32::MAX as u64),
    ("i16", i16::MAX as u64),
    ("i8", i8::MAX as u64),
];

/// A message that may be serde's: without types of Rust, and in brief.
fn told(message: &str) -> Cow<'_, str> {
    let message = brief(message);
    if !message.contains("expected ") {
        return message;
    }
    let mut told = message.into_owned();
    // a number of the right kind, but too large: without a sign
    if let Some((_, number)) = told.split_once("invalid value: integer `")
        && number.starts_with(|c: char| c.is_ascii_digit())
    {
        for (name, most) in SMALL_TYPES {
            told = told.replace(
                &format!("expected {name}"),
                &format!("expected at most {most}"),
            );
        }
    }
    // (how serde calls a struct)
    while let Some(start) = told.find("expected struct ") {
        let name = start + "expected struct ".len();
        let rest = told[name..].find(|c: char| !c.is_alphanumeric());
        let end = rest.map_or(told.len(), |length| name + length);
        told.replace_range(start..end, "expected a map");
    }
    for (types, words) in TYPES {
        for name in types {
            told = told.replace(&format!("expected {name}"), words);
        }
    }
    Cow::Owned(told)
}

fn version_not_found(name: &str, version: Option<u32>, available: &str) -> String {
    match version {
        Some(version) => {
            format!("environment `{name}` has no version {version}: it provides {available}")
        }
        None => format!("environment `{name}` has versions: ask for one of {available}"),
    }
}

fn invalid_action(action: &str, space: &str, hint: &str) -> String {
    let [action, space] = [action, space].map(shortened);
    match hint {
        "" => format!("invalid action {action}: the action space is {space}"),
        hint => format!("invalid action {action}: {hint}; the action space is {space}"),
    }
}

/// Returns the start of a name for a message, with unprintable characters escaped.
pub(crate) fn quoted(name: &str) -> String {
    printable(&shortened(name)).into_owned()
}

impl From<SeedError> for Error {
    fn from(error: SeedError) -> Self {
        match error {
            SeedError::Invalid(text) => Self::InvalidSeed(text),
            error => Self::Custom(error.to_string()),
        }
    }
}

/// Returns advice for the user, or an empty text.
fn advice(source: &std::io::Error) -> &'static str {
    match source.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            ": free some space, or choose another place"
        }
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn names_are_quoted_in_short_and_without_control_characters() {
        let huge = "x".repeat(100_000);
        let names = ["a\u{1b}]0;title\u{7}", "a\u{202e}b\u{2066}", "a\nb", &huge];
        for name in names.map(str::to_owned) {
            let errors = [
                Error::MalformedId(name.clone()),
                Error::InvalidSeed(name.clone()),
                Error::NamespaceNotFound {
                    namespace: name.clone(),
                    hint: String::new(),
                },
                Error::NameNotFound {
                    id: name.clone(),
                    hint: String::new(),
                },
                Error::Registration {
                    id: name.clone(),
                    reason: String::new(),
                },
            ];
            for error in errors {
                let text = error.to_string();
                assert!(text.len() < 400, "{text}");
                assert_eq!(printable(&text), text);
            }
        }
    }

    #[test]
    fn messages_do_not_repeat_long_texts() {
        let huge = "ß".repeat(100_000);
        let number = |json: serde_json::Value| {
            let snapshot = crate::Snapshot::of(&json)?;
            snapshot.get::<(f64, f64)>()
        };
        let error = number(serde_json::json!([0.5, huge])).unwrap_err();
        let others = [
            Error::argument("A-v0", format!("`width` is {huge:?}")),
            Error::InvalidSpace(format!("it has {huge:?} elements")),
        ];
        for error in others.iter().chain([&error]) {
            let text = error.to_string();
            assert!(text.len() < 3000, "{} bytes", text.len());
            assert!(text.contains("ßßß") && text.contains(" ... "), "{text}");
        }
    }

    #[test]
    fn types_are_told_in_words() {
        let told = |error: Error| error.to_string();
        let read = |text: &str| serde_json::from_str::<(f64, u8, i32)>(text).unwrap_err();
        for (text, words) in [
            (r#"["x"]"#, "expected a number"),
            ("[0.5, -1]", "expected a whole number, zero or greater"),
            ("[0.5, 1, null]", "expected a whole number"),
        ] {
            let message = told(Error::argument("A-v0", read(text).to_string()));
            assert!(
                message.contains(words) && !message.contains("u8"),
                "{message}"
            );
            assert!(told(Error::Snapshot(read(text).to_string())).contains(words));
        }
    }

    #[test]
    fn a_number_beyond_its_type_is_told_the_largest() {
        #[derive(Debug, serde::Deserialize)]
        struct Sized {
            _width: u32,
            _offset: i32,
            _shade: u8,
        }
        let told = |width: &str, offset: &str, shade: &str| {
            let text = format!(r#"{{"_width": {width}, "_offset": {offset}, "_shade": {shade}}}"#);
            let error = serde_json::from_str::<Sized>(&text).unwrap_err();
            Error::argument("A-v0", error.to_string()).to_string()
        };
        for (width, offset, shade, words) in [
            ("4294967296", "0", "0", "expected at most 4294967295"),
            ("0", "2147483648", "0", "expected at most 2147483647"),
            ("0", "0", "256", "expected at most 255"),
            ("-1", "0", "0", "expected a whole number, zero or greater"),
            ("0", "-2147483649", "0", "expected a whole number"),
            ("1.5", "0", "0", "expected a whole number, zero or greater"),
        ] {
            let message = told(width, offset, shade);
            assert!(message.contains(words), "{message}");
        }
    }

    #[test]
    fn enums_and_structs_are_told_in_words() {
        #[derive(Debug, serde::Deserialize)]
        enum Kind {
            Plain,
        }
        #[derive(Debug, serde::Deserialize)]
        struct Camera {
            _distance: f64,
        }
        let told =
            |error: serde_json::Error| Error::argument("A-v0", error.to_string()).to_string();
        let read = serde_json::from_value::<Kind>;
        let kind = told(read(serde_json::json!(1)).unwrap_err());
        assert!(kind.ends_with("expected a text"), "{kind}");
        assert!(matches!(read(serde_json::json!("Plain")), Ok(Kind::Plain)));
        let camera = serde_json::from_value::<Camera>(serde_json::json!(0));
        let camera = told(camera.unwrap_err());
        assert!(camera.ends_with("expected a map"), "{camera}");
    }

    #[test]
    fn a_full_disk_says_what_to_do() {
        let message = |kind: ErrorKind| Error::io(Path::new("a.gif"), kind.into()).to_string();
        assert!(
            message(ErrorKind::StorageFull).ends_with(": free some space, or choose another place")
        );
        assert!(!message(ErrorKind::NotFound).contains("space"));
    }
}
