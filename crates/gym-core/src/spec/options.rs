//! The reset options that a registration names.

use crate::spec::Kwargs;
use crate::spec::nearest;
use crate::value::error::quoted;
use crate::value::{Error, Result};

/// The reset options of an environment, each with an example as JSON; empty if the registration
/// names none.
#[derive(Clone, Copy, Debug, Default)]
pub struct ResetOptions(pub &'static [(&'static str, &'static str)]);

impl ResetOptions {
    /// Refuses unknown options, if the registration names any.
    pub fn check(self, id: &str, options: &Kwargs) -> Result<()> {
        let names = || self.0.iter().map(|(name, _)| *name);
        let unknown = options
            .keys()
            .find(|option| names().all(|name| name != *option));
        let Some(unknown) = unknown.filter(|_| !self.0.is_empty()) else {
            return Ok(());
        };
        let near = nearest(unknown, names()).map(|near| format!(": did you mean `{near}`?"));
        let known = names()
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(", ");
        let reason = format!(
            "unknown option `{}`{} (known are {known})",
            quoted(unknown),
            near.unwrap_or_default()
        );
        Err(Error::argument(format!("reset options of `{id}`"), reason))
    }
}
