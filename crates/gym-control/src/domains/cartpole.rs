//! Cartpole: balance a pole on a cart, or swing up one, two or three.
//!
//! | | |
//! |---|---|
//! | observation | `position`: of the cart, then cosine and sine of each pole; `velocity` of cart and poles |
//! | action | force on the cart, as a share of 10 N |
//! | reward | height of the poles, times values of small controls, slow poles and a cart in the middle; if `sparse`, 1 within 0.25 m and an angle with a cosine above 0.995, else 0 |
//! | start | upright within 0.034 rad and 0.1 m, or hanging |
//! | end | never |
//! | limit | 10 s: 1000 steps of 0.01 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default.
//!
//! Source: dm_control 1.0.45, `suite/cartpole.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::keys::json;
use gym_core::{Error, Keys, Registration, Result};
use mujoco_engine::lanes::Derived;
use mujoco_engine::{Data, Model};

use super::axis::{XZ, ZZ};
use super::config;
use crate::domain::clip;
use crate::rewards::{Sigmoid, Tolerance, mean};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

const CENTRED: Tolerance = Tolerance::within(0.0, 0.0).margin(2.0, Sigmoid::Gaussian);
const GENTLE: Tolerance = Tolerance::within(0.0, 0.0).margin(1.0, Sigmoid::Quadratic(0.0));
const SLOW: Tolerance = Tolerance::within(0.0, 0.0).margin(5.0, Sigmoid::Gaussian);
const CART: Tolerance = Tolerance::within(-0.25, 0.25);
const UPRIGHT: Tolerance = Tolerance::within(0.995, 1.0);

config! { 10.0;
    /// Number of poles, one on the other.
    pub poles: u32 = 1,
    /// Whether the poles hang at the start.
    pub swing_up: bool = false,
    /// Whether the reward is sparse: 1 with the poles upright and the cart in the middle, otherwise 0.
    pub sparse: bool = false,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Cartpole {
    swing_up: bool,
    sparse: bool,
}

/// Iterates over the cosines of the poles' angles.
fn heights(d: &Data) -> impl Iterator<Item = f64> {
    d.xmat[2..].iter().map(|mat| mat[ZZ])
}

impl Domain for Cartpole {
    type Config = Config;

    const NAME: &'static str = "Cartpole";

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        let n = config.poles;
        if !(1..=20).contains(&n) {
            return Err(Error::argument("poles", format!("{n} is not from 1 to 20")));
        }
        let mut poles = String::new();
        for i in (1..=n).rev() {
            let height = if i == 1 { 0 } else { 1 };
            poles = format!(
                r#"<body name="pole_{i}" pos="0 0 {height}" childclass="pole"><joint name="hinge_{i}"/><geom name="pole_{i}"/>{poles}</body>"#
            );
        }
        let n = f64::from(n);
        let (front, near) = if n > 1.0 {
            (-1.0 - 2.0 * n, -2.0 * n)
        } else {
            (-4.0, -2.0)
        };
        let text = include_str!("../../models/cartpole.xml")
            .replace("{poles}", &poles)
            .replace("{front}", &front.to_string())
            .replace("{near}", &near.to_string())
            .replace("{floor}", &(1.0 - n - 0.05).to_string());
        Ok(text.into())
    }

    fn new(config: &Config, _: &Simulation) -> Result<Self> {
        Ok(Self {
            swing_up: config.swing_up,
            sparse: config.sparse,
        })
    }
}

impl SimTask for Cartpole {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let Start { data, rng, .. } = start;
        if self.swing_up {
            data.qpos[0] = 0.01 * rng.standard_normal();
            data.qpos[1] = PI + 0.01 * rng.standard_normal();
            data.qpos[2..].fill_with(|| 0.1 * rng.standard_normal());
        } else {
            data.qpos[0] = rng.uniform(-0.1, 0.1);
            data.qpos[1..].fill_with(|| rng.uniform(-0.034, 0.034));
        }
        data.qvel.fill_with(|| 0.01 * rng.standard_normal());
        Ok(())
    }

    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::Xmat])
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let poles = d.xmat[2..].iter().flat_map(|mat| [mat[ZZ], mat[XZ]]);
        out.vector("position", std::iter::once(d.qpos[0]).chain(poles));
        out.vector("velocity", d.qvel.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("position").positions(..1);
        for pole in 2..names.model().nbody() {
            let pole = names.body(pole);
            let text = format!("{{}} of angle of {pole} from the vertical");
            names.each(&["cosine", "sine"], &text);
        }
        names.part("velocity").velocities(..);
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        if self.sparse {
            return CART.of(d.qpos[0])
                * heights(d)
                    .map(|cos| UPRIGHT.of_element(cos))
                    .product::<f64>();
        }
        let upright = mean(&d.xmat[2..], |mat| (mat[ZZ] + 1.0) / 2.0);
        let centred = (1.0 + CENTRED.of(d.qpos[0])) / 2.0;
        let gentle = (4.0 + GENTLE.of_element(d.ctrl[0])) / 5.0;
        let slow = d.qvel[1..].iter().map(|v| SLOW.of_element(*v));
        let slow = (1.0 + slow.fold(f64::INFINITY, f64::min)) / 2.0;
        upright * gentle * slow * centred
    }
}

const fn cartpole(id: &'static str, description: &'static str) -> Registration {
    register::<Cartpole>(id, description)
        .keys(|_| Keys::new(json!({"Left": [-1.0], "Right": [1.0]})).idle(json!([0.0])))
}

gym_core::register!(
    cartpole(
        "dm_control/cartpole-balance-v0",
        "Balance a pole on a cart."
    ),
    cartpole(
        "dm_control/cartpole-balance_sparse-v0",
        "Balance a pole on a cart; only the goal is rewarded."
    )
    .kwargs(r#"{"sparse": true}"#),
    cartpole(
        "dm_control/cartpole-swingup-v0",
        "Swing up a pole on a cart, and balance it."
    )
    .kwargs(r#"{"swing_up": true}"#)
    .clip(clip(5)),
    cartpole(
        "dm_control/cartpole-swingup_sparse-v0",
        "Swing up a pole on a cart; only the goal is rewarded."
    )
    .kwargs(r#"{"swing_up": true, "sparse": true}"#),
    cartpole(
        "dm_control/cartpole-two_poles-v0",
        "Swing up two poles, one on the other, on a cart."
    )
    .kwargs(r#"{"swing_up": true, "poles": 2}"#),
    cartpole(
        "dm_control/cartpole-three_poles-v0",
        "Swing up three poles, one on the other, on a cart."
    )
    .kwargs(r#"{"swing_up": true, "poles": 3}"#),
);
