//! White noise over pictures, in numpy's order of draws.

use crate::render::{Frame, Rendered};
use crate::{Error, Generator, Result};

/// The largest red, green and blue of grey noise, which is their sum: `255 * [0.2989, 0.5870, 0.1140]`
/// cut off, less one as numpy's `high` is not drawn (`wrappers/rendering.py`).
const GRAYSCALE_HIGHS: [u8; 3] = [75, 148, 28];
/// The largest value of coloured noise: Gymnasium draws below 255.
const HIGH: u8 = 254;

/// The picture to add noise to.
pub(crate) fn expect_frame<'a>(wrapper: &str, rendered: &'a mut Rendered) -> Result<&'a mut Frame> {
    match rendered {
        Rendered::Frame(frame) => Ok(frame),
        _ => Err(Error::UnsupportedMode {
            target: wrapper.into(),
            mode: "noise".into(),
            reason: "it needs single pictures: make the environment with `RenderMode::RgbArray`".into(),
        }),
    }
}

/// Noise for every channel of every pixel of a picture.
pub(crate) fn white(rng: &mut Generator, frame: &Frame, is_grayscale: bool) -> Vec<u8> {
    let mut noise = vec![0; frame.pixels().len()];
    if is_grayscale {
        rng.integers_u8_each(0, &GRAYSCALE_HIGHS, &mut noise);
        for pixel in noise.chunks_exact_mut(3) {
            let sum = pixel.iter().sum();
            pixel.fill(sum);
        }
    } else {
        rng.integers_u8(0, HIGH, &mut noise);
    }
    noise
}

/// Replaces the pixels for which `mask` says so.
pub(crate) fn cover(frame: &mut Frame, noise: &[u8], mut mask: impl FnMut(usize) -> bool) {
    let pixels = frame.pixels_mut().chunks_exact_mut(3).zip(noise.chunks_exact(3));
    for (i, (pixel, noise)) in pixels.enumerate() {
        if mask(i) {
            pixel.copy_from_slice(noise);
        }
    }
}
