//! Noise on rendered frames, drawn in numpy's order. Put
//! [`AddRenderObservation`](crate::AddRenderObservation) around these wrappers to observe the
//! frames.
//!
//! The wrappers draw from the environment's own [generator](Env::generator), as in Gymnasium, so
//! rendering changes the environment's later draws.

use gym_core::registry::WrapperConfig;
use gym_core::render::{Frame, Rendered};
use gym_core::{BoxEnv, Env, Error, Generator, Outcome, Reset, Result, Wrapper, WrapperSpec};

use crate::within::lend;

/// Replaces random pixels of rendered frames with white noise.
pub type AddWhiteNoise<E = BoxEnv> = Noise<E, add_white_noise::Config>;

/// Covers rendered frames with square patches of white noise at random places.
pub type ObstructView<E = BoxEnv> = Noise<E, obstruct_view::Config>;

/// The arguments of [`AddWhiteNoise`].
pub mod add_white_noise {

    gym_core::arguments! {
        /// The pixels that are replaced, and their new colours.
        #[derive(Copy)]
        pub struct Config {
            /// The probability that a pixel is replaced, in `[0, 1)`.
            pub probability_of_noise_per_pixel: f64,
            /// Whether the noise is grey rather than coloured.
            pub is_noise_grayscale: bool = false,
        }
    }

    impl From<f64> for Config {
        fn from(probability_of_noise_per_pixel: f64) -> Self {
            Self {
                probability_of_noise_per_pixel,
                ..Self::default()
            }
        }
    }

    impl From<(f64, bool)> for Config {
        fn from((probability_of_noise_per_pixel, is_noise_grayscale): (f64, bool)) -> Self {
            Self {
                probability_of_noise_per_pixel,
                is_noise_grayscale,
            }
        }
    }

    gym_core::register_wrapper!(
        "AddWhiteNoise", "replaces random pixels of rendered frames with noise", Config,
        env: super::AddWhiteNoise::new
    );
}

/// The arguments of [`ObstructView`].
pub mod obstruct_view {

    gym_core::arguments! {
        /// The covered share, and the noise.
        #[derive(Copy)]
        pub struct Config {
            /// The approximate share of pixels to cover, in `[0, 1)`.
            pub obstructed_pixels_ratio: f64,
            /// The width and height of a patch in pixels: at least 1.
            pub obstruction_width: u32,
            /// Whether the noise is grey rather than coloured.
            pub is_noise_grayscale: bool = false,
        }
    }

    impl From<(f64, u32)> for Config {
        fn from((obstructed_pixels_ratio, obstruction_width): (f64, u32)) -> Self {
            Self {
                obstructed_pixels_ratio,
                obstruction_width,
                ..Self::default()
            }
        }
    }

    impl From<(f64, u32, bool)> for Config {
        fn from(
            (obstructed_pixels_ratio, obstruction_width, is_noise_grayscale): (f64, u32, bool),
        ) -> Self {
            Self {
                obstructed_pixels_ratio,
                obstruction_width,
                is_noise_grayscale,
            }
        }
    }

    gym_core::register_wrapper!(
        "ObstructView", "covers rendered frames with patches of noise", Config,
        env: super::ObstructView::new
    );
}

/// A pattern of noise in pictures.
pub trait Pattern: WrapperConfig + Copy + std::fmt::Debug + Send + 'static {
    /// Checks the arguments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for invalid arguments.
    fn check(&self) -> Result<()>;

    /// Covers parts of a frame.
    fn cover(&self, rng: &mut Generator, frame: &mut Frame);
}

/// The wrapper of a [`Pattern`].
#[derive(Clone, Debug)]
pub struct Noise<E, P> {
    inner: E,
    pattern: P,
}

gym_core::inner!(impl Noise<E, P>);

impl<E: Env, P: Pattern> Noise<E, P> {
    /// Adds noise to the frames of `env`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for arguments out of their range.
    pub fn new(env: E, config: impl Into<P>) -> Result<Self> {
        let pattern = config.into();
        pattern.check()?;
        Ok(Self {
            inner: env,
            pattern,
        })
    }
}

impl<E: Env, P: Pattern> Wrapper for Noise<E, P> {
    type Observation = E::Observation;
    type Action = E::Action;

    gym_core::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.inner.step_into(action, observation)
    }

    fn on_render(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.inner.render_into(rendered)?;
        let Rendered::Frame(frame) = rendered else {
            return Err(Error::UnsupportedMode {
                target: P::NAME.into(),
                mode: "noise".into(),
                reason: "it needs single frames: make the environment with `RenderMode::RgbArray`"
                    .into(),
            });
        };
        self.pattern.cover(lend::<P>(&mut self.inner)?, frame);
        Ok(())
    }

    fn name(&self) -> &'static str {
        P::NAME
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.pattern.spec())
    }
}

impl Pattern for add_white_noise::Config {
    fn check(&self) -> Result<()> {
        check_share::<Self>(
            "probability_of_noise_per_pixel",
            self.probability_of_noise_per_pixel,
        )
    }

    fn cover(&self, rng: &mut Generator, frame: &mut Frame) {
        let white = white(rng, frame, self.is_noise_grayscale);
        cover(frame, &white, |_| {
            rng.random() < self.probability_of_noise_per_pixel
        });
    }
}

impl Pattern for obstruct_view::Config {
    fn check(&self) -> Result<()> {
        if self.obstruction_width == 0 {
            return Err(Self::refuse(
                "obstruction_width is 0: it must be at least 1",
            ));
        }
        check_share::<Self>("obstructed_pixels_ratio", self.obstructed_pixels_ratio)
    }

    fn cover(&self, rng: &mut Generator, frame: &mut Frame) {
        let (rows, columns) = (frame.height() as usize, frame.width() as usize);
        let mut mask = vec![false; rows * columns];
        let per_patch = self.obstructed_pixels_ratio / f64::from(self.obstruction_width).powi(2);
        let patches = (mask.len() as f64 * per_patch) as usize;
        let low = self.obstruction_width as usize / 2;
        let high = self.obstruction_width as usize - low;
        for _ in 0..patches {
            let center = rng.choice(mask.len());
            let (row, column) = (center / columns, center % columns);
            for y in row.saturating_sub(low)..(row + high).min(rows) {
                let covered = column.saturating_sub(low)..(column + high).min(columns);
                mask[y * columns..][covered].fill(true);
            }
        }
        let white = white(rng, frame, self.is_noise_grayscale);
        cover(frame, &white, |i| mask[i]);
    }
}

fn check_share<C: WrapperConfig>(name: &str, share: f64) -> Result<()> {
    match (0.0..1.0).contains(&share) {
        true => Ok(()),
        false => Err(C::refuse(format!(
            "{name} is {share}: it must be in [0, 1)"
        ))),
    }
}

/// White noise for every channel of every pixel of a frame.
fn white(rng: &mut Generator, frame: &Frame, is_grayscale: bool) -> Vec<u8> {
    /// The largest red, green and blue parts of a gray value, whose sum is the gray value: `255 *
    /// [0.2989, 0.5870, 0.1140]`, truncated, minus one because numpy's `integers` excludes `high`
    /// (Gymnasium's `wrappers/rendering.py`).
    const GRAYSCALE_HIGHS: [u8; 3] = [75, 148, 28];
    /// The largest value of coloured noise: Gymnasium draws below 255.
    const HIGH: u8 = 254;

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

/// Overwrites the pixels for which `mask` returns true.
fn cover(frame: &mut Frame, noise: &[u8], mut mask: impl FnMut(usize) -> bool) {
    let pixels = frame
        .pixels_mut()
        .chunks_exact_mut(3)
        .zip(noise.chunks_exact(3));
    for (i, (pixel, noise)) in pixels.enumerate() {
        if mask(i) {
            pixel.copy_from_slice(noise);
        }
    }
}
