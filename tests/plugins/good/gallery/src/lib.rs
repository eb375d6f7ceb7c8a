//! The gallery of these environments.

use gym_web as _;
use sutton_envs as _;
