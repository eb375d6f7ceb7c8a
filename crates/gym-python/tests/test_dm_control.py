"""Attributes of the Control Suite's tasks: ``data``, ``model``, ``set_state``, ``dt``."""

import copy
import pickle
from functools import partial

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym

TASKS = ["dm_control/cartpole-swingup-v0", "dm_control/swimmer-swimmer6-v0", "dm_control/walker-walk-v0"]


def made(env_id, **kwargs):
    return rustgym.make(env_id, disable_env_checker=True, **kwargs).unwrapped


@pytest.mark.parametrize("env_id", TASKS)
def test_data_is_read_and_written_without_mujoco(env_id, without_mujoco):
    env, twin = made(env_id), made(env_id)
    for e in (env, twin):
        e.reset(seed=1)
    data = env.data
    assert data.qpos.shape == env.init_qpos.shape and data.qvel.shape == env.init_qvel.shape
    assert env.dt == pytest.approx(1 / env.metadata["render_fps"], rel=0.02)
    action = np.zeros(env.action_space.shape)
    for e in (env, twin):
        e.step(action)
    assert np.array_equal(data.qpos, twin.data.qpos) and data.time == twin.data.time > 0.0
    data.qpos[0] += 0.25
    for e in (env, twin):
        e.step(action)
    assert data.qpos[0] > twin.data.qpos[0] + 0.1
    with pytest.raises(ValueError, match="read-only"):
        data.xpos[1] = 0.0
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="pip install mujoco"):
        _ = env.model


@pytest.mark.parametrize("env_id", TASKS)
def test_mujocos_own_objects_follow(env_id, monkeypatch, tmp_path):
    mujoco = pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)  # where MuJoCo logs its warnings
    env = made(env_id, mujoco="3.12")
    env.reset(seed=3)
    data = env.data
    assert isinstance(data, mujoco.MjData) and isinstance(env.model, mujoco.MjModel)
    for _ in range(5):
        env.step(env.action_space.sample())
    own = env._arrays()
    for name in ("qpos", "qvel", "xpos", "xmat", "geom_xpos", "site_xpos", "cvel", "qfrc_bias"):
        assert np.allclose(getattr(data, name), own[name], rtol=1e-9, atol=1e-9), name
    for twin in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert np.array_equal(twin.data.qpos, data.qpos) and twin.data is not data
    env.set_state(np.array(data.qpos), np.zeros(env.model.nv))
    assert not data.qvel.any()
    env.model.body_mass[1] *= 2.0
    with pytest.raises(gymnasium.error.Error, match="cannot take over"):
        env.step(env.action_space.sample())


@pytest.mark.parametrize("env_id", ["dm_control/lqr-lqr_2_1-v0", *TASKS])
def test_a_vector_takes_a_limit_of_steps(env_id):
    # (the tasks of lqr have no limit of their own)
    envs = rustgym.VectorEnv(env_id, 2, max_episode_steps=3)
    envs.reset(seed=1)
    ends = [envs.step(np.zeros(envs.action_space.shape))[3].all() for _ in range(3)]
    assert ends == [False, False, True]


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
@pytest.mark.parametrize("limit", [None, 4])
def test_time_steps_of_vectors_are_those_of_environments(mode, limit):
    env_id, given = "dm_control/point_mass-easy-v0", {"time_limit": 0.12}  # six steps

    def use(envs):
        results = [envs.reset(seed=[5, 6, 7])[1]]
        for k in range(24):
            *_, ended, cut, infos = envs.step(np.full((3, 2), 0.1))
            results.append((ended, cut, infos))
            if mode == "Disabled" and (ended | cut).any():
                results.append(envs.reset(options={"reset_mask": ended | cut})[1])
            if k in (2, 9):  # from here on, episodes end one after the other; first the first one, then the last
                results.append(envs.reset(seed=9, options={"reset_mask": np.arange(3) == (0 if k == 2 else 2)})[1])
        return results

    one = partial(rustgym.make, env_id, max_episode_steps=limit, disable_env_checker=True, **given)
    expected = use(gymnasium.vector.SyncVectorEnv([one] * 3, autoreset_mode=gymnasium.vector.AutoresetMode(mode)))
    for kind in ("sync", "native", "async"):
        assert_same(use(rustgym.VectorEnv(env_id, 3, kind=kind, autoreset_mode=mode, max_episode_steps=limit, **given)), expected, kind)
