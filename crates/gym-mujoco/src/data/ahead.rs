//! Steps that are taken together with other worlds, ahead of the call: see
//! [`lanes`](crate::physics::lanes).

use super::Data;
use crate::Model;
use crate::physics::Call;
use crate::physics::lanes::Stride;

impl Data {
    /// Whether the derived arrays are not of the last call: several worlds took it together, and
    /// only what their environments read was kept.
    #[must_use]
    pub fn is_behind(&self) -> bool {
        self.behind
    }

    /// Keeps what the next step leads to.
    pub(crate) fn look_ahead(&mut self, record: &[f64]) {
        self.ahead.clear();
        self.ahead.extend_from_slice(record);
        self.is_ahead = true;
    }

    /// Takes the timesteps of a step that were taken ahead; false if there are none.
    pub fn catch_up(&mut self, m: &Model, stride: &Stride) -> bool {
        if !self.is_ahead {
            return false;
        }
        self.begin(m, Call::Step);
        let mut ahead = std::mem::take(&mut self.ahead);
        let mut numbers = ahead.iter();
        let before = &mut self.before;
        for vector in [
            &mut self.qpos,
            &mut self.qvel,
            &mut self.qacc_warmstart,
            &mut before.qpos,
            &mut before.qvel,
            &mut before.qacc_warmstart,
        ] {
            vector
                .iter_mut()
                .zip(&mut numbers)
                .for_each(|(to, from)| *to = *from);
        }
        for _ in 0..stride.steps {
            before.time = self.time;
            self.time += m.opt.timestep;
        }
        for array in &stride.reads {
            let to = array.of_data(self).iter_mut();
            to.zip(&mut numbers).for_each(|(to, from)| *to = *from);
        }
        if stride.settles {
            ahead.push(self.before.time);
            self.begin(m, Call::Step1);
        }
        self.ahead = ahead;
        self.behind = true;
        true
    }

    /// Goes back to the start of the last timestep of a step that [ended](Stride::settles) with a
    /// [`step1`] and was taken together with other worlds, so that both can be repeated.
    pub fn rewind(&mut self) {
        let length = self.qpos.len() + 2 * self.qvel.len();
        let Some(time) = self.ahead.pop().filter(|_| self.behind) else {
            return;
        };
        self.time = time;
        let mut numbers = self.ahead[length..].iter();
        for vector in [&mut self.qpos, &mut self.qvel, &mut self.qacc_warmstart] {
            vector
                .iter_mut()
                .zip(&mut numbers)
                .for_each(|(to, from)| *to = *from);
        }
        self.behind = false;
    }
}
