//! Reads the recorded results of Gymnasium, for the tests of this package.

use std::path::{Path, PathBuf};

/// A reference file, parsed.
#[derive(Debug)]
pub struct Reference {
    /// The file's name without `.json`.
    pub name: String,
    /// The file's text.
    pub text: String,
    /// The parsed text.
    pub json: serde_json::Value,
}

impl Reference {
    /// Whether the reference is a trace: resets and steps.
    pub fn is_trace(&self) -> bool {
        self.json.get("events").is_some()
    }
}

/// Returns every reference in the folder named by `GYM_REFERENCE`, or in `tests/reference`.
///
/// # Panics
/// If the folder is empty or a file in it is not JSON.
pub fn references() -> Vec<Reference> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference");
    let folder = std::env::var_os("GYM_REFERENCE").map_or(default, PathBuf::from);
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("readable folder").path())
        .collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "json")
    });
    paths.sort();
    assert!(!paths.is_empty(), "{} holds no reference", folder.display());
    paths.into_iter().map(|path| read(&path)).collect()
}

fn read(path: &Path) -> Reference {
    let show = |error: &dyn std::fmt::Display| -> ! { panic!("{}: {error}", path.display()) };
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| show(&error));
    let json = serde_json::from_str(&text).unwrap_or_else(|error| show(&error));
    let name = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    Reference { name, text, json }
}

/// Compiles and runs the documents' snippets as doc tests.
#[cfg(doctest)]
mod documents {
    // `tests/it/book.rs` checks that this list is complete
    #[doc = include_str!("../../docs/atari.md")]
    struct Atari;
    #[doc = include_str!("../../docs/bridge.md")]
    struct Bridge;
    #[doc = include_str!("../../docs/coming-from-gymnasium.md")]
    struct ComingFromGymnasium;
    #[doc = include_str!("../../docs/faq.md")]
    struct Faq;
    #[doc = include_str!("../../docs/python/live.md")]
    struct ChangingATask;
    #[doc = include_str!("../../docs/first-steps.md")]
    struct FirstSteps;
    #[doc = include_str!("../../docs/README.md")]
    struct Introduction;
    #[doc = include_str!("../../docs/mujoco-models.md")]
    struct MujocoModels;
    #[doc = include_str!("../../docs/mujoco-versions.md")]
    struct MujocoVersions;
    #[doc = include_str!("../../docs/minigrid.md")]
    struct Minigrid;
    #[doc = include_str!("../../docs/native.md")]
    struct Native;
    #[doc = include_str!("../../docs/planning.md")]
    struct Planning;
    #[doc = include_str!("../../docs/plugins.md")]
    struct Plugins;
    #[doc = include_str!("../../README.md")]
    struct Readme;
    #[doc = include_str!("../../docs/rendering.md")]
    struct Rendering;
    #[doc = include_str!("../../docs/robotics.md")]
    struct Robotics;
    #[doc = include_str!("../../docs/spaces.md")]
    struct Spaces;
    #[doc = include_str!("../../docs/training.md")]
    struct Training;
    #[doc = include_str!("../../docs/vectors.md")]
    struct Vectors;
    #[doc = include_str!("../../docs/wrappers.md")]
    struct Wrappers;
    #[doc = include_str!("../../docs/writing-wrappers.md")]
    struct WritingWrappers;
}
