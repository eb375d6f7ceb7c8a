//! What is not computed anew while trees of bodies sleep, as a part of the state.

use super::{Data, State};

impl Data {
    /// Takes over which trees sleep, and what they keep.
    pub(super) fn take_asleep(&mut self, state: &State) {
        self.tree_asleep.clone_from(&state.tree_asleep);
        if state.tree_asleep.is_empty() {
            return;
        }
        let (nq, nv) = (state.qpos.len(), state.qvel.len());
        let mut rest = &state.asleep[..];
        for (array, length) in [
            (&mut self.asleep_qpos, nq + 7 * state.mocap_pos.len()),
            (&mut self.qfrc_smooth, nv),
            (&mut self.qacc_smooth, nv),
            (&mut self.sensordata, usize::MAX),
        ] {
            let (own, others) = rest.split_at(length.min(rest.len()));
            array.clear();
            array.extend_from_slice(own);
            rest = others;
        }
    }

    /// Stores which trees sleep, and what they keep.
    pub(super) fn put_asleep(&self, state: &mut State) {
        state.tree_asleep.clone_from(&self.tree_asleep);
        state.asleep.clear();
        if self.tree_asleep.is_empty() {
            return;
        }
        for array in [
            &self.asleep_qpos,
            &self.qfrc_smooth,
            &self.qacc_smooth,
            &self.sensordata,
        ] {
            state.asleep.extend_from_slice(array);
        }
    }
}
