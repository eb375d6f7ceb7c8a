//! Faults in drawings and what is told of them.

use super::*;

/// Returns the walk's metadata with other render modes.
fn drawn(render_modes: &'static [RenderMode]) -> Metadata {
    Metadata {
        render_modes,
        ..Metadata::drawn(10, (200, 40))
    }
}

twists! {
    "metadata-complete.list" NamesAList {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::RgbArrayList])
        }
    }

    "metadata-complete.twice" NamesAModeTwice {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::RgbArray])
        }
    }

    "metadata-complete.changes" OtherRate {
        fn metadata(env: &Of<Self>) -> Metadata {
            Metadata::drawn(if env.mind.is_begun { 20 } else { 10 }, (200, 40))
        }
    }

    "metadata-complete.hidden-drawing" HidesADrawing {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[])
        }
    }

    "metadata-complete.hidden-text" HidesAText {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[])
        }

        fn draw(_: &Of<Self>, _: &mut dyn Canvas) {}

        fn ansi(_: &Of<Self>) -> Option<String> {
            Some("here".into())
        }
    }

    "metadata-complete.height" TooHigh {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata::drawn(10, (1, 1 << 15))
        }
    }

    "metadata-complete.width" TooNarrow {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata::drawn(10, (0, 40))
        }
    }

    "render-modes.human-alone" HumanAlone {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::Human])
        }
    }

    "render-modes.no-text" NoText {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::Ansi])
        }

        fn ansi(_: &Of<Self>) -> Option<String> {
            Some(String::new())
        }
    }

    "drawing-pure.calls" DrawsOtherwise {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let looked = env.look();
            drawn_too(env, canvas, |canvas| canvas.circle([looked as f64, 0.0], 2.0, Color::BLACK));
        }
    }

    "drawing-sound.nothing-at-the-end" NothingAtTheEnd {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            if env.walk.position().abs() < 1.0 {
                env.walk.draw(canvas);
            }
        }
    }

    "drawing-sound.pop" PopsTooMuch {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.pop());
        }
    }

    "drawing-sound.width" WidthIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.line([0.0; 2], [9.0; 2], f64::NAN, Color::WHITE));
        }
    }

    "drawing-sound.radius" RadiusIsInfinite {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.circle([0.0; 2], f64::INFINITY, Color::WHITE));
        }
    }

    "drawing-sound.text-size" SizeIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.text("x", [0.0; 2], f64::NAN, Align::Left, Color::WHITE));
        }
    }

    "drawing-sound.corner" CornerIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let shape = Shape::Rect { min: [0.0; 2], size: [9.0; 2], corner: f64::NAN };
            drawn_too(env, canvas, |canvas| canvas.fill(shape, Color::WHITE));
        }
    }

    "drawing-sound.curve" CurveIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let path = [Segment::Move([0.0; 2]), Segment::Quad([0.0; 2], [f64::NAN, 0.0]), Segment::Close];
            drawn_too(env, canvas, |canvas| canvas.fill(Shape::Path(&path), Color::WHITE));
        }
    }

    "drawing-sound.transform" TransformIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| {
                canvas.push(Transform::translate(f64::NAN, 0.0));
                canvas.pop();
            });
        }
    }
}
