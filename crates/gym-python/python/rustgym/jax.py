"""Steps of a vector inside functions that JAX compiles.

    import jax, jax.numpy as jnp
    import rustgym
    from rustgym.jax import Stepper

    stepper = Stepper(rustgym.VectorEnv("CartPole-v1", 8))
    carry, observations = stepper.reset(seed=0)

    @jax.jit
    def play(carry, observations):
        def step(state, _):
            carry, observations = state
            actions = jnp.where(observations[:, 2] > 0, 1, 0)
            carry, result = stepper.step(carry, actions)
            return (carry, result.observations), result.rewards
        return jax.lax.scan(step, (carry, observations), None, length=100)

Needs jax, which nothing else in rustgym does.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from rustgym.vector_env import VectorEnv

__all__ = ["Result", "Stepper"]


class Result(NamedTuple):
    """The arrays of a step; each has a row for each environment. (Infos are not included: see ``Stepper.infos``.)"""

    observations: Any
    rewards: Any
    terminated: Any
    truncated: Any


class Stepper:
    """A vector whose steps can be part of a compiled function.

    ``step`` calls the vector by ``jax.pure_callback``. The ``carry``, the number of the step, makes it a pure function: each
    call takes the carry of the call before and returns the next one. So JAX keeps the order of calls, and repeating a call
    returns the same result without another step.

    Args:
        envs: The vector. Its observations are arrays, or dicts and tuples of arrays; they and the rewards have JAX's
            precision: 32 bits, unless ``jax_enable_x64`` is set.
    """

    def __init__(self, envs: VectorEnv) -> None:
        self.envs = envs
        #: The infos of the last reset or step.
        self.infos: dict[str, Any] = {}
        self._number = -1
        self._last: tuple[int, bytes, Result] | None = None

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, Any]:
        """Starts episodes; call it outside compiled functions. Returns the carry of the first step, and the observations."""
        observations, self.infos = self.envs.reset(seed=seed, options=options)
        self._number, self._last = 0, None
        return jnp.int32(0), jax.tree.map(jnp.asarray, observations)

    def step(self, carry: Any, actions: Any) -> tuple[Any, Result]:
        """Takes a step. It can be called inside compiled functions, scans and loops."""
        return jax.pure_callback(self._call, self._shapes(), carry, actions, vmap_method="sequential")

    def _shapes(self) -> tuple[Any, Result]:
        def shape(space: Any) -> Any:
            if hasattr(space, "spaces"):
                spaces = space.spaces
                if isinstance(spaces, dict):
                    return {key: shape(member) for key, member in spaces.items()}
                return tuple(map(shape, spaces))
            return jax.ShapeDtypeStruct(space.shape, jax.dtypes.canonicalize_dtype(space.dtype))

        n = (self.envs.num_envs,)
        number = jax.dtypes.canonicalize_dtype(np.float64)
        flags = jax.ShapeDtypeStruct(n, np.bool_)
        result = Result(shape(self.envs.observation_space), jax.ShapeDtypeStruct(n, number), flags, flags)
        return jax.ShapeDtypeStruct((), np.int32), result

    def _call(self, carry: Any, actions: Any) -> tuple[Any, Result]:
        number, actions = int(carry), np.asarray(actions)
        key = actions.tobytes()
        if self._last is not None and self._last[:2] == (number, key):
            return np.int32(number + 1), self._last[2]
        if number != self._number:
            raise ValueError(f"this is step {self._number}, and the carry is of step {number}: pass on the carry of the last call")
        *arrays, self.infos = self.envs.step(actions)
        result = jax.tree.map(lambda array, to: np.asarray(array, to.dtype), Result(*arrays), self._shapes()[1])
        self._number, self._last = number + 1, (number, key, result)
        return np.int32(number + 1), result
