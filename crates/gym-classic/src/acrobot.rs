//! Acrobot: swing the tip of a two-link arm above a line, with a motor only in the elbow.
//!
//! | | |
//! |---|---|
//! | observation | cos and sin of the first angle, cos and sin of the second, both angular velocities in ±4π and ±9π rad/s; `Box(6, float32)` |
//! | action | [`Action`]: torque at the elbow, -1, 0 or 1 N m unless [`Config::AVAIL_TORQUE`] says otherwise; `Discrete(3)` |
//! | reward | -1 per step, 0 for the last one |
//! | start | angles and velocities uniform in ±0.1; reset options `low`, `high` (numbers, -0.1 and 0.1) are other bounds |
//! | end | terminated when the tip is one link's length above the shoulder |
//! | limit | 500 steps |
//!
//! The first angle is 0 when the upper link hangs down; the second is relative to the first. From
//! Sutton (1996), "Generalization in reinforcement learning: successful examples using sparse
//! coarse coding"; the equations are those of Sutton and Barto's book, in the order of Gymnasium
//! 1.4.0, `envs/classic_control/acrobot.py`, integrated by one Runge-Kutta step of 0.2 s.

mod draw;

use std::f64::consts::{PI, TAU};

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::math::{Real, numpy_sin_cos_f32, sin_cos, square};
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    ArgumentType, Generator, Keys, Names, Policy, Registration, Reset, Result, Space, Stateful,
    Task,
};
use gym_native::{Compared, Equations, Next};
use serde::{Deserialize, Serialize};

use crate::{constants, policy, reset};

/// The environment.
pub type Acrobot = Stateful<AcrobotDynamics>;

const GRAVITY: f64 = 9.8; // m/s^2

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    #[expect(non_snake_case, reason = "Gymnasium's names")]
    pub const struct Config {
        /// The duration of a step.
        #[unit = "s"]
        pub dt: f64 = 0.2,
        /// Length of the upper link.
        #[unit = "m"]
        pub LINK_LENGTH_1: f64 = 1.0,
        /// Length of the lower link: used only for drawing, not in the equations.
        #[unit = "m"]
        pub LINK_LENGTH_2: f64 = 1.0,
        /// Mass of the upper link.
        #[unit = "kg"]
        pub LINK_MASS_1: f64 = 1.0,
        /// Mass of the lower link.
        #[unit = "kg"]
        pub LINK_MASS_2: f64 = 1.0,
        /// Distance of the upper link's centre of mass from its joint.
        #[unit = "m"]
        pub LINK_COM_POS_1: f64 = 0.5,
        /// Distance of the lower link's centre of mass from its joint.
        #[unit = "m"]
        pub LINK_COM_POS_2: f64 = 0.5,
        /// Moment of inertia of each link.
        #[unit = "kg m²"]
        pub LINK_MOI: f64 = 1.0,
        /// The largest angular velocity of the upper link.
        #[unit = "rad/s"]
        pub MAX_VEL_1: f64 = 4.0 * PI,
        /// The largest angular velocity of the lower link.
        #[unit = "rad/s"]
        pub MAX_VEL_2: f64 = 9.0 * PI,
        /// The torque of each action.
        #[unit = "N m"]
        pub AVAIL_TORQUE: [f64; 3] = [-1.0, 0.0, 1.0],
        /// The largest noise on the torque: uniform between minus and plus this value.
        #[unit = "N m"]
        pub torque_noise_max: f64 = 0.0,
        /// The source of the equations.
        pub book_or_nips: Equation = Equation::Book,
    }
}

/// The source of the equation for the lower link's acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Equation {
    /// The equation of Sutton and Barto's book.
    #[default]
    Book,
    /// The equation of Sutton's paper at NIPS, without the centrifugal force of the upper link.
    Nips,
}

impl ArgumentType for Equation {
    fn kind() -> String {
        "string".into()
    }
}

gym_core::discrete! {
    /// The torque at the elbow.
    pub enum Action {
        /// -1 N m.
        Negative,
        /// 0 N m.
        Zero,
        /// 1 N m.
        Positive,
    }
}

/// The state of both links.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Angle of the first link from hanging down, in rad.
    pub theta1: f64,
    /// Angle of the second link from the first, in rad.
    pub theta2: f64,
    /// Angular velocity of the first link, in rad/s.
    pub dtheta1: f64,
    /// Angular velocity of the second link, in rad/s.
    pub dtheta2: f64,
    /// Whether the episode has just begun: the state and the observed sines and cosines are then
    /// `float32`.
    pub fresh: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct AcrobotDynamics {
    config: Config,
    /// The arguments of the constructor, from which the spaces follow.
    built: Config,
    constants: Compared<Constants<f64>>,
}

impl Task for AcrobotDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 6];
    type Action = Action;

    const NAME: &'static str = "Acrobot";

    fn new(config: Config) -> Result<Self> {
        let Config {
            dt,
            LINK_LENGTH_1: l1,
            LINK_LENGTH_2: l2,
            LINK_MASS_1: m1,
            LINK_MASS_2: m2,
            LINK_COM_POS_1: lc1,
            LINK_COM_POS_2: lc2,
            LINK_MOI: moi,
            MAX_VEL_1: max_vel_1,
            MAX_VEL_2: max_vel_2,
            AVAIL_TORQUE: [torque_0, torque_1, torque_2],
            torque_noise_max,
            book_or_nips: _,
        } = config;
        constants::finite(
            Self::NAME,
            [
                ("dt", dt),
                ("LINK_LENGTH_1", l1),
                ("LINK_LENGTH_2", l2),
                ("LINK_COM_POS_1", lc1),
                ("LINK_COM_POS_2", lc2),
                ("AVAIL_TORQUE[0]", torque_0),
                ("AVAIL_TORQUE[1]", torque_1),
                ("AVAIL_TORQUE[2]", torque_2),
                ("torque_noise_max", torque_noise_max),
            ],
        )?;
        constants::limits(
            Self::NAME,
            [
                ("LINK_MASS_1", m1),
                ("LINK_MASS_2", m2),
                ("LINK_MOI", moi),
                ("MAX_VEL_1", max_vel_1),
                ("MAX_VEL_2", max_vel_2),
            ],
        )?;
        constants::positive(
            Self::NAME,
            [
                ("LINK_LENGTH_1", l1),
                ("LINK_LENGTH_2", l2),
                (
                    "LINK_MASS_1 * LINK_COM_POS_1^2 + LINK_MOI",
                    m1 * square(lc1) + moi,
                ),
                (
                    "LINK_MASS_2 * LINK_COM_POS_2^2 + LINK_MOI",
                    m2 * square(lc2) + moi,
                ),
            ],
        )?;
        let constants = Constants::of(&config, [square(l1), square(lc1), square(lc2)]);
        Ok(Self {
            config,
            built: config,
            constants: Compared::new(constants, Self::DEFAULTS),
        })
    }

    fn check_start(&self) -> Result<()> {
        let limits = [
            ("MAX_VEL_1", self.config.MAX_VEL_1),
            ("MAX_VEL_2", self.config.MAX_VEL_2),
        ];
        constants::contains_starts(Self::NAME, limits, 0.1)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn assign(&mut self, config: Config) -> Result<()> {
        *self = Self {
            built: self.built,
            ..Self::new(config)?
        };
        Ok(())
    }

    fn observation_space(&self) -> Space {
        let high = [
            1.0,
            1.0,
            1.0,
            1.0,
            self.built.MAX_VEL_1 as f32,
            self.built.MAX_VEL_2 as f32,
        ];
        Space::boxed(high.map(|x| -x), high)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let (low, high) = reset::bounds(reset, Self::NAME, -0.1, 0.1)?;
        let [theta1, theta2, dtheta1, dtheta2] =
            [(); 4].map(|()| f64::from(rng.uniform(low, high) as f32));
        Ok(State {
            theta1,
            theta2,
            dtheta1,
            dtheta2,
            fresh: true,
        })
    }

    fn is_valid(&self, state: &State) -> bool {
        !self.constants.are_defaults()
            || reset::plausible(&[state.theta1, state.theta2, state.dtheta1, state.dtheta2])
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(15, (500, 500))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        self.draw_links(state, canvas);
    }
}

gym_core::constants! {
    /// The constants of the equations: products that Python computes first, in its order.
    pub struct Constants {
        m1_lc1_2,
        m2,
        moi,
        l1_2_lc2_2,
        two_l1_lc2,
        lc2_2,
        l1_lc2,
        m2_lc2_g,
        minus_m2_l1_lc2,
        two_m2_l1_lc2,
        m1_lc1_m2_l1_g,
        m2_l1_lc2,
        m2_lc2_2_moi,
        dt,
        half_dt,
        sixth_dt,
        max_vel_1,
        max_vel_2,
        torque_noise_max,
    }
}

impl Constants<f64> {
    /// The constants that follow from the arguments. `l1_2`, `lc1_2` and `lc2_2` are the squares of
    /// `LINK_LENGTH_1`, `LINK_COM_POS_1` and `LINK_COM_POS_2`.
    const fn of(config: &Config, [l1_2, lc1_2, lc2_2]: [f64; 3]) -> Self {
        let Config {
            dt,
            LINK_LENGTH_1: l1,
            LINK_MASS_1: m1,
            LINK_MASS_2: m2,
            LINK_COM_POS_1: lc1,
            LINK_COM_POS_2: lc2,
            LINK_MOI: moi,
            MAX_VEL_1: max_vel_1,
            MAX_VEL_2: max_vel_2,
            torque_noise_max,
            ..
        } = *config;
        Self {
            m1_lc1_2: m1 * lc1_2,
            m2,
            moi,
            l1_2_lc2_2: l1_2 + lc2_2,
            two_l1_lc2: 2.0 * l1 * lc2,
            lc2_2,
            l1_lc2: l1 * lc2,
            m2_lc2_g: m2 * lc2 * GRAVITY,
            minus_m2_l1_lc2: -m2 * l1 * lc2,
            two_m2_l1_lc2: 2.0 * m2 * l1 * lc2,
            m1_lc1_m2_l1_g: (m1 * lc1 + m2 * l1) * GRAVITY,
            m2_l1_lc2: m2 * l1 * lc2,
            m2_lc2_2_moi: m2 * lc2_2 + moi,
            dt,
            half_dt: dt / 2.0,
            sixth_dt: dt / 6.0,
            max_vel_1,
            max_vel_2,
            torque_noise_max,
        }
    }
}

impl Equations for AcrobotDynamics {
    type Numbers = [f64; 4];
    type Input = [f64; 1];
    type Constants = Constants<f64>;

    // the squares 1.0 and 0.25 are exact
    const DEFAULTS: Option<Constants<f64>> =
        Some(Constants::of(&Config::DEFAULT, [1.0, 0.25, 0.25]));

    #[inline(always)]
    fn constants(&self) -> Compared<Constants<f64>> {
        self.constants
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> [f64; 4] {
        [state.theta1, state.theta2, state.dtheta1, state.dtheta2]
    }

    #[inline(always)]
    fn unpack(&self, [theta1, theta2, dtheta1, dtheta2]: [f64; 4], fresh: bool) -> State {
        State {
            theta1,
            theta2,
            dtheta1,
            dtheta2,
            fresh,
        }
    }

    /// Returns the torque of an action.
    #[inline(always)]
    fn encode(&self, action: Action) -> [f64; 1] {
        let [negative, zero, positive] = self.config.AVAIL_TORQUE;
        // not by index, which would prevent vectorization
        [if action == Action::Negative {
            negative
        } else if action == Action::Zero {
            zero
        } else {
            positive
        }]
    }

    #[inline(always)]
    fn noise(constants: &Constants<f64>, [torque]: &mut [f64; 1], rng: &mut Generator) {
        let most = constants.torque_noise_max;
        if most > 0.0 {
            *torque += rng.uniform(-most, most);
        }
    }

    /// Advances the state by one step.
    #[inline(always)]
    fn step<R: Real>(
        &self,
        constants: Constants<R>,
        numbers: [R; 4],
        [torque]: [R; 1],
    ) -> Next<R, Self> {
        let is_nips = self.config.book_or_nips == Equation::Nips;
        let [theta1, theta2, dtheta1, dtheta2] = rk4(constants, is_nips, numbers, torque);
        let (theta1, theta2) = (wrap(theta1), wrap(theta2));
        let dtheta1 = bound(dtheta1, constants.max_vel_1);
        let dtheta2 = bound(dtheta2, constants.max_vel_2);
        let (sin1, cos1) = theta1.sin_cos();
        let (sin2, cos2) = theta2.sin_cos();
        let terminated = (-cos1 - (theta2 + theta1).cos()).gt(theta1.same(1.0));
        let reward = R::select(terminated, theta1.same(0.0), theta1.same(-1.0));
        Next {
            numbers: [theta1, theta2, dtheta1, dtheta2],
            reward,
            terminated,
            observation: [cos1, sin1, cos2, sin2, dtheta1, dtheta2],
        }
    }

    /// Computes the observation. The first state of an episode is `float32`, and numpy computes its
    /// sines and cosines in `float32`.
    fn observe(&self, state: &State) -> [f32; 6] {
        let State {
            theta1,
            theta2,
            dtheta1,
            dtheta2,
            fresh,
        } = *state;
        let [(sin1, cos1), (sin2, cos2)] = [theta1, theta2].map(|theta| {
            if fresh {
                numpy_sin_cos_f32(theta as f32)
            } else {
                let (sin, cos) = sin_cos(theta);
                (sin as f32, cos as f32)
            }
        });
        [cos1, sin1, cos2, sin2, dtheta1 as f32, dtheta2 as f32]
    }
}

/// Limits `x` to ±`limit`.
#[inline(always)]
fn bound<R: Real>(x: R, limit: R) -> R {
    let x = R::select(x.lt(-limit), -limit, x);
    R::select(x.gt(limit), limit, x)
}

/// Returns the derivatives of both angles and both velocities.
#[inline(always)]
fn dsdt<R: Real>(
    constants: Constants<R>,
    is_nips: bool,
    [theta1, theta2, dtheta1, dtheta2]: [R; 4],
    torque: R,
) -> [R; 4] {
    // squares of variables are `pow`, as in numpy
    let Constants {
        m1_lc1_2,
        m2,
        moi,
        l1_2_lc2_2,
        two_l1_lc2,
        lc2_2,
        l1_lc2,
        m2_lc2_g,
        minus_m2_l1_lc2,
        two_m2_l1_lc2,
        m1_lc1_m2_l1_g,
        m2_l1_lc2,
        m2_lc2_2_moi,
        ..
    } = constants;
    let (sin2, cos2) = theta2.sin_cos();

    let d1 = (cos2 * two_l1_lc2 + l1_2_lc2_2) * m2 + m1_lc1_2 + moi + moi;
    let d2 = (cos2 * l1_lc2 + lc2_2) * m2 + moi;
    let phi2 = (theta1 + theta2 - PI / 2.0).cos() * m2_lc2_g;
    let phi1 = dtheta2.square() * minus_m2_l1_lc2 * sin2 - dtheta2 * two_m2_l1_lc2 * dtheta1 * sin2
        + (theta1 - PI / 2.0).cos() * m1_lc1_m2_l1_g
        + phi2;
    let pull = torque + d2 / d1 * phi1;
    let pull = if is_nips {
        pull
    } else {
        pull - dtheta1.square() * m2_l1_lc2 * sin2
    };
    let ddtheta2 = (pull - phi2) / (-(d2.square() / d1) + m2_lc2_2_moi);
    let ddtheta1 = -(d2 * ddtheta2 + phi1) / d1;
    [dtheta1, dtheta2, ddtheta1, ddtheta2]
}

/// Returns `y + k * factor`.
#[inline(always)]
fn add<R: Real>([y1, y2, y3, y4]: [R; 4], [k1, k2, k3, k4]: [R; 4], factor: R) -> [R; 4] {
    [
        y1 + k1 * factor,
        y2 + k2 * factor,
        y3 + k3 * factor,
        y4 + k4 * factor,
    ]
}

/// Takes one step of the classical Runge-Kutta method.
#[inline(always)]
fn rk4<R: Real>(constants: Constants<R>, is_nips: bool, y0: [R; 4], torque: R) -> [R; 4] {
    let Constants {
        dt,
        half_dt,
        sixth_dt,
        ..
    } = constants;
    let (one, two) = (dt.same(1.0), dt.same(2.0));
    let mut k = dsdt(constants, is_nips, y0, torque);
    let mut sum = k;
    // a loop, because unrolled copies of the derivatives are no faster
    for (step, weight) in [(half_dt, two), (half_dt, two), (dt, one)] {
        k = dsdt(constants, is_nips, add(y0, k, step), torque);
        sum = add(sum, k, weight);
    }
    add(y0, sum, sixth_dt)
}

/// Wraps an angle to ±π: turn by turn as in Gymnasium, for the same rounding, unless the angle is
/// huge.
#[inline(always)]
fn wrap<R: Real>(x: R) -> R {
    const MANY: f64 = 1e4;
    let few = x.abs().le(x.same(MANY));
    if !R::all(few) {
        return wrap_many(x, few);
    }
    let mut x = x;
    loop {
        let above = x.gt(x.same(PI));
        if !R::any(above) {
            break;
        }
        x = R::select(above, x - TAU, x);
    }
    loop {
        let below = x.lt(x.same(-PI));
        if !R::any(below) {
            break;
        }
        x = R::select(below, x + TAU, x);
    }
    x
}

/// Wraps angles of which some are huge; `few` marks the others.
#[cold]
fn wrap_many<R: Real>(x: R, few: R::Mask) -> R {
    let at_once = (x + PI).modulo(TAU) - PI;
    R::select(few, wrap(R::select(few, x, x.same(0.0))), at_once)
}

gym_core::register!(
    Registration::new::<Acrobot>("Acrobot-v1")
        .description("Swing a two-link arm above a line.")
        .max_episode_steps(500)
        .reward_threshold(-100.0)
        .reset_options(&[("low", "-0.05"), ("high", "0.05")])
        .vector_entry_point(gym_native::entry_point::<AcrobotDynamics>)
        .light_step()
        .names(|_| Names::new(
            &[
                "cosine of the first angle",
                "sine of the first angle",
                "cosine of the second angle",
                "sine of the second angle",
                "first angular velocity (rad/s)",
                "second angular velocity (rad/s)"
            ],
            &[]
        ))
        .actions(Action::VARIANTS)
        .keys(|_| Keys::new(json!({"Left": 0, "Right": 2})).idle(json!(1)))
        .policy(Policy::rules(
            "pushes the lower link in the direction of its motion",
            |_| reflex(policy::acrobot)
        ))
        .clip(Clip {
            seeds: 5..6,
            every: 1,
            frames: 100,
            size: (200, 200)
        })
);
