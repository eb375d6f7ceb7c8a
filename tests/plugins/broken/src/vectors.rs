//! Vectors with a fault each, around a sync vector: a registration names them as its native vector.

use gym_core::vector::{Autoreset, Columns, Progress, VectorKind, VectorReset, VectorSpec};
use gym_core::{Registration, Result, Snapshot, Value, VectorEnv, VectorWrapper};

use crate::twisted::Twisted;

/// The fault of a vector.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// The final observations are the first observations of the next episodes.
    Final,
    /// A mask is ignored.
    Mask,
    /// The step that begins an episode has the reward of a step.
    Reward,
    /// The time limit is one step too long.
    Limit,
    /// All sub-environments have the same seed.
    Seeds,
    /// A restored vector has the observations of the reset, and starts from there.
    Snapshot,
    /// Options do not reach the sub-environments.
    Options,
    /// The infos of each sub-environment are the infos of the next sub-environment.
    Infos,
    /// Arguments of single sub-environments do not reach them.
    Each,
    /// `close` has no effect.
    Close,
    /// Every sub-environment after the eighth steps twice.
    Remainder,
}

const FAULTS: [Fault; 12] = [
    Fault::None,
    Fault::Final,
    Fault::Mask,
    Fault::Reward,
    Fault::Limit,
    Fault::Seeds,
    Fault::Snapshot,
    Fault::Options,
    Fault::Infos,
    Fault::Each,
    Fault::Close,
    Fault::Remainder,
];

struct Vector {
    envs: Box<dyn VectorEnv>,
    fault: Fault,
}

/// Makes a sync vector with the fault `F`.
fn vector<const F: usize>(spec: &VectorSpec) -> Result<Box<dyn VectorEnv>> {
    let fault = FAULTS[F];
    let mut sync = spec.clone();
    sync.vectorization_mode = VectorKind::Sync;
    if fault == Fault::Limit {
        sync.env.max_episode_steps = spec.env.max_episode_steps.map(|limit| limit + 1);
    }
    if fault == Fault::Each {
        sync.each.clear();
    }
    Ok(Box::new(Vector {
        envs: sync.make()?,
        fault,
    }))
}

impl VectorWrapper for Vector {
    fn inner(&self) -> &dyn VectorEnv {
        &*self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut *self.envs
    }

    fn on_reset(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        let mut reset = reset.clone();
        match self.fault {
            Fault::Mask => reset.mask = None,
            Fault::Options => reset.options.clear(),
            Fault::Seeds => {
                let first = reset.of(0).and_then(|reset| reset.seed);
                if let Some(seed) = first {
                    let n = self.envs.num_envs();
                    let options = reset.options.clone();
                    reset = VectorReset::seeds(vec![seed; n]);
                    reset.options = options;
                }
            }
            _ => {}
        }
        self.envs.reset_into(&reset, columns)
    }

    fn on_step(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.envs.step_into(actions, columns)?;
        match self.fault {
            Fault::Final if self.envs.autoreset() == Autoreset::SameStep => {
                columns.final_observations = columns.observations.clone();
            }
            Fault::Reward => {
                for (reward, progress) in columns.rewards.iter_mut().zip(&columns.progress) {
                    if *progress == Progress::Started {
                        *reward = 1.0;
                    }
                }
            }
            Fault::Remainder => {
                if let Some(reward) = columns.rewards.get_mut(8) {
                    *reward *= 2.0;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn on_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let next = (index + 1) % self.envs.num_envs();
        let index = if self.fault == Fault::Infos {
            next
        } else {
            index
        };
        self.envs.info(index, visit);
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        self.envs.snapshot()
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.envs.restore(snapshot)?;
        if self.fault == Fault::Snapshot {
            self.envs.reset_into(&1.into(), &mut Columns::default())?;
        }
        Ok(())
    }

    fn on_close(&mut self) {
        if self.fault != Fault::Close {
            self.envs.close();
        }
    }
}

macro_rules! register {
    ($($name:literal = $fault:literal;)*) => {$(
        gym_core::register!(
            Registration::new::<Twisted<crate::faces::ClosesItsGenerator<false>>>(
                concat!("broken/", $name, "-v0")
            )
            .description("Walk from the middle to either end.")
            .reset_options(&[("start", "0.25")])
            .max_episode_steps(12)
            .vector_entry_point(vector::<$fault>)
        );
    )*};
}

register! {
    "none.vector" = 0;
    "vector-equal.final" = 1;
    "vector-equal.mask" = 2;
    "vector-equal.reward" = 3;
    "vector-equal.limit" = 4;
    "vector-equal.seeds" = 5;
    "vector-equal.snapshot" = 6;
    "vector-equal.options" = 7;
    "vector-equal.infos" = 8;
    "vector-equal.each" = 9;
    "vector-equal.close" = 10;
    "vector-equal.remainder" = 11;
}
