//! Models from the argument `xml_file`.

use std::sync::Arc;

use gym_core::{Error, Result};
use mujoco_engine::{Model, Revision};

/// Loads a model for a revision of the engine. `xml_file` is the path of a file, which begins with
/// `.`, `/` or `~`, or the text of a model, which begins with `<`.
///
/// # Errors
/// [`Error::InvalidArgument`] for a file that cannot be read, and what is not a model.
pub fn load(xml_file: &str, revision: Revision) -> Result<Arc<Model>> {
    let model = if xml_file.starts_with('<') {
        Model::from_xml_with(xml_file, revision)
    } else if xml_file.starts_with(['.', '/', '~']) {
        let path = match (xml_file.strip_prefix("~/"), std::env::home_dir()) {
            (Some(rest), Some(home)) => home.join(rest),
            _ => xml_file.into(),
        };
        Model::from_path_with(path, revision)
    } else {
        let reason = format!(
            "{xml_file:?} is no model: a file's path begins with `.`, `/` or `~`, and a text with `<`"
        );
        return Err(Error::argument("xml_file", reason));
    };
    match model {
        Ok(model) => Ok(Arc::new(model)),
        Err(error) => Err(Error::argument("xml_file", error.to_string())),
    }
}
