//! What the humanoids share: the observation, and the reward of those who stand and go upright.

use gym_core::Result;
use mujoco_engine::Data;

use super::axis::ZX;
use super::minus;
use crate::rewards::{Sigmoid, Tolerance, mean, small_control};
use gym_sim::{Naming, Observation, Simulation};

const UPRIGHT: Tolerance = Tolerance::above(0.9).margin(1.9, Sigmoid::Linear(0.0));
const STILL: Tolerance = Tolerance::within(0.0, 0.0).margin(2.0, Sigmoid::Gaussian);

/// A body with a head, hands and feet. The first sensor is the velocity of the centre of mass.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    torso: usize,
    head: usize,
    /// Left hand and foot, right hand and foot.
    limbs: [usize; 4],
    kernels: Kernels,
    /// The element of the torso's matrix that tells how upright it is.
    upright: usize,
    standing: Tolerance,
    /// The rewarded speed; `None` to stand.
    going: Option<Tolerance>,
}

/// numpy's operations, whose last bits depend on the CPU.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernels {
    pub(super) norm: fn([f64; 2]) -> f64,
    pub(super) times: fn([f64; 3], &[f64; 9]) -> [f64; 3],
}

impl Figure {
    pub(super) fn new(
        s: &Simulation,
        kernels: Kernels,
        torso: &str,
        [left_hand, left_foot, right_hand, right_foot]: [&str; 4],
        upright: usize,
    ) -> Result<Self> {
        Ok(Self {
            torso: s.body(torso)?,
            head: s.body("head")?,
            limbs: [
                s.body(left_hand)?,
                s.body(left_foot)?,
                s.body(right_hand)?,
                s.body(right_foot)?,
            ],
            kernels,
            upright,
            standing: UPRIGHT,
            going: None,
        })
    }

    /// Sets the speed that is rewarded by 1, 0 for standing still, and the height of a head that
    /// stands.
    pub(super) fn rewarded(self, speed: f64, height: f64) -> Self {
        let going = Tolerance::above(speed).margin(speed, Sigmoid::Linear(0.0));
        Self {
            standing: Tolerance::above(height).margin(height / 4.0, Sigmoid::Gaussian),
            going: (speed != 0.0).then_some(going),
            ..self
        }
    }

    pub(super) fn observe(&self, d: &Data, out: &mut Observation) {
        let (pos, mat) = (d.xpos[self.torso], &d.xmat[self.torso]);
        out.vector("joint_angles", d.qpos[7..].iter().copied());
        out.scalar("head_height", d.xpos[self.head][2]);
        let limbs = self
            .limbs
            .map(|limb| (self.kernels.times)(minus(d.xpos[limb], pos), mat));
        out.vector("extremities", limbs.into_iter().flatten());
        out.vector("torso_vertical", mat[ZX..].iter().copied());
        out.vector("com_velocity", d.sensordata[..3].iter().copied());
    }

    pub(super) fn names(&self, names: &mut Naming<'_>) {
        let torso = names.body(self.torso);
        names.part("joint_angles").positions(7..);
        names.part("head_height").add("height of head (m)");
        names.part("extremities");
        for limb in self.limbs {
            let limb = names.body(limb);
            names.xyz(&format!("{{}} of {limb} in the frame of {torso} (m)"));
        }
        names.part("torso_vertical");
        names.xyz(&format!("{{}} of the vertical in the frame of {torso}"));
        names.part("com_velocity").sensors(..3);
    }

    pub(super) fn reward(&self, d: &Data) -> f64 {
        let standing = self.standing.of(d.xpos[self.head][2]);
        let stand = standing * UPRIGHT.of(d.xmat[self.torso][self.upright]);
        let small_control = (4.0 + small_control(&d.ctrl)) / 5.0;
        let velocity = [d.sensordata[0], d.sensordata[1]];
        let well = match &self.going {
            None => mean(&velocity, |v| STILL.of_element(*v)),
            Some(going) => (5.0 * going.of((self.kernels.norm)(velocity)) + 1.0) / 6.0,
        };
        small_control * stand * well
    }
}
