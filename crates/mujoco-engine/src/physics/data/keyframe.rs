//! The states that a model names.

use super::Data;
use crate::{Error, Model, Result};

impl Data {
    /// Resets to a keyframe of the model: MuJoCo's `mj_resetDataKeyframe`.
    /// [`key_id`](crate::CompiledModel::key_id) finds the number of a name.
    ///
    /// # Errors
    /// [`Error::Data`] if the model has no keyframe of that number.
    pub fn reset_keyframe(&mut self, m: &Model, key: usize) -> Result<()> {
        let count = m.key_qpos.len();
        if key >= count {
            let reason = format!("there is no keyframe {key}: the model has {count}");
            return Err(Error::Data(reason));
        }
        self.reset(m);
        self.time = m.key_time[key];
        self.qpos.copy_from_slice(&m.key_qpos[key]);
        self.qvel.copy_from_slice(&m.key_qvel[key]);
        self.act.copy_from_slice(&m.key_act[key]);
        self.ctrl.copy_from_slice(&m.key_ctrl[key]);
        let positions = m.key_mpos[key].as_chunks().0;
        self.mocap_pos.copy_from_slice(positions);
        let orientations = m.key_mquat[key].as_chunks().0;
        self.mocap_quat.copy_from_slice(orientations);
        Ok(())
    }
}
