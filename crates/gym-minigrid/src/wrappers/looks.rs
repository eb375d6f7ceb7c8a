//! Wrappers that observe the world in another form.

use std::f64::consts::{FRAC_PI_2, PI};

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{BoxSpace, array_of};
use gym_core::{
    Argument, ArgumentType, Arguments, Array, BoxEnv, DType, Data, Env, EnvExt, Error, Outcome,
    Reset, Result, Space, Value, WrapperSpec, math,
};
use serde::{Deserialize, Serialize};

use super::maps::{copy_others, with_member};
use crate::picture::Picture;
use crate::{Facts, Grid, Kind, Pos, World};

/// A way to observe the world: the arguments of a wrapper.
pub trait Look: WrapperConfig + Clone + std::fmt::Debug + Send + 'static {
    /// The key under which the wrapper writes into the observation.
    const KEY: &'static str = "image";

    /// The space of the member with the key [`KEY`](Self::KEY).
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn space(&self, facts: &Facts) -> Result<Space>;

    /// The settings of the member's picture; `None` if the member is not a picture.
    fn pictured(&self, facts: &Facts) -> Option<Facts> {
        let _ = facts;
        None
    }

    /// Writes the member `out`. If `out` is a picture, the picture is already painted.
    ///
    /// # Errors
    /// [`Error::Custom`] if the world lacks the object that the wrapper looks for.
    fn look(&self, world: &World, facts: &Facts, out: &mut Value) -> Result<()>;
}

/// Replaces or adds a member of each observation.
#[derive(Clone, Debug)]
pub struct Looking<C, E = BoxEnv> {
    env: E,
    config: C,
    facts: Facts,
    space: Space,
    shape: Vec<usize>,
    picture: Option<(std::sync::Arc<Picture>, Facts)>,
    seen: Value,
}

impl<C: Look, E: Env<Observation = Value>> Looking<C, E> {
    /// Wraps `env`, an environment of this crate.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for another environment, and an argument out of range.
    pub fn new(env: E, config: C) -> Result<Self> {
        let Some(facts) = env.layer::<Facts>().cloned() else {
            return Err(C::refuse(format!(
                "it needs an environment of MiniGrid, and this is {}",
                env.describe()
            )));
        };
        let inner = env.observation_space();
        let Space::Dict(dict) = &inner else {
            return Err(C::refuse(format!(
                "it needs a dict of observations, and the space is {inner}"
            )));
        };
        let member = config.space(&facts)?;
        let shape = member.shape().unwrap_or_default().to_vec();
        let picture = match config.pictured(&facts) {
            Some(facts) => {
                let picture = Picture::new(&facts).map_err(C::refuse)?;
                Some((picture.into(), facts))
            }
            None => None,
        };
        Ok(Self {
            space: with_member(dict, C::KEY, member)?,
            env,
            config,
            facts,
            shape,
            picture,
            seen: Value::Null,
        })
    }

    fn observe(&self, observation: &mut Value) -> Result<()> {
        let Some(world) = self.env.layer::<World>() else {
            return Err(Error::ResetNeeded("step"));
        };
        let out = copy_others(&self.space, &self.seen, C::KEY, observation)?;
        if let Some((picture, facts)) = &self.picture {
            let pixels = array_of(out, DType::U8, &self.shape);
            picture.paint(world, facts, pixels.as_mut_slice().unwrap_or_default());
        }
        self.config.look(world, &self.facts, out)
    }
}

impl<C: Look, E: Env<Observation = Value>> gym_core::Wrapper for Looking<C, E> {
    type Inner = E;
    type Observation = Value;
    type Action = E::Action;

    fn inner(&self) -> &E {
        &self.env
    }

    fn inner_mut(&mut self) -> &mut E {
        &mut self.env
    }

    fn on_observation_space(&self) -> Space {
        self.space.clone()
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.env.reset_into(reset, &mut self.seen)?;
        self.observe(observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let outcome = self.env.step_into(action, &mut self.seen)?;
        self.observe(observation)?;
        Ok(outcome)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }

    fn name(&self) -> &'static str {
        C::NAME
    }
}

/// Returns the space of byte arrays with the shape `shape`.
fn bytes(shape: [u32; 3]) -> Result<Space> {
    BoxSpace::uniform(0.0, 255.0, shape.map(|n| n as usize), DType::U8).map(Space::from)
}

gym_core::arguments! {
    /// Observes every cell of the grid, with the agent. No arguments.
    pub struct FullyObs {}
}

impl Look for FullyObs {
    fn space(&self, facts: &Facts) -> Result<Space> {
        bytes([facts.rules.width, facts.rules.height, 3])
    }

    fn look(&self, world: &World, _: &Facts, out: &mut Value) -> Result<()> {
        let shape = [world.grid.width() as usize, world.grid.height() as usize, 3];
        let cells = array_of(out, DType::U8, &shape)
            .as_mut_slice::<u8>()
            .unwrap_or_default();
        for (out, (pos, cell)) in cells.chunks_exact_mut(3).zip(world.grid.by_column()) {
            let agent = [Kind::Agent as u8, 0, world.direction];
            out.copy_from_slice(&if pos == world.agent {
                agent
            } else {
                cell.encode()
            });
        }
        Ok(())
    }
}

gym_core::register_wrapper!(
    "FullyObsWrapper", "observes every cell of the grid", FullyObs, env: Looking::<FullyObs>::new
);

gym_core::arguments! {
    /// Observes column, row and kind of every cell, -1 for an empty one. No arguments.
    pub struct SymbolicObs {}
}

impl Look for SymbolicObs {
    fn space(&self, facts: &Facts) -> Result<Space> {
        let (width, height) = (facts.rules.width as usize, facts.rules.height as usize);
        let bound =
            |one: [i64; 3]| Array::new([width, height, 3], Data::I64(one.repeat(width * height)));
        let high = [width as i64 - 1, height as i64 - 1, Kind::Agent as i64];
        BoxSpace::new(bound([0, 0, -1])?, bound(high)?).map(Space::from)
    }

    fn look(&self, world: &World, _: &Facts, out: &mut Value) -> Result<()> {
        let shape = [world.grid.width() as usize, world.grid.height() as usize, 3];
        let cells = array_of(out, DType::I64, &shape)
            .as_mut_slice::<i64>()
            .unwrap_or_default();
        for (out, (pos, cell)) in cells.chunks_exact_mut(3).zip(world.grid.by_column()) {
            let kind = match cell.kind() {
                _ if pos == world.agent => Kind::Agent as i64,
                Kind::Empty => -1,
                kind => kind as i64,
            };
            out.copy_from_slice(&[pos.x.into(), pos.y.into(), kind]);
        }
        Ok(())
    }
}

gym_core::register_wrapper!(
    "SymbolicObsWrapper", "observes place and kind of every cell", SymbolicObs, env: Looking::<SymbolicObs>::new
);

gym_core::arguments! {
    /// Observes a square of cells of another width.
    pub struct ViewSize {
        /// The width of the square: an odd number.
        pub agent_view_size: u32 = 7,
    }
}

impl Look for ViewSize {
    fn space(&self, _: &Facts) -> Result<Space> {
        let size = self.agent_view_size;
        if size.is_multiple_of(2) || !(3..=crate::view::MAX_VIEW).contains(&size) {
            let most = crate::view::MAX_VIEW;
            return Err(Self::refuse(format!(
                "agent_view_size is {size}: it is an odd number from 3 to {most}"
            )));
        }
        bytes([size, size, 3])
    }

    fn look(&self, world: &World, facts: &Facts, out: &mut Value) -> Result<()> {
        facts.look(world, self.agent_view_size, out);
        Ok(())
    }
}

gym_core::register_wrapper!(
    "ViewSizeWrapper", "observes a square of cells of another width", ViewSize, env: Looking::<ViewSize>::new
);

gym_core::arguments! {
    /// Observes a picture of the grid.
    pub struct RgbImgObs {
        /// The width of a cell.
        #[unit = "px"]
        pub tile_size: u32 = 8,
    }
}

impl Look for RgbImgObs {
    fn space(&self, facts: &Facts) -> Result<Space> {
        picture_space::<Self>(&with_tiles(facts, self.tile_size, false))
    }

    fn pictured(&self, facts: &Facts) -> Option<Facts> {
        Some(with_tiles(facts, self.tile_size, false))
    }

    fn look(&self, _: &World, _: &Facts, _: &mut Value) -> Result<()> {
        Ok(())
    }
}

gym_core::register_wrapper!(
    "RGBImgObsWrapper", "observes a picture of the grid", RgbImgObs, env: Looking::<RgbImgObs>::new
);

gym_core::arguments! {
    /// Observes a picture of what the agent sees.
    pub struct RgbImgPartialObs {
        /// The width of a cell.
        #[unit = "px"]
        pub tile_size: u32 = 8,
    }
}

impl Look for RgbImgPartialObs {
    fn space(&self, facts: &Facts) -> Result<Space> {
        picture_space::<Self>(&with_tiles(facts, self.tile_size, true))
    }

    fn pictured(&self, facts: &Facts) -> Option<Facts> {
        Some(with_tiles(facts, self.tile_size, true))
    }

    fn look(&self, _: &World, _: &Facts, _: &mut Value) -> Result<()> {
        Ok(())
    }
}

gym_core::register_wrapper!(
    "RGBImgPartialObsWrapper", "observes a picture of what the agent sees", RgbImgPartialObs, env: Looking::<RgbImgPartialObs>::new
);

/// Returns the settings of an image with cells of `tile_size` pixels. The image shows the agent's
/// view if `agent_pov`, else the whole grid.
fn with_tiles(facts: &Facts, tile_size: u32, agent_pov: bool) -> Facts {
    let mut facts = facts.clone();
    facts.view.tile_size = tile_size;
    facts.view.agent_pov = agent_pov;
    facts
}

/// Returns the space of images with the settings `facts`.
fn picture_space<C: Look>(facts: &Facts) -> Result<Space> {
    let (width, height) = Picture::new(facts).map_err(C::refuse)?.size();
    bytes([height, width, 3])
}

/// How the direction of the goal is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// The slope: rows divided by columns.
    #[default]
    Slope,
    /// The arc tangent of the slope.
    Angle,
    /// `atan2(rows, columns)`, with the bits of the C library; numpy's last bit may differ on CPUs
    /// with AVX-512.
    AngleAtan2,
}

impl ArgumentType for Measure {
    fn kind() -> String {
        "`slope`, `angle` or `angle_atan2`".to_owned()
    }
}

/// Observes the direction of the goal as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DirectionObs {
    /// How the direction is measured.
    #[serde(rename = "type")]
    pub measure: Measure,
}

impl Arguments for DirectionObs {
    fn table() -> Vec<Argument> {
        vec![Argument::new::<Measure>(
            "type",
            "",
            "How the direction is measured.",
        )]
    }

    fn set_number(&mut self, _name: &str, _x: f64) -> bool {
        false
    }
}

impl Look for DirectionObs {
    const KEY: &'static str = "goal_direction";

    fn space(&self, _: &Facts) -> Result<Space> {
        let bound = match self.measure {
            Measure::Slope => f64::INFINITY,
            Measure::Angle => FRAC_PI_2,
            Measure::AngleAtan2 => PI,
        };
        BoxSpace::uniform(-bound, bound, [0_usize; 0], DType::F64).map(Space::from)
    }

    fn look(&self, world: &World, _: &Facts, out: &mut Value) -> Result<()> {
        let goal = goal(&world.grid)
            .ok_or_else(|| Error::custom("DirectionObsWrapper needs a grid with a goal"))?;
        let Pos { x, y } = goal - world.agent;
        let (x, y) = (f64::from(x), f64::from(y));
        let direction = match self.measure {
            _ if x == 0.0 && y == 0.0 => 0.0,
            Measure::AngleAtan2 => math::atan2(y, x),
            _ if x == 0.0 => f64::INFINITY.copysign(y),
            _ => y / x,
        };
        let direction = if self.measure == Measure::Angle {
            math::atan2(direction, 1.0)
        } else {
            direction
        };
        if let Some([number]) = array_of(out, DType::F64, &[]).as_mut_slice() {
            *number = direction;
        }
        Ok(())
    }
}

/// Returns the position of the first goal, row by row.
fn goal(grid: &Grid) -> Option<Pos> {
    let index = grid.cells().iter().position(|cell| cell.is(Kind::Goal))? as i32;
    Some(Pos::new(index % grid.width(), index / grid.width()))
}

gym_core::register_wrapper!(
    "DirectionObsWrapper", "observes the direction of the goal as well", DirectionObs, env: Looking::<DirectionObs>::new
);
