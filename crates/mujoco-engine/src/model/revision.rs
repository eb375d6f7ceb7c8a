//! Revisions of MuJoCo's engine: groups of versions with equal results.

mod changes;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The version of libmujoco whose results the engine repeats.
///
/// Versions with equal results share a revision, and each version's name selects it. A later
/// revision is greater; `revision/changes.rs` lists what changed.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(try_from = "String", into = "String")]
#[non_exhaustive]
pub enum Revision {
    /// 3.11, 3.12 and 3.13.
    V3_12,
    /// 3.17.
    V3_17,
    /// 4.0.0.
    #[default]
    V4_0,
    /// 4.0.1.
    V4_0_1,
}

impl Revision {
    /// All revisions, the oldest first.
    pub const ALL: [Self; 4] = [Self::V3_12, Self::V3_17, Self::V4_0, Self::V4_0_1];

    /// The name, such as `4.0`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.versions()[0]
    }

    /// The names of the versions with these results. The first is the revision's own name.
    #[must_use]
    pub fn versions(self) -> &'static [&'static str] {
        match self {
            Self::V3_12 => &["3.12", "3.11", "3.13", "3.11.0", "3.12.0", "3.13.0"],
            Self::V3_17 => &["3.17", "3.17.0"],
            Self::V4_0 => &["4.0", "4.0.0"],
            Self::V4_0_1 => &["4.0.1"],
        }
    }
}

impl fmt::Display for Revision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Revision {
    type Err = String;

    fn from_str(version: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|revision| revision.versions().contains(&version))
            .ok_or_else(|| {
                let known = Self::ALL.map(|revision| match revision.versions() {
                    [own, others @ ..] if !others.is_empty() => {
                        format!("\"{own}\" (also {})", others.join(", "))
                    }
                    _ => format!("\"{revision}\""),
                });
                format!(
                    "there is no MuJoCo version {version:?}: the versions are {}",
                    known.join(", ")
                )
            })
    }
}

impl TryFrom<String> for Revision {
    type Error = String;

    fn try_from(version: String) -> Result<Self, String> {
        version.parse()
    }
}

impl From<Revision> for String {
    fn from(revision: Revision) -> Self {
        revision.name().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_version_names_its_revision() {
        for revision in Revision::ALL {
            for version in revision.versions() {
                assert_eq!(version.parse(), Ok(revision));
            }
            let stored = serde_json::to_string(&revision).unwrap();
            assert_eq!(stored, format!("{:?}", revision.to_string()));
            assert_eq!(serde_json::from_str::<Revision>(&stored).unwrap(), revision);
        }
        let error = "3.14".parse::<Revision>().unwrap_err();
        assert!(
            error.starts_with("there is no MuJoCo version \"3.14\": the versions are \"3.12\"")
        );
        assert!(
            error.ends_with("\"4.0\" (also 4.0.0), \"4.0.1\""),
            "{error}"
        );
    }
}
