//! Arguments that differ between the environments of a native vector.

use std::collections::BTreeMap;

use gym_core::registry::Each;
use gym_core::{Error, Generator, Result};

use crate::{LANES, Native, Packed};

/// The arguments that differ, and the constants computed from them.
#[derive(Clone, Debug)]
pub(crate) struct Varied<D: Native> {
    /// The arguments, sorted by name.
    each: Vec<(String, Each)>,
    /// A buffer for one environment's values by name.
    values: Vec<(String, f64)>,
    /// For each environment: its drawn value of each argument that is a range.
    drawn: Vec<f64>,
    blocks: Vec<<D::Constants as Packed>::Block>,
}

impl<D: Native> Varied<D> {
    /// Prepares the arguments of `num_envs` environments; `None` if no argument differs.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for values that a native vector does not support, such as spaces
    /// that differ.
    pub(crate) fn new(
        dynamics: &D,
        each: &BTreeMap<String, Each>,
        num_envs: usize,
    ) -> Result<Option<Self>> {
        if each.is_empty() {
            return Ok(None);
        }
        let each: Vec<_> = each
            .iter()
            .map(|(name, each)| (name.clone(), each.clone()))
            .collect();
        let values = each.iter().map(|(name, _)| (name.clone(), 0.0)).collect();
        let blocks = vec![dynamics.constants().splat(); num_envs.div_ceil(LANES)];
        let mut varied = Self {
            each,
            values,
            drawn: Vec::new(),
            blocks,
        };
        varied.drawn = vec![0.0; num_envs * varied.ranges()];
        for end in [|(low, _): (f64, f64)| low, |(_, high)| high] {
            for i in 0..num_envs {
                let spaces = |dynamics: &D| (dynamics.observation_space(), dynamics.action_space());
                let own = varied.choose(i, dynamics, end)?;
                varied.keep(i, &own);
                if spaces(&own) != spaces(dynamics) {
                    let names: Vec<_> = varied.each.iter().map(|(name, _)| name.as_str()).collect();
                    let reason = format!(
                        "the values of {} must give all environments the same spaces",
                        names.join(", ")
                    );
                    return Err(Error::argument(
                        format!("a native vector of {}", D::NAME),
                        reason,
                    ));
                }
            }
        }
        Ok(Some(varied))
    }

    /// The constants of a block.
    #[inline(always)]
    pub(crate) fn block(&self, index: usize) -> &<D::Constants as Packed>::Block {
        &self.blocks[index]
    }

    /// The arguments that differ, with the values of environment `index`.
    pub(crate) fn of(&self, index: usize) -> Vec<(String, f64)> {
        let mut drawn = self.drawn_of(index).iter();
        let value = |(name, each): &(String, Each)| {
            let drawn = if each.range().is_some() {
                drawn.next().copied()
            } else {
                None
            };
            (
                name.clone(),
                each.number(index).or(drawn).unwrap_or(f64::NAN),
            )
        };
        self.each.iter().map(value).collect()
    }

    fn drawn_of(&self, index: usize) -> &[f64] {
        let ranges = self.ranges();
        &self.drawn[index * ranges..][..ranges]
    }

    /// The number of arguments that are ranges.
    fn ranges(&self) -> usize {
        self.each
            .iter()
            .filter(|(_, each)| each.range().is_some())
            .count()
    }

    /// Draws new values for an environment; `None` if no argument is a range. If the episode
    /// starts, the caller stores the values with [`keep`](Self::keep).
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for values that are each valid, but not in combination.
    pub(crate) fn draw(
        &mut self,
        index: usize,
        dynamics: &D,
        rng: &mut Generator,
    ) -> Result<Option<D>> {
        if self.drawn.is_empty() {
            return Ok(None);
        }
        self.choose(index, dynamics, |(low, high)| rng.uniform(low, high))
            .map(Some)
    }

    /// Stores the drawn values of environment `index`, from its dynamics `own`.
    pub(crate) fn keep(&mut self, index: usize, own: &D) {
        own.constants()
            .set(&mut self.blocks[index / LANES], index % LANES);
        let chosen = self
            .each
            .iter()
            .zip(&self.values)
            .filter(|((_, each), _)| each.range().is_some());
        let ranges = chosen.clone().count();
        for (drawn, (_, (_, value))) in self.drawn[index * ranges..][..ranges]
            .iter_mut()
            .zip(chosen)
        {
            *drawn = *value;
        }
    }

    /// All values that were drawn, for a snapshot.
    pub(crate) fn drawn(&self) -> &[f64] {
        &self.drawn
    }

    /// Continues with the values `drawn` of a snapshot.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if a value is outside its range.
    pub(crate) fn restore(&mut self, dynamics: &D, drawn: &[f64], num_envs: usize) -> Result<()> {
        let refuse = || {
            Error::Snapshot(format!(
                "its arguments are outside the ranges of this {}",
                D::NAME
            ))
        };
        if drawn.len() != self.drawn.len() {
            return Err(refuse());
        }
        let ranges = drawn.len() / num_envs.max(1);
        for i in 0..num_envs {
            let mut own = drawn[i * ranges..][..ranges].iter();
            let mut fits = true;
            let chosen = self.choose(i, dynamics, |(low, high)| {
                let value = own.next().copied().unwrap_or(low);
                fits &= (low..=high).contains(&value);
                value
            });
            match chosen {
                Ok(own) if fits => self.keep(i, &own),
                _ => return Err(refuse()),
            }
        }
        Ok(())
    }

    /// The dynamics of the environment `index`, with a value of each range from `choose`.
    fn choose(
        &mut self,
        index: usize,
        dynamics: &D,
        mut choose: impl FnMut((f64, f64)) -> f64,
    ) -> Result<D> {
        for ((name, each), (_, value)) in self.each.iter().zip(&mut self.values) {
            *value = match (each.range(), each.number(index)) {
                (Some(range), _) => choose(range),
                (None, Some(value)) => value,
                (None, None) => {
                    return Err(Error::argument(
                        name,
                        "only arguments that are numbers can differ in a native vector",
                    ));
                }
            };
        }
        dynamics.with_numbers(&self.values)
    }

    /// The dynamics of environment `index`.
    pub(crate) fn dynamics(&self, index: usize, dynamics: &D) -> Result<D> {
        dynamics.with_numbers(&self.of(index))
    }
}
