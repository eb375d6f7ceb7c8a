//! Steps that were computed together with other worlds, ahead of the call: see
//! [`lanes`](super::super::lanes).

use super::Data;
use crate::Model;
use crate::physics::Call;
use crate::physics::lanes::{Stride, state_len};

impl Data {
    /// Whether the derived arrays are older than the state: the last step was taken together with
    /// other worlds, which stores only the arrays that its [`Stride`] reads.
    /// [`resume`](Self::resume) computes the others.
    #[must_use]
    pub fn has_stale_arrays(&self) -> bool {
        self.stale
    }

    /// Stores the result of the next step.
    pub(crate) fn store_result(&mut self, record: &[f64]) {
        self.ahead.clear();
        self.ahead.extend_from_slice(record);
        self.is_ahead = true;
    }

    /// Takes over the result of a step that was computed ahead; false if there is none.
    ///
    /// # Panics
    /// If the data is of another model, or the step was another one.
    pub fn catch_up(&mut self, m: &Model, stride: &Stride) -> bool {
        if !self.is_ahead {
            return false;
        }
        if stride.settles {
            self.resize_for(m);
        } else {
            self.begin_call(m, Call::Step);
        }
        let (mut ahead, d) = (std::mem::take(&mut self.ahead), &mut *self);
        let (after, rest) = ahead.split_at(state_len(m));
        let (start, derived) = rest.split_at(state_len(m));
        put(after, [&mut d.qpos, &mut d.qvel, &mut d.qacc_warmstart]);
        let before = &mut d.before;
        if !stride.settles {
            let vectors = [
                &mut before.qpos,
                &mut before.qvel,
                &mut before.qacc_warmstart,
            ];
            put(start, vectors);
        }
        for _ in 0..stride.steps {
            before.time = d.time;
            d.time += m.opt.timestep;
        }
        let mut numbers = derived.iter();
        for array in &stride.reads {
            let to = array.of_data(d).iter_mut();
            to.zip(&mut numbers).for_each(|(to, from)| *to = *from);
        }
        self.contact_forces = stride.contact_forces;
        if stride.settles {
            ahead.push(self.before.time);
            self.begin_call(m, Call::Step1);
        }
        (self.ahead, self.is_ahead, self.stale) = (ahead, false, true);
        true
    }

    /// Goes back to the start of the last timestep, if the last step was taken together with other
    /// worlds and [ended](Stride::settles) with a [`step1`](crate::step1). Both can then be
    /// repeated.
    pub(super) fn rewind(&mut self) -> bool {
        if !self.stale || self.last != Some(Call::Step1) {
            return false;
        }
        let Some(time) = self.ahead.pop() else {
            return false;
        };
        self.time = time;
        let length = self.qpos.len() + 2 * self.qvel.len();
        let vectors = [&mut self.qpos, &mut self.qvel, &mut self.qacc_warmstart];
        put(&self.ahead[length..], vectors);
        self.stale = false;
        true
    }
}

/// Copies the front of `numbers` to `vectors`, one after the other.
fn put(numbers: &[f64], vectors: [&mut Vec<f64>; 3]) {
    let mut numbers = numbers.iter();
    for vector in vectors {
        for (to, from) in vector.iter_mut().zip(&mut numbers) {
            *to = *from;
        }
    }
}
