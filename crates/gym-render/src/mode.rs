//! The render modes that a recorder accepts.

use gym_core::render::{RenderMode, Rendered};
use gym_core::{Error, Result};

/// Refuses an environment, described by `target`, whose render mode has no frames.
pub(crate) fn require_frames(target: impl Into<String>, mode: Option<RenderMode>) -> Result<()> {
    match mode {
        Some(mode) if mode.single() == RenderMode::RgbArray => Ok(()),
        Some(mode) => Err(no_frames(target, &format!("its render mode is {mode}"))),
        None => Err(no_frames(target, "it has no render mode")),
    }
}

/// Returns the error for an environment, described by `target`, that did not render frames.
pub(crate) fn not_frames(target: impl Into<String>, rendered: &Rendered) -> Error {
    let mode = match rendered {
        Rendered::Shown => RenderMode::Human,
        Rendered::Text(_) => RenderMode::Ansi,
        Rendered::Texts(_) => RenderMode::AnsiList,
        Rendered::Depth(_) => RenderMode::DepthArray,
        Rendered::Rgbd(..) => RenderMode::RgbdTuple,
        Rendered::Frame(_) | Rendered::Frames(_) => RenderMode::RgbArray,
    };
    no_frames(target, &format!("its render mode is {mode}"))
}

fn no_frames(target: impl Into<String>, reason: &str) -> Error {
    Error::UnsupportedMode {
        target: target.into(),
        mode: "frames to record".into(),
        reason: format!("{reason}: make it with `.render_mode(RenderMode::RgbArray)`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gym_core::render::{Depth, Frame};

    #[test]
    fn what_is_no_frame_is_refused_with_its_mode() {
        let frame = || Frame::new(2, 1).unwrap();
        let depth = Depth::default;
        for (rendered, mode) in [
            (Rendered::Shown, RenderMode::Human),
            (Rendered::Text("a".into()), RenderMode::Ansi),
            (Rendered::Texts(vec!["a".into()]), RenderMode::AnsiList),
            (Rendered::Depth(depth()), RenderMode::DepthArray),
            (Rendered::Rgbd(frame(), depth()), RenderMode::RgbdTuple),
        ] {
            let told = not_frames("Lake", &rendered).to_string();
            let other = require_frames("Lake", Some(mode)).unwrap_err().to_string();
            assert_eq!(told, other);
            for part in ["Lake", &mode.to_string(), "RenderMode::RgbArray"] {
                assert!(told.contains(part), "{mode}: {told}");
            }
        }
        for mode in [RenderMode::RgbArray, RenderMode::RgbArrayList] {
            require_frames("Lake", Some(mode)).unwrap();
        }
        let none = require_frames("Lake", None).unwrap_err().to_string();
        assert!(none.contains("it has no render mode"), "{none}");
    }
}
