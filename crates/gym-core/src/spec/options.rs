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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn who_names_options_takes_no_others_and_who_names_none_takes_any() {
        let given = |names: &[&str]| -> Kwargs {
            let options = names.iter().map(|name| ((*name).to_owned(), json!(1)));
            options.collect()
        };
        let named = ResetOptions(&[("low", "0.1"), ("high", "0.2")]);
        for names in [&[][..], &["low"], &["high", "low"]] {
            named.check("A-v0", &given(names)).unwrap();
        }
        for names in [&["lo"][..], &["low", "lo"]] {
            let error = named.check("A-v0", &given(names)).unwrap_err().to_string();
            assert!(
                error.contains("`A-v0`") && error.contains("did you mean `low`"),
                "{error}"
            );
        }
        for names in [&[][..], &["low"]] {
            ResetOptions::default()
                .check("A-v0", &given(names))
                .unwrap();
        }
    }
}
