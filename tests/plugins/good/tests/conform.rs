//! The environments keep the rules of gym-conform.

use gym_render as _; // draws, so that the render modes are checked, too

gym_conform::suite!(sutton_envs);
