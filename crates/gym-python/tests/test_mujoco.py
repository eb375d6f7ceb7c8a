"""Attributes of the MuJoCo tasks that `gymnasium.Env` does not have: ``data``, ``model``, ``set_state``."""

import copy
import pickle
import sys
import warnings

import gymnasium
import numpy as np
import pytest

import rustgym

TASKS = sorted(env_id for env_id in rustgym.ids() if env_id.endswith("-v5") and not env_id.startswith(("ALE/", "AntMaze")))


def made(env_id, **kwargs):
    return rustgym.make(env_id, disable_env_checker=True, **kwargs).unwrapped


@pytest.mark.parametrize("env_id", TASKS)
def test_every_task_can_be_read_without_mujoco(env_id, without_mujoco):
    env = made(env_id)
    env.reset(seed=1)
    env.step(env.action_space.sample())
    assert env.data.qpos.shape == env.init_qpos.shape and env.data.qvel.shape == env.init_qvel.shape
    assert np.array_equal(env.state_vector(), [*env.data.qpos, *env.data.qvel])
    assert env.dt == pytest.approx(1 / env.metadata["render_fps"], rel=0.01)
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="pip install mujoco"):
        _ = env.model


def test_structure_of_the_observation(without_mujoco):
    for env_id in TASKS:
        env = made(env_id)
        if hasattr(env, "observation_structure"):
            structure = env.observation_structure
            assert sum(structure.values()) - structure.get("skipped_qpos", 0) == env.observation_space.shape[0], env_id
    assert made("Hopper-v5").observation_structure == {"skipped_qpos": 1, "qpos": 5, "qvel": 6}
    assert not hasattr(made("Hopper-v4"), "observation_structure")


def test_a_state_is_set_before_and_after_a_reset(without_mujoco):
    env = made("InvertedPendulum-v5")
    env.set_state(np.array([0.1, 0.2]), np.array([0.3, 0.4]))
    assert env.state_vector().tolist() == [0.1, 0.2, 0.3, 0.4]
    assert env.get_body_com("cart")[0] == 0.1
    assert env.step([0.0])[0].shape == (4,)
    env.reset(seed=1)
    whole = env.get_state()
    seen = env.step([1.0])[0]
    env.set_state(whole)
    assert np.array_equal(env.step([1.0])[0], seen)


def test_what_is_no_state_changes_nothing(without_mujoco):
    env = made("Hopper-v5")
    env.reset(seed=1)
    before = env.state_vector()
    with pytest.raises(AssertionError, match="qpos"):
        env.set_state(np.zeros(5), np.zeros(6))
    with pytest.raises(ValueError, match="qvel"):
        env.set_state(np.zeros(6), np.full(6, np.nan))
    with pytest.raises(KeyError, match="no body 'wheel'"):
        env.get_body_com("wheel")
    assert np.array_equal(env.state_vector(), before)


@pytest.mark.parametrize("action", [[0.0, 0.0], 0.1, [[0.0, 0.0, 0.0]], np.zeros((3, 1))])
def test_an_action_of_another_shape(action):
    env = made("Hopper-v5")
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"Action dimension mismatch. Expected \(3,\), found"):
        env.step(action)


@pytest.mark.parametrize("env_id", [i for i in rustgym.ids() if i.partition("-v")[0] in {t.partition("-v")[0] for t in TASKS}])
def test_mujocos_own_objects_follow(env_id, monkeypatch, tmp_path):
    mujoco = pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)  # where MuJoCo logs its warnings
    env = made(env_id, mujoco=mujoco.__version__)
    env.reset(seed=3)
    for _ in range(5):
        env.step(env.action_space.sample())
    data = env.data
    assert isinstance(data, mujoco.MjData)
    own = env._arrays()
    for name, array in own.items():
        assert np.array_equal(getattr(data, name), array), name
    # MuJoCo computes the same arrays from the positions and velocities
    mujoco.mj_forward(env.model, data)
    env.set_state(np.array(data.qpos), np.array(data.qvel))
    for name in ("xpos", "xmat", "cvel", "qfrc_bias", "site_xpos", "subtree_com"):
        assert np.allclose(env._arrays()[name], getattr(data, name), rtol=1e-9, atol=1e-9), name
    for twin in (copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert np.array_equal(twin.data.qpos, env.data.qpos) and twin.data is not env.data


def test_data_of_our_own_is_live(without_mujoco):
    env, twin = made("Hopper-v5"), made("Hopper-v5")
    for e in (env, twin):
        e.reset(seed=1)
        e.step(np.zeros(3, np.float32))
    data = env.data
    assert env.data is data
    data.qpos[1] = 1.3
    data.qvel = data.qvel * 2.0
    twin.set_state(np.r_[twin.data.qpos[0], 1.3, twin.data.qpos[2:]], twin.data.qvel * 2.0)
    for action in np.random.default_rng(0).uniform(-1, 1, (5, 3)).astype(np.float32):
        env.step(action)
    assert data.time == pytest.approx(6 * env.dt) and data.qpos[1] != 1.3
    assert np.array_equal(data.qpos, env.state_vector()[:6])
    with pytest.raises(ValueError, match="read-only"):
        data.xpos[1] = 0.0
    with pytest.raises(AttributeError, match="xpos is read-only"):
        data.xpos = np.zeros((5, 3))
    with pytest.raises(AttributeError, match="without the package mujoco it has"):
        _ = data.xfrc_applied
    env.reset(seed=1)
    assert data.time == 0.0


@pytest.mark.parametrize(
    "way",
    [lambda env: env, copy.copy, copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))],
    ids=["itself", "copy", "deepcopy", "pickle"],
)
@pytest.mark.parametrize("name", ["time", "qpos", "qvel", "qacc_warmstart"])
def test_each_part_that_is_written_is_where_the_next_step_starts(name, way, without_mujoco):
    env, twin = made("Hopper-v5"), made("Hopper-v5")
    for e in (env, twin):
        e.reset(seed=1)
        e.step(np.ones(3, np.float32))
    assert env.get_state() == twin.get_state()
    written = getattr(env.data, name) + 0.25
    setattr(env.data, name, written)
    assert env.get_state() != twin.get_state()
    env = way(env)
    # what was written once is not written again
    for steps in (1, 2):
        env.step(np.ones(3, np.float32))
        twin.step(np.ones(3, np.float32))
        later = twin.data.time + 0.25 * (name == "time")
        assert env.data.time == pytest.approx(later, abs=1e-12), steps
    assert np.array_equal(env.data.qpos, twin.data.qpos) == (name == "time")


@pytest.mark.parametrize("limits", [(0.6, np.inf), (-np.inf, 0.6), [-np.inf, np.inf], np.array([0.6, np.inf])], ids=str)
def test_ranges_may_be_open(limits):
    env = made("Ant-v5", healthy_z_range=limits)
    assert tuple(env._healthy_z_range) == tuple(limits)
    env.reset(seed=1)
    low, high = limits
    for _ in range(40):
        observation, _, is_done, _, _ = env.step(np.full(8, 0.7))
        assert is_done == (not low <= observation[0] <= high)
        if is_done:
            break
    assert is_done == np.isfinite(limits).any()


def test_what_needs_the_package_says_so(without_mujoco):
    env = made("Hopper-v5")
    env.reset(seed=1)
    env.init_qpos[1] = 2.0
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="init_qpos was changed"):
        env.reset()
    env = made("HalfCheetah-v5")
    env._reset_noise_scale = 0.0
    assert np.array_equal(env.reset(seed=1)[0], np.zeros(17)) and env._reset_noise_scale == 0.0
    with pytest.raises(gymnasium.error.DependencyNotInstalled):
        env.do_simulation(np.zeros(6), 5)


@pytest.mark.parametrize("env_id", TASKS)
def test_the_version_of_mujoco_is_an_argument(env_id):
    def rewards(**kwargs):
        env = rustgym.make(env_id, **kwargs)
        env.action_space.seed(1)
        env.reset(seed=1)
        steps = [env.step(env.action_space.sample()) for _ in range(120)]
        return [(observation.tobytes(), reward) for observation, reward, *_ in steps]

    assert rewards() == rewards(mujoco="4.0") == rewards(mujoco="4.0.1")
    old = rewards(mujoco="3.12")
    assert old == rewards(mujoco="3.13.0")
    assert (old == rewards()) == (env_id in ("InvertedPendulum-v5", "Reacher-v5"))
    envs = rustgym.make_vec(env_id, 2, mujoco="3.12")
    assert envs.spec.kwargs["mujoco"] == "3.12"
    with pytest.raises(Exception, match="no MuJoCo version \"3.0\": the versions are"):
        rustgym.make(env_id, mujoco="3.0")


@pytest.mark.parametrize(("installed", "own", "hint"), [("3.12.0", "4.0", 'mujoco="3.12"'), ("3.9.0", "4.0", "does not repeat")])
def test_another_installed_version_is_told_once(installed, own, hint, monkeypatch):
    mujoco_envs = sys.modules["rustgym.envs.mujoco"]
    mujoco_envs.tell_other.cache_clear()
    monkeypatch.setattr(mujoco_envs, "_installed", lambda: installed)
    monkeypatch.setattr(gymnasium.logger, "min_level", gymnasium.logger.WARN)
    with pytest.warns(UserWarning, match=f"MuJoCo {own}.*mujoco {installed}: .*{hint}") as told:
        for _ in range(2):
            made("Hopper-v5", mujoco=own)
    assert len(told) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        monkeypatch.setattr(mujoco_envs, "_installed", lambda: "4.0.0")
        made("Hopper-v5")


@pytest.mark.parametrize("make", [rustgym.make, rustgym.make_vec])
@pytest.mark.parametrize("xml_file", ["/nowhere/robot.xml", "./nowhere.xml", "~/nowhere.xml", "nowhere.xml"])
def test_a_model_that_is_nowhere(make, xml_file):
    with pytest.raises(OSError, match="does not exist|no built-in model 'nowhere.xml'"):
        make("Hopper-v5", xml_file=xml_file)


@pytest.mark.parametrize("env_id", ["Ant-v5", "HalfCheetah-v5", "InvertedDoublePendulum-v5", "Hopper-v5"])
def test_a_start_without_noise_has_no_negative_zeros(env_id: str) -> None:
    env = rustgym.make(env_id, reset_noise_scale=0.0).unwrapped
    env.reset(seed=3)
    numbers = env.state_vector()
    assert not np.signbit(numbers[numbers == 0.0]).any()
