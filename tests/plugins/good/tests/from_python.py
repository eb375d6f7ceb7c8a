"""The environments of this crate from Python, in the package that `cargo xtask python` makes."""

import warnings

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

import rustgym

KINGS = "sutton/WindyGridworldKings-v0"


def test_an_environment_of_a_plugin_is_made_as_ours() -> None:
    env = rustgym.make("sutton/WindyGridworld-v0", king=True, stochastic=True)
    kings = rustgym.make(KINGS)
    assert env.action_space == kings.action_space == gymnasium.spaces.Discrete(8)
    assert env.reset(seed=3)[0] == kings.reset(seed=3)[0]
    for action in range(8):
        assert env.step(action)[:4] == kings.step(action)[:4]


def test_it_passes_gymnasiums_checks() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(rustgym.make(KINGS).unwrapped, skip_render_check=True)


def test_its_vector_equals_its_environments() -> None:
    envs = rustgym.make_vec(KINGS, 3)
    observations, _ = envs.reset(seed=5)
    singles = [rustgym.make(KINGS) for _ in range(3)]
    assert observations.tolist() == [env.reset(seed=5 + i)[0] for i, env in enumerate(singles)]
    actions = np.array([0, 3, 6])
    assert envs.step(actions)[0].tolist() == [env.step(action)[0] for env, action in zip(singles, actions)]


def test_its_arguments_are_documented() -> None:
    text = type(rustgym.make("sutton/WindyGridworld-v0").unwrapped).__doc__ or ""
    assert "Whether the agent moves along diagonals as well." in text
    assert "CartPole-v1" in rustgym.ids() and KINGS in rustgym.ids()
