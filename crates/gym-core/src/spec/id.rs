//! The grammar of environment ids: `[namespace/]name[-vN]`.

use std::fmt;
use std::str::FromStr;

use crate::value::{Error, Result};

/// An environment id in its parts.
///
/// A namespace is made of letters, digits, `_`, `:` and `-`; a name may contain `.` as well. As in
/// Gymnasium, letters of any script are allowed.
///
/// ```
/// # use gym_core::registry::EnvId;
/// let id: EnvId = "my_envs/Corridor-v2".parse().unwrap();
/// assert_eq!(id.namespace.as_deref(), Some("my_envs"));
/// assert_eq!((id.name.as_str(), id.version), ("Corridor", Some(2)));
/// assert_eq!(id.to_string(), "my_envs/Corridor-v2");
/// assert!("Cart Pole-v1".parse::<EnvId>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EnvId {
    /// The part before `/`.
    pub namespace: Option<String>,
    /// The name, without version.
    pub name: String,
    /// The number after `-v`.
    pub version: Option<u32>,
}

impl EnvId {
    /// Namespace and name, without version.
    pub fn unversioned(&self) -> String {
        Self {
            version: None,
            ..self.clone()
        }
        .to_string()
    }

    /// Whether the other id has the same namespace and name.
    pub fn same_name(&self, other: &Self) -> bool {
        self.namespace == other.namespace && self.name == other.name
    }
}

impl FromStr for EnvId {
    type Err = Error;

    fn from_str(id: &str) -> Result<Self> {
        let malformed = || Error::MalformedId(id.to_owned());
        let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | ':' | '-');
        let (namespace, rest) = match id.split_once('/') {
            Some((namespace, rest)) => (Some(namespace), rest),
            None => (None, id),
        };
        let (name, version) = match rest.rsplit_once("-v") {
            Some((name, digits))
                if !name.is_empty()
                    && !digits.is_empty()
                    && digits.bytes().all(|b| b.is_ascii_digit()) =>
            {
                (name, Some(digits.parse().map_err(|_| malformed())?))
            }
            _ => (rest, None),
        };
        let valid = namespace.is_none_or(|ns| !ns.is_empty() && ns.chars().all(word))
            && !name.is_empty()
            && name.chars().all(|c| word(c) || c == '.');
        if !valid {
            return Err(malformed());
        }
        Ok(Self {
            namespace: namespace.map(str::to_owned),
            name: name.to_owned(),
            version,
        })
    }
}

impl fmt::Display for EnvId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(namespace) = &self.namespace {
            write!(f, "{namespace}/")?;
        }
        f.write_str(&self.name)?;
        match self.version {
            Some(version) => write!(f, "-v{version}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts() {
        let id = |text: &str| text.parse::<EnvId>().unwrap();
        assert_eq!(id("CartPole-v1").version, Some(1));
        assert_eq!(id("CartPole").version, None);
        assert_eq!(id("A-v1-v2").name, "A-v1");
        assert_eq!(id("a/B.c-v01").to_string(), "a/B.c-v1");
        assert_eq!(id("-v1").name, "-v1");
        assert_eq!(id("X-vy").name, "X-vy");
        // digits followed by more characters are not a version
        assert_eq!(
            (id("X-v1a").name.as_str(), id("X-v1a").version),
            ("X-v1a", None)
        );
    }

    #[test]
    fn malformed() {
        for text in [
            "",
            "CartPole v1",
            "/CartPole-v1",
            "a/",
            "a/b/C-v1",
            "a b/C-v1",
            "C-v99999999999",
        ] {
            assert!(text.parse::<EnvId>().is_err(), "{text:?}");
        }
    }
}
