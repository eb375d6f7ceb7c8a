//! Whether data fits a model, and whether its numbers lie within the engine's bounds.

use super::{Data, State};
use crate::math::MAXVAL;
use crate::physics::{AWAKE, Call};
use crate::{Error, Model, Result};

/// Whether trees are awake, or lead to each other in cycles.
fn is_cyclic(asleep: &[i32]) -> bool {
    let mut followed = vec![false; asleep.len()];
    asleep.iter().all(|next| match usize::try_from(*next) {
        Err(_) => *next >= AWAKE,
        Ok(next) => {
            let sleeps = asleep.get(next).is_some_and(|other| *other >= 0);
            sleeps && !std::mem::replace(&mut followed[next], true)
        }
    })
}

impl Data {
    /// Checks that the data fits the model, for instance after reading a snapshot.
    ///
    /// # Errors
    /// [`Error::Data`] if an array of the state has another length than the model's. Any number may
    /// stand in it, as after a step that diverged: see [`is_bounded`](Self::is_bounded).
    pub fn check(&self, m: &Model) -> Result<()> {
        for state in self.states() {
            let none = state.qfrc_applied.is_empty() && state.xfrc_applied.is_empty();
            let applied = |length: usize| if none { 0 } else { length };
            let inverse = self.last == Some(Call::Inverse) && state.qacc.len() == m.nv();
            let nqacc = if inverse { m.nv() } else { 0 };
            let (trees, asleep) = if m.plan().sleeps {
                (
                    m.ntree(),
                    m.nq() + 7 * m.nmocap() + 2 * m.nv() + m.nsensordata(),
                )
            } else {
                (0, 0)
            };
            for (name, have, length) in [
                ("qpos", state.qpos.len(), m.nq()),
                ("qvel", state.qvel.len(), m.nv()),
                ("ctrl", state.ctrl.len(), m.nu()),
                ("qacc_warmstart", state.qacc_warmstart.len(), m.nv()),
                ("act", state.act.len(), m.na()),
                ("mocap_pos", state.mocap_pos.len(), m.nmocap()),
                ("mocap_quat", state.mocap_quat.len(), m.nmocap()),
                ("qfrc_applied", state.qfrc_applied.len(), applied(m.nv())),
                ("xfrc_applied", state.xfrc_applied.len(), applied(m.nbody())),
                ("qacc", state.qacc.len(), nqacc),
                ("tree_asleep", state.tree_asleep.len(), trees),
                ("asleep", state.asleep.len(), asleep),
            ] {
                if have != length {
                    let reason = format!("{name} has {have} elements, the model needs {length}");
                    return Err(Error::Data(reason));
                }
            }
            if !is_cyclic(&state.tree_asleep) {
                let reason =
                    "tree_asleep has a number that is no tree, or trees that sleep in no cycle";
                return Err(Error::Data(reason.to_owned()));
            }
        }
        Ok(())
    }

    /// Whether every number of the state lies within ±1e10, and of `ctrl` within the range of
    /// `float32`. The next step resets a state that does not.
    pub fn is_bounded(&self) -> bool {
        let within = |most: f64| move |x: &f64| x.abs() <= most; // false for NaN
        self.states().iter().all(|state| {
            let parts = [
                &state.qpos[..],
                &state.qvel,
                &state.qacc_warmstart,
                &state.act,
                state.mocap_pos.as_flattened(),
                state.mocap_quat.as_flattened(),
                &state.qfrc_applied,
                state.xfrc_applied.as_flattened(),
                &state.qacc,
                &state.asleep,
            ];
            state.time.is_finite()
                && parts.into_iter().flatten().all(within(MAXVAL))
                && state.ctrl.iter().all(within(f32::MAX.into()))
        })
    }

    /// The current state, and the one from which the last call started.
    fn states(&self) -> Vec<State> {
        let before = self.last.map(|_| self.before.clone());
        before.into_iter().chain([self.state()]).collect()
    }
}
