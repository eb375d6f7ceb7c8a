//! The environments keep the rules of gym-conform.

use gym_render as _; // draws, so that the render modes are checked as well

gym_conform::suite!(plugin_name);
