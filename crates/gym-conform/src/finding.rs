//! The result of a check.

use std::fmt;

use serde::Serialize;

/// The severity of a broken rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Severity {
    /// A rule that users rely on is broken.
    Error,
    /// The environment works, but is harder to use.
    Warning,
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Finding {
    /// The name of the check, one of [`CHECKS`](crate::CHECKS).
    pub check: &'static str,
    /// The severity.
    pub severity: Severity,
    /// The observed fault, and its place.
    pub message: String,
    /// The reason for the rule.
    pub why: &'static str,
    /// The remedy.
    pub mend: &'static str,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        writeln!(f, "{severity}: {}: {}", self.check, self.message)?;
        writeln!(f, "  why: {}", self.why)?;
        write!(f, "  mend: {}", self.mend)
    }
}
