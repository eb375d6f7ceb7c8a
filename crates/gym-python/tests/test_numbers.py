"""The numbers in rewards, infos and tables have the same types as Gymnasium's."""

from __future__ import annotations

import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest

import rustgym

PLAIN = ["CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Acrobot-v1", "Pendulum-v1"]
TEXT = ["FrozenLake-v1", "Taxi-v4", "CliffWalking-v1", "Blackjack-v1"]
BOX2D = ["LunarLander-v3", "LunarLanderContinuous-v3", "BipedalWalker-v3"]
MUJOCO = [
    *("HalfCheetah-v5", "Hopper-v5", "Walker2d-v5", "Ant-v5", "Humanoid-v5", "HumanoidStandup-v5", "Swimmer-v5"),
    *("Reacher-v5", "Pusher-v5", "InvertedPendulum-v5", "InvertedDoublePendulum-v5"),
    *("HalfCheetah-v4", "Ant-v4", "Humanoid-v4", "InvertedPendulum-v4"),
]


def kinds(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: kinds(part) for key, part in value.items()}
    if isinstance(value, np.ndarray):
        return "array", str(value.dtype), value.shape
    return type(value)


def seen(module: Any, env_id: str, dtype: type, **arguments: Any) -> list[Any]:
    """The types of the results of each step, until the episode ends or the number of steps is reached."""
    env = module.make(env_id, disable_env_checker=True, **arguments).unwrapped
    rng = np.random.default_rng(0)
    _, info = env.reset(seed=1)
    found = [kinds(info)]
    for _ in range(150):
        space = env.action_space
        action = int(rng.integers(space.n)) if hasattr(space, "n") else rng.uniform(space.low, space.high).astype(dtype)
        _, reward, terminated, _, info = env.step(action)
        found.append((type(reward), terminated, kinds(info)))
        if terminated:
            break
    return found


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("env_id", [*PLAIN, *TEXT, *BOX2D, *MUJOCO])
def test_types_are_gymnasiums(env_id: str, dtype: type) -> None:
    if env_id in BOX2D:
        pytest.importorskip("Box2D")
    arguments = {}
    if env_id in MUJOCO:
        mujoco: Any = pytest.importorskip("mujoco")
        arguments["mujoco"] = ".".join(mujoco.__version__.split(".")[:2])
    ours, theirs = seen(rustgym, env_id, dtype, **arguments), seen(gymnasium, env_id, dtype)
    assert ours == theirs and len(ours) > (1 if env_id in TEXT else 5)


@pytest.mark.parametrize("env_id", ["FrozenLake-v1", "Taxi-v4", "CliffWalking-v1"])
def test_rewards_of_tables(env_id: str) -> None:
    ours, theirs = (module.make(env_id).unwrapped.P for module in (rustgym, gymnasium))
    for state, actions in theirs.items():
        for action, outcomes in actions.items():
            assert repr(ours[state][action]) == repr([(float(p), s, r, bool(t)) for p, s, r, t in outcomes])


@pytest.mark.parametrize(("rewards", "kind"), [((2, -1, 0), int), ((2.0, -1.0, 0.0), float), ((0.5, 0, 0), float)])
def test_rewards_that_were_given(rewards: tuple[float, ...], kind: type) -> None:
    env = rustgym.make("FrozenLake-v1", is_slippery=False, reward_schedule=rewards).unwrapped
    for env in (env, pickle.loads(pickle.dumps(env))):
        env.reset(seed=0)
        assert [type(env.step(action)[1]) for action in (1, 1, 2)] == [kind] * 3
        assert type(env.P[0][0][0][2]) is kind


def test_columns_of_a_vector() -> None:
    envs = rustgym.make_vec("HalfCheetah-v5", num_envs=2)
    envs.reset(seed=0)
    for dtype in (np.float32, np.float64):
        infos = envs.step(np.ones((2, 6), dtype))[4]
        assert infos["reward_ctrl"].dtype == dtype and infos["x_velocity"].dtype == np.float64
    envs = rustgym.make_vec("InvertedPendulum-v5", num_envs=2)
    envs.reset(seed=0)
    assert envs.step(np.zeros((2, 1), np.float32))[4]["reward_survive"].dtype == np.int64


@pytest.mark.parametrize(
    ("env_id", "name"),
    [
        ("Ant-v5", "_forward_reward_weight"),
        ("Reacher-v5", "_reward_dist_weight"),
        ("MountainCar-v0", "goal_velocity"),
        ("Pendulum-v1", "max_speed"),
        ("Acrobot-v1", "AVAIL_TORQUE"),
    ],
)
def test_arguments_that_are_whole(env_id: str, name: str) -> None:
    if env_id in MUJOCO:
        pytest.importorskip("mujoco")
    ours, theirs = (getattr(module.make(env_id).unwrapped, name) for module in (rustgym, gymnasium))
    assert repr(ours) == repr(theirs)


@pytest.mark.parametrize("rewards", [(1, 0, 0), (1.0, 0.0, -1.0), (2.0, -1.0, 0.5), (0, 0, 0)])
def test_rewards_of_a_table_have_gymnasiums_types(rewards: tuple[float, ...]) -> None:
    ours, theirs = (make("FrozenLake-v1", reward_schedule=rewards).unwrapped for make in (rustgym.make, gymnasium.make))
    for state in (0, 4, 14):  # (a hole leads to itself for Gymnasium's own 0)
        assert repr(ours.P[state]) == repr(theirs.P[state])
