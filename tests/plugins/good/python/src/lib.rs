//! Links the environments into Python's module.

use gym_python as _;
use sutton_envs as _;
