use crate::render::Rendered;
use crate::{BoxEnv, Env, Error, Outcome, Reset, Result, WrapperSpec};

use crate::transform::noise;

/// Covers rendered pictures with square patches of white noise at random places; around it,
/// [`AddRenderObservation`](super::AddRenderObservation) observes them.
///
/// The draws come from the environment's own [generator](Env::generator), as in Gymnasium: rendering
/// then shifts what the environment draws.
#[derive(Clone, Debug)]
pub struct ObstructView<E = BoxEnv> {
    env: E,
    ratio: f64,
    width: u32,
    is_grayscale: bool,
}

super::reach!(ObstructView<E>);

impl<E: Env> ObstructView<E> {
    /// Covers about that share of the pixels with patches of that width, of grey noise or of coloured.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a share outside `[0, 1)` or a width of 0.
    pub fn new(
        env: E,
        obstructed_pixels_ratio: f64,
        obstruction_width: u32,
        is_noise_grayscale: bool,
    ) -> Result<Self> {
        let (ratio, width) = (obstructed_pixels_ratio, obstruction_width);
        let refuse = |reason: String| Err(Error::argument("ObstructView", reason));
        if !(0.0..1.0).contains(&ratio) {
            return refuse(format!("obstructed_pixels_ratio is {ratio}: it must be in [0, 1)"));
        }
        if width == 0 {
            return refuse("obstruction_width is 0: it must be at least 1".into());
        }
        Ok(Self { env, ratio, width, is_grayscale: is_noise_grayscale })
    }
}

impl<E: Env> crate::Wrapper for ObstructView<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.env.step_into(action, observation)
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.env.render_into(rendered)?;
        let frame = noise::expect_frame("ObstructView", rendered)?;
        let rng = super::lend(&mut self.env, "ObstructView")?;
        let (rows, columns) = (frame.height() as usize, frame.width() as usize);
        let mut mask = vec![false; rows * columns];
        let per_patch = self.ratio / f64::from(self.width).powi(2);
        let patches = (mask.len() as f64 * per_patch) as usize;
        let low = self.width as usize / 2;
        let high = self.width as usize - low;
        for _ in 0..patches {
            let center = rng.choice(mask.len());
            let (row, column) = (center / columns, center % columns);
            for y in row.saturating_sub(low)..(row + high).min(rows) {
                let columns_covered = column.saturating_sub(low)..(column + high).min(columns);
                mask[y * columns..][columns_covered].fill(true);
            }
        }
        let white = noise::white(rng, frame, self.is_grayscale);
        noise::cover(frame, &white, |i| mask[i]);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("ObstructView")
                .arg("obstructed_pixels_ratio", self.ratio)
                .arg("obstruction_width", self.width)
                .arg("is_noise_grayscale", self.is_grayscale),
        )
    }
}
