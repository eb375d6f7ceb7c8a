//! The environments keep the rules that agents and wrappers rely on.

use gym_render as _; // draws, so that the render modes are checked as well

gym_conform::suite!(sutton_envs);
