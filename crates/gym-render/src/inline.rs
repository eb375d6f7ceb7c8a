//! Images in notebooks: Jupyter with the kernel `evcxr`.
//!
//! The kernel calls `evcxr_display` on the value of a cell, if the value has this method, and shows
//! the text that `evcxr_display` prints between two marks (evcxr's documentation, "Custom display
//! of user types"). If a notebook's first cell uses `?`, the kernel prints the value with `{:?}`
//! instead. Therefore the first cell should only contain definitions, as in `docs/notebook.ipynb`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gym_core::Result;
use gym_core::render::Frame;

use crate::{Plot, Video, VideoFormat, png};

/// An image that a notebook shows as the value of a cell.
///
/// ```
/// use gym_render::{Inline, frame};
/// use gym_core::canvas::Color;
///
/// let picture = frame((4, 4), |canvas| canvas.clear(Color::WHITE))?;
/// Inline::frame(&picture)?
/// # ; Ok::<(), gym_core::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inline {
    mime: &'static str,
    /// The text of HTML or SVG, or a PNG in base64.
    content: String,
}

impl Inline {
    /// Makes an image of one frame, as PNG.
    ///
    /// # Errors
    /// The errors of [`write_png`](crate::write_png).
    pub fn frame(frame: &Frame) -> Result<Self> {
        Ok(Self {
            mime: "image/png",
            content: STANDARD.encode(png::bytes(frame)?),
        })
    }

    /// Makes an animation, as GIF.
    ///
    /// # Errors
    /// The errors of [`Video`].
    pub fn gif(fps: u32, frames: &[Frame]) -> Result<Self> {
        let mut video = Video::in_memory(VideoFormat::Gif, fps)?;
        frames.iter().try_for_each(|frame| video.write(frame))?;
        let bytes = video.into_bytes()?;
        // as HTML, because nbconvert does not show content of type image/gif
        let content = format!(
            r#"<img src="data:image/gif;base64,{}">"#,
            STANDARD.encode(bytes)
        );
        Ok(Self {
            mime: "text/html",
            content,
        })
    }

    /// Makes an image of a plot, as SVG.
    pub fn plot(plot: &Plot) -> Self {
        Self {
            mime: "image/svg+xml",
            content: crate::svg(plot.size(), |canvas| plot.draw(canvas)),
        }
    }

    /// Prints the image for the notebook's kernel, which calls this method.
    pub fn evcxr_display(&self) {
        println!("{}", self.marked());
    }

    fn marked(&self) -> String {
        format!(
            "EVCXR_BEGIN_CONTENT {}\n{}\nEVCXR_END_CONTENT",
            self.mime, self.content
        )
    }
}

impl Plot {
    /// Prints the plot for the notebook's kernel, which calls this method.
    pub fn evcxr_display(&self) {
        Inline::plot(self).evcxr_display();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_stand_between_marks() {
        let frames = [Frame::new(2, 1).unwrap(), Frame::new(2, 1).unwrap()];
        let content = |inline: &Inline, mime: &str| {
            let marked = inline.marked();
            let content = marked
                .strip_prefix(&format!("EVCXR_BEGIN_CONTENT {mime}\n"))
                .unwrap();
            content
                .strip_suffix("\nEVCXR_END_CONTENT")
                .unwrap()
                .to_owned()
        };
        let frame = content(&Inline::frame(&frames[0]).unwrap(), "image/png");
        assert!(STANDARD.decode(frame).unwrap().starts_with(b"\x89PNG"));
        let image = content(&Inline::gif(10, &frames).unwrap(), "text/html");
        let data = image
            .strip_prefix(r#"<img src="data:image/gif;base64,"#)
            .unwrap()
            .strip_suffix("\">")
            .unwrap();
        assert!(STANDARD.decode(data).unwrap().starts_with(b"GIF89a"));
        assert!(content(&Inline::plot(&Plot::new("t")), "image/svg+xml").starts_with("<svg"));
        assert!(
            Inline::frame(&Frame::new(0, 1).unwrap()).is_err() && Inline::gif(10, &[]).is_err()
        );
    }
}
