//! Links the environments of `sutton-envs` into the Python module.

use gym_python as _;
use sutton_envs as _;
