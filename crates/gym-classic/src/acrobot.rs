//! Acrobot: swing the tip of a two-link arm above a line, with a motor in the elbow alone.
//!
//! | | |
//! |---|---|
//! | observation | cos and sin of the first angle, cos and sin of the second, both angular velocities in ±4π and ±9π rad/s; `Box(6, float32)` |
//! | action | [`Action`]: torque -1, 0 or 1 N m at the elbow; `Discrete(3)` |
//! | reward | -1 per step, 0 for the last one |
//! | start | angles and velocities uniform in ±0.1; reset options `low`, `high` (numbers, -0.1 and 0.1) are other bounds |
//! | end | terminated when the tip is one link's length above the shoulder |
//! | limit | 500 steps |
//!
//! Differences from Gymnasium: what it leaves to attributes of the class (other equations, noise of the
//! torque, other torques) cannot be changed.
//!
//! The first angle is 0 when the upper link hangs down; the second is relative to the first. From
//! Sutton (1996), "Generalization in reinforcement learning: successful examples using sparse coarse
//! coding"; the equations are those of Sutton and Barto's book, in the order of Gymnasium 1.4.0,
//! `envs/classic_control/acrobot.py`, integrated by one Runge-Kutta step of 0.2 s.

use std::f64::consts::{PI, TAU};

use gym_core::canvas::{Canvas, Color, Primitive};
use gym_core::math::{Real, numpy_sin_cos_f32, sin_cos};
use gym_core::render::Metadata;
use gym_core::vector::native::{self, Equations, Next};
use gym_core::{Generator, NoArguments, Registration, Reset, Result, Space, Stateful, Task, pygame};
use serde::{Deserialize, Serialize};

use crate::reset;

/// The environment.
pub type Acrobot = Stateful<AcrobotDynamics>;

const DT: f64 = 0.2; // s
const LINK_LENGTH_1: f64 = 1.0; // m
const LINK_LENGTH_2: f64 = 1.0; // m
const LINK_MASS_1: f64 = 1.0; // kg
const LINK_MASS_2: f64 = 1.0; // kg
const LINK_COM_POS_1: f64 = 0.5; // m from its joint to the centre of mass
const LINK_COM_POS_2: f64 = 0.5; // m
const LINK_MOI: f64 = 1.0; // kg m^2, of both links
const MAX_VEL_1: f64 = 4.0 * PI; // rad/s
const MAX_VEL_2: f64 = 9.0 * PI; // rad/s
const GRAVITY: f64 = 9.8; // m/s^2

gym_core::discrete! {
    /// The torque at the elbow.
    pub enum Action {
        /// -1 N m.
        Negative,
        /// None.
        Zero,
        /// 1 N m.
        Positive,
    }
}

/// The two links.
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
    /// Whether the episode has just begun: the numbers are then those of `float32`, and so are the
    /// sines and cosines observed.
    pub fresh: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct AcrobotDynamics;

impl Task for AcrobotDynamics {
    type Config = NoArguments;
    type State = State;
    type Observation = [f32; 6];
    type Action = Action;

    const NAME: &'static str = "Acrobot";

    fn new(NoArguments {}: NoArguments) -> Result<Self> {
        Ok(Self)
    }

    fn config(&self) -> &NoArguments {
        &NoArguments {}
    }

    fn observation_space(&self) -> Space {
        let high = [1.0, 1.0, 1.0, 1.0, MAX_VEL_1 as f32, MAX_VEL_2 as f32];
        Space::boxed(high.map(|x| -x), high)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let (low, high) = reset::bounds(reset, Self::NAME, -0.1, 0.1)?;
        let [theta1, theta2, dtheta1, dtheta2] = [(); 4].map(|()| f64::from(rng.uniform(low, high) as f32));
        Ok(State { theta1, theta2, dtheta1, dtheta2, fresh: true })
    }

    fn is_valid(&self, state: &State) -> bool {
        reset::plausible(&[state.theta1, state.theta2, state.dtheta1, state.dtheta2])
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(15, (500, 500))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        const BOUND: f64 = LINK_LENGTH_1 + LINK_LENGTH_2 + 0.2;
        const SCALE: f64 = 500.0 / (2.0 * BOUND); // pixels per m
        const RADIUS: f64 = 0.1 * SCALE;
        const MIDDLE: f64 = 250.0;

        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(500.0));
        let goal = [-BOUND, BOUND].map(|x| [x * SCALE + MIDDLE, SCALE + MIDDLE]);
        canvas.pygame(Primitive::Lines { points: &goal, closed: false, width: 1 }, Color::BLACK);
        // the first state is of 32 bits, and so is what numpy computes from it
        let number = |x: f64| if state.fresh { f64::from(x as f32) } else { x };
        let (sin, cos) = if state.fresh {
            let (sin, cos) = numpy_sin_cos_f32(state.theta1 as f32);
            (f64::from(sin), f64::from(cos))
        } else {
            sin_cos(state.theta1)
        };
        let elbow = [LINK_LENGTH_1 * sin, -LINK_LENGTH_1 * cos].map(|x| number(x * number(SCALE)));
        let angle = |theta: f64| number(theta - number(PI / 2.0));
        let links = [
            ([0.0, 0.0], angle(state.theta1), LINK_LENGTH_1),
            (elbow, angle(number(state.theta1 + state.theta2)), LINK_LENGTH_2),
        ];
        for (joint, angle, length) in links {
            let [x, y] = joint.map(|x| x + MIDDLE);
            let link = pygame::corners([0.0, -RADIUS], [length * SCALE, RADIUS]).map(|corner| {
                let corner = pygame::rotate_rad(corner, angle);
                [corner[0] + x, corner[1] + y]
            });
            pygame::gfx_polygon(canvas, &link, Color::rgb(0, 204, 204));
            pygame::gfx_circle(canvas, [x, y], RADIUS, Color::rgb(204, 204, 0));
        }
        canvas.pop();
    }
}

impl Equations for AcrobotDynamics {
    type Numbers = [f64; 4];
    type Input = [f64; 1];
    type Constants = [f64; 0];

    #[inline(always)]
    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn numbers(&self, state: &State) -> [f64; 4] {
        [state.theta1, state.theta2, state.dtheta1, state.dtheta2]
    }

    #[inline(always)]
    fn state(&self, [theta1, theta2, dtheta1, dtheta2]: [f64; 4], fresh: bool) -> State {
        State { theta1, theta2, dtheta1, dtheta2, fresh }
    }

    /// The torque.
    #[inline(always)]
    fn input(&self, action: Action) -> [f64; 1] {
        [f64::from(action as i8 - 1)]
    }

    /// One step in time.
    #[inline(always)]
    fn advance<R: Real>(
        &self,
        []: [R; 0],
        state: [R; 4],
        _fresh: R::Mask,
        [torque]: [R; 1],
    ) -> Next<R, Self> {
        let [theta1, theta2, dtheta1, dtheta2] = rk4(state, torque);
        let (theta1, theta2) = (wrap(theta1), wrap(theta2));
        let dtheta1 = dtheta1.clamp(-MAX_VEL_1, MAX_VEL_1);
        let dtheta2 = dtheta2.clamp(-MAX_VEL_2, MAX_VEL_2);
        let state = [theta1, theta2, dtheta1, dtheta2];
        let seen = self.see(state);
        let [cos1, ..] = seen;
        let terminated = (-cos1 - (theta2 + theta1).cos()).gt(theta1.same(1.0));
        let reward = R::select(terminated, theta1.same(0.0), theta1.same(-1.0));
        Next { state, reward, terminated, seen }
    }

    #[inline(always)]
    fn see<R: Real>(&self, [theta1, theta2, dtheta1, dtheta2]: [R; 4]) -> [R; 6] {
        let ((sin1, cos1), (sin2, cos2)) = (theta1.sin_cos(), theta2.sin_cos());
        [cos1, sin1, cos2, sin2, dtheta1, dtheta2]
    }

    #[inline(always)]
    fn is_fresh(&self, state: &State) -> bool {
        state.fresh
    }

    /// The first state of an episode is of `float32`, and so is what numpy computes of it.
    fn see_otherwise(&self, state: &State) -> Option<[f32; 6]> {
        let State { theta1, theta2, dtheta1, dtheta2, fresh } = *state;
        let [(sin1, cos1), (sin2, cos2)] = [theta1, theta2].map(|theta| numpy_sin_cos_f32(theta as f32));
        fresh.then_some([cos1, sin1, cos2, sin2, dtheta1 as f32, dtheta2 as f32])
    }
}

/// The derivatives of both angles and both velocities.
#[inline(always)]
fn dsdt<R: Real>([theta1, theta2, dtheta1, dtheta2]: [R; 4], torque: R) -> [R; 4] {
    const M1: f64 = LINK_MASS_1;
    const M2: f64 = LINK_MASS_2;
    const L1: f64 = LINK_LENGTH_1;
    const LC1: f64 = LINK_COM_POS_1;
    const LC2: f64 = LINK_COM_POS_2;
    const I1: f64 = LINK_MOI;
    const I2: f64 = LINK_MOI;
    const G: f64 = GRAVITY;
    // squares of constants are exact either way; those of variables are `pow`, as in numpy
    let (sin2, cos2) = theta2.sin_cos();

    let d1 = (cos2 * (2.0 * L1 * LC2) + (L1 * L1 + LC2 * LC2)) * M2 + M1 * (LC1 * LC1) + I1 + I2;
    let d2 = (cos2 * (L1 * LC2) + LC2 * LC2) * M2 + I2;
    let phi2 = (theta1 + theta2 - PI / 2.0).cos() * (M2 * LC2 * G);
    let phi1 = dtheta2.square() * (-M2 * L1 * LC2) * sin2 - dtheta2 * (2.0 * M2 * L1 * LC2) * dtheta1 * sin2
        + (theta1 - PI / 2.0).cos() * ((M1 * LC1 + M2 * L1) * G)
        + phi2;
    let ddtheta2 = (torque + d2 / d1 * phi1 - dtheta1.square() * (M2 * L1 * LC2) * sin2 - phi2)
        / (-(d2.square() / d1) + (M2 * (LC2 * LC2) + I2));
    let ddtheta1 = -(d2 * ddtheta2 + phi1) / d1;
    [dtheta1, dtheta2, ddtheta1, ddtheta2]
}

/// `y + k * factor`.
#[inline(always)]
fn add<R: Real>([y1, y2, y3, y4]: [R; 4], [k1, k2, k3, k4]: [R; 4], factor: f64) -> [R; 4] {
    [y1 + k1 * factor, y2 + k2 * factor, y3 + k3 * factor, y4 + k4 * factor]
}

/// One step of the classical Runge-Kutta method.
#[inline(always)]
fn rk4<R: Real>(y0: [R; 4], torque: R) -> [R; 4] {
    let mut k = dsdt(y0, torque);
    let mut sum = k;
    // a loop, because a compiled copy of the derivatives for each of its rounds would be no faster
    for (step, weight) in [(DT / 2.0, 2.0), (DT / 2.0, 2.0), (DT, 1.0)] {
        k = dsdt(add(y0, k, step), torque);
        sum = add(sum, k, weight);
    }
    add(y0, sum, DT / 6.0)
}

/// An angle brought between ±π turn by turn, as Gymnasium does it, for the same rounding, unless this
/// would take forever.
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

/// The same where some angles are huge.
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
        .vector_entry_point(native::entry_point::<AcrobotDynamics>)
);
