"""MuJoCo's model and data follow our engine, and changes to them have the same effect as in Gymnasium."""

from __future__ import annotations

import copy
import json
import pickle
import sys
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same, go_on

import rustgym

mujoco: Any = pytest.importorskip("mujoco")
VERSION = ".".join(mujoco.__version__.split(".")[:2])
TASKS = ["Ant-v5", "HalfCheetah-v4", "HalfCheetah-v5", "Hopper-v5", "Humanoid-v5", "InvertedDoublePendulum-v5", "Reacher-v5"]
TASKS += ["Swimmer-v4", "Walker2d-v5"]


def ours(env_id: str, **kwargs: Any) -> Any:
    """Our environment, with the numbers of the installed version of MuJoCo."""
    if "mujoco" in rustgym._specs.spec_of(env_id)["defaults"]:
        kwargs["mujoco"] = VERSION
    return rustgym.make(env_id, disable_env_checker=True, **kwargs).unwrapped


def theirs(env_id: str, **kwargs: Any) -> Any:
    return gymnasium.make(env_id, disable_env_checker=True, **kwargs).unwrapped


def actions_of(env: Any, n: int) -> list[Any]:
    rng = np.random.default_rng(4)
    return [rng.uniform(-1, 1, env.action_space.shape).astype(np.float32) for _ in range(n)]


# arrays in MuJoCo's arena that these models never write, and that therefore contain old memory
UNUSED = ("efc_AR", "efc_Y", "efc_J_", "efm_", "map_", "dof_island", "tree_island", "island_", "iefc_", "ifrc_", "iacc", "solver_nnz")


def differing(a: Any, b: Any) -> list[str]:
    """The names of the arrays in which two `MjData` differ."""
    found = []
    for name in dir(a):
        if name.startswith(("_", *UNUSED)) or name in ("signature", "timer", "solver", "warning"):
            continue
        if isinstance(array := getattr(a, name), np.ndarray):
            other = getattr(b, name)
            if array.shape != other.shape or not np.array_equal(array, other, equal_nan=array.dtype.kind == "f"):
                found.append(name)
    if a.time != b.time or a.ncon != b.ncon:
        found.append("time or ncon")
    return found


@pytest.mark.parametrize("env_id", TASKS)
def test_the_data_is_gymnasiums(env_id: str) -> None:
    env, other = ours(env_id), theirs(env_id)
    data = env.data
    for e in (env, other):
        e.reset(seed=2)
    assert not differing(data, other.data)
    for action in actions_of(env, 40):
        assert_same(env.step(action)[0], other.step(action)[0])
        assert not differing(data, other.data)
    assert not env._is_handed and env.data is data
    for e in (env, other):
        e.reset()
    assert not differing(data, other.data)
    # now MuJoCo's objects are first read in the middle of an episode
    env, other = ours(env_id), theirs(env_id)
    for e in (env, other):
        e.reset(seed=2)
        for action in actions_of(env, 5):
            e.step(action)
    assert not differing(env.data, other.data)
    assert [contact.geom.tolist() for contact in env.data.contact] == [contact.geom.tolist() for contact in other.data.contact]


def put(path: str, index: Any, value: Any) -> Callable[[Any], None]:
    def change(env: Any) -> None:
        for name in path.split("."):
            env = getattr(env, name)
        env[index] = value

    return change


CHANGES: dict[str, tuple[str, Callable[[Any], None], bool]] = {
    "gravity": ("HalfCheetah-v5", put("model.opt.gravity", 2, -3.7), True),
    "timestep": ("HalfCheetah-v5", lambda env: setattr(env.model.opt, "timestep", 0.002), True),
    "masses": ("Ant-v5", lambda env: env.model.body_mass.__imul__(1.5), True),
    "one mass by name": ("Hopper-v5", lambda env: setattr(env.model.body("foot"), "mass", 9.0), True),
    "friction": ("Walker2d-v5", put("model.geom_friction", (slice(None), 0), 0.2), True),
    "push": ("Hopper-v5", put("data.xfrc_applied", (1, 0), 40.0), True),
    "torque": ("Hopper-v5", put("data.qfrc_applied", 3, 4.0), True),
    "position": ("HalfCheetah-v5", put("data.qpos", 2, 0.5), False),
    "velocity": ("Humanoid-v5", put("data.qvel", slice(6, None), 0.25), False),
    "time": ("Ant-v5", lambda env: setattr(env.data, "time", 7.0), False),
    "warm start": ("Ant-v5", put("data.qacc_warmstart", slice(None), 0.0), False),
    "state": ("Ant-v5", lambda env: env.set_state(env.init_qpos + 0.01, env.init_qvel), False),
    "start": ("Hopper-v5", put("init_qpos", 1, 1.4), True),
    "starts": ("Swimmer-v5", lambda env: setattr(env, "init_qvel", np.full(5, 0.1)), True),
    "noise": ("HalfCheetah-v5", lambda env: setattr(env, "_reset_noise_scale", 0.0), False),
    "weight": ("HalfCheetah-v5", lambda env: setattr(env, "_forward_reward_weight", 3.0), False),
    "range": ("Hopper-v5", lambda env: setattr(env, "_healthy_z_range", (1.3, np.inf)), False),
    "termination": ("Walker2d-v5", lambda env: setattr(env, "_terminate_when_unhealthy", False), False),
    "frames": ("HalfCheetah-v5", lambda env: setattr(env, "frame_skip", 3), False),
    "frames of version 4": ("Ant-v4", lambda env: setattr(env, "frame_skip", 3), True),
    "method": ("Ant-v5", lambda env: setattr(env, "_get_rew", lambda velocity, action: (velocity, {})), True),
}


@pytest.mark.parametrize("way", ["itself", "copy", "deepcopy", "pickle", "state"])
@pytest.mark.parametrize("name", CHANGES)
def test_changes_count(name: str, way: str) -> None:
    env_id, change, hands_over = CHANGES[name]
    if name == "method" and way in ("pickle", "state") or (way == "state" and not hands_over and name not in ("position", "velocity")):
        pytest.skip("it is no part of it")
    env, other = ours(env_id), theirs(env_id)
    for e in (env, other):
        e.reset(seed=2)
        e.step(actions_of(e, 1)[0])
        change(e)
    if way == "state":
        state, env = env.get_state(), ours(env_id)
        if name in ("start", "starts", "frames of version 4"):
            change(env)
        env.set_state(state)
    elif way != "itself":
        env = {"copy": copy.copy, "deepcopy": copy.deepcopy, "pickle": lambda env: pickle.loads(pickle.dumps(env))}[way](env)
    for action in actions_of(env, 6):
        assert_same(env.step(action)[:4], other.step(action)[:4])
    assert env._is_handed == hands_over
    if way != "state":
        assert_same(env.reset()[0], other.reset()[0])
        assert_same(env.step(action)[:4], other.step(action)[:4])
        assert not differing(env.data, other.data)
    assert env.dt == other.dt


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_has_a_model_and_data_of_its_own(way: Callable[[Any], Any]) -> None:
    env = ours("Hopper-v5")
    env.reset(seed=2)
    env.model.opt.gravity[2] = -5.0
    action = actions_of(env, 1)[0]
    env.step(action)
    twin, other = way(env), way(env)
    twin.model.body_mass[1] *= 4.0
    twin.data.qpos[0] += 1.0
    assert env.model.body_mass[1] * 4.0 == twin.model.body_mass[1] and env.data.qpos[0] + 1.0 == twin.data.qpos[0]
    results = env.step(action)
    assert_same(other.step(action)[:4], results[:4])
    assert not np.array_equal(twin.step(action)[0], results[0])


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
@pytest.mark.parametrize("is_handed", [False, True])
@pytest.mark.parametrize("env_id", ["HalfCheetah-v5", "Humanoid-v4", "Reacher-v5"])
def test_a_copy_has_the_data_that_was_used(env_id: str, is_handed: bool, way: Callable[[Any], Any]) -> None:
    env = ours(env_id)
    env.reset(seed=1)
    action = actions_of(env, 1)[0]
    env.step(action)
    env.data.qvel[:] *= 0.5
    if is_handed:  # the package of MuJoCo steps from here
        env.model.opt.gravity[2] = -5.0
        env.step(action)
    twin = way(env)
    for name in ("xpos", "qvel"):
        assert_same(np.array(getattr(twin.data, name)), np.array(getattr(env.data, name)))
    for _ in range(3):
        assert_same(twin.step(action), env.step(action))
        for one in (twin, env):
            one.data.qpos[-1] += 0.01
    assert_same(np.array(twin.data.qpos), np.array(env.data.qpos))
    restored = ours(env_id)
    restored.set_state(twin.get_state())
    assert_same(restored.step(action), env.step(action))
    assert_same(twin.reset(seed=2), env.reset(seed=2))


def test_states_are_of_environments_that_the_same_engine_steps() -> None:
    env, fresh = ours("Hopper-v5"), ours("Hopper-v5")
    for e in (env, fresh):
        e.reset(seed=2)
    env.model.opt.gravity[2] = -5.0
    env.step(actions_of(env, 1)[0])
    with pytest.raises(ValueError, match="^the state is of an environment that MuJoCo's package does not step, and it steps this one$"):
        env.set_state(fresh.get_state())
    # the other way, the package takes over
    fresh.set_state(env.get_state())
    assert fresh._is_handed and fresh.model.opt.gravity[2] == -5.0


def test_a_hand_over_is_warned_of_once() -> None:
    gymnasium.logger.min_level = gymnasium.logger.WARN
    try:
        env = ours("Hopper-v5")
        env.reset(seed=1)
        env.model.opt.gravity[2] = -1.0
        with pytest.warns(UserWarning, match="model was changed: from now on the package mujoco steps this HopperEnv"):
            env.step(env.action_space.sample())
    finally:
        gymnasium.logger.min_level = gymnasium.logger.ERROR


def test_another_version_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    env = ours("Hopper-v5")
    env.reset(seed=1)
    monkeypatch.setattr(sys.modules["rustgym.envs.mujoco"], "_installed", lambda: "2.3.7")
    env.data.xfrc_applied[1, 0] = 1.0
    with pytest.raises(gymnasium.error.Error, match=r"data was changed: .* 2.3.7 is installed"):
        env.step(env.action_space.sample())


def test_subclasses() -> None:
    def made(base: Any) -> list[Any]:
        class Mine(base):  # type: ignore[misc]
            """Applies half of the action twice, and ends the episode if the robot is low."""

            def step(self, action: Any) -> Any:
                for _ in range(2):
                    self.do_simulation(np.asarray(action) / 2, self.frame_skip)
                return self._get_obs(), float(self.data.qvel[0]), bool(self.data.qpos[1] < 0.7), False, {"dt": self.dt}

        class Started(base):  # type: ignore[misc]
            """Starts in another state."""

            def reset_model(self) -> Any:
                self.set_state(self.init_qpos + 0.01, self.init_qvel - 0.1)
                return self._get_obs()

        class Seen(base):  # type: ignore[misc]
            """Adds the time to the observation."""

            def _get_obs(self) -> Any:
                return np.append(super()._get_obs(), self.data.time)

        results: list[Any] = []
        for cls in (Mine, Started, Seen):
            env = cls()
            results.append(env.reset(seed=5))
            results.extend(env.step(action) for action in actions_of(env, 5))
            results.append(env.reset())
        return results

    module = pytest.importorskip("gymnasium.envs.mujoco.hopper_v5")
    # our classes compute with the installed version of MuJoCo, because it steps them
    assert_same(made(rustgym.envs.Hopper_v5), made(module.HopperEnv))


MODEL = """<mujoco><worldbody><light pos="0 0 3"/><geom type="plane" size="5 5 0.1"/><body name="ball" pos="0 0 1"><freejoint/>
<geom size="0.1"/></body><body name="arm" pos="1 0 1"><joint name="hinge" axis="0 1 0"/><geom type="capsule" size="0.05 0.2"/>
</body></worldbody><actuator><motor joint="hinge" ctrlrange="-1 1"/></actuator></mujoco>"""


def test_a_robot_of_ones_own(tmp_path: Any) -> None:
    (tmp_path / "robot.xml").write_text(MODEL)

    def made(base: Any) -> Any:
        class Robot(base, gymnasium.utils.EzPickle):  # type: ignore[misc]
            metadata = {"render_modes": ["human", "rgb_array", "depth_array", "rgbd_tuple"]}

            def __init__(self, **kwargs: Any) -> None:
                gymnasium.utils.EzPickle.__init__(self, **kwargs)
                space = gymnasium.spaces.Box(-np.inf, np.inf, (15,))
                base.__init__(self, str(tmp_path / "robot.xml"), 5, observation_space=space, **kwargs)

            def step(self, action: Any) -> Any:
                self.do_simulation(action, self.frame_skip)
                return self._get_obs(), 0.0, False, False, {}

            def _get_obs(self) -> Any:
                return self.state_vector()

            def reset_model(self) -> Any:
                self.set_state(self.init_qpos, self.init_qvel + self.np_random.normal(size=self.model.nv))
                return self._get_obs()

        return Robot()

    env, other = made(rustgym.envs.mujoco.MujocoEnv), made(gymnasium.envs.mujoco.MujocoEnv)
    for e in (env, other):
        e.reset(seed=3)
    for action in actions_of(env, 5):
        assert_same(env.step(action), other.step(action))
    assert_same(env.reset(seed=4), other.reset(seed=4))
    assert env.action_space == other.action_space and env.dt == other.dt and env.data.time == 0.0
    env.close()


@pytest.mark.parametrize("env_id", ["Pusher-v5", "Reacher-v5"])
def test_what_a_reset_keeps_of_the_start(env_id: str) -> None:
    env, other = ours(env_id), theirs(env_id)
    names = ["goal"] if env_id == "Reacher-v5" else ["cylinder_pos", "goal_pos", "init_qpos"]
    for e in (env, other):
        e.reset(seed=3)
    kept = [e.init_qpos for e in (env, other)]
    for _ in range(2):
        assert_same(*({name: getattr(e, name) for name in names} for e in (env, other)))
        assert_same(*kept)
        for action in actions_of(env, 3):
            assert_same(env.step(action), other.step(action))
        assert_same(env.reset(), other.reset())
    for e in (env, other):
        e.init_qpos = e.init_qpos + 0.01
    assert_same(env.reset(), other.reset())
    assert_same(*({name: getattr(e, name) for name in names} for e in (env, other)))


def test_metadata_is_an_environments_own() -> None:
    env = ours("Hopper-v5")
    env.metadata["render_fps"] = 7
    assert ours("Hopper-v5").metadata["render_fps"] == 125


def test_pictures_of_depth() -> None:
    assert ours("Hopper-v5").metadata["render_modes"] == theirs("Hopper-v5").metadata["render_modes"]
    depth, both, picture = (ours("Hopper-v5", render_mode=mode, width=64, height=48) for mode in ("depth_array", "rgbd_tuple", "rgb_array"))
    for e in (depth, both, picture):
        e.reset(seed=1)
    metres = depth.render()
    assert metres.shape == (48, 64) and metres.dtype == np.float32
    # the robot is in the middle of the picture, three metres from the camera
    assert 2.5 < metres[24, 32] < 3.5 < metres.max()
    assert_same(both.render(), (picture.render(), metres))


def test_vectors_refuse_what_needs_the_package() -> None:
    envs = rustgym.VectorEnv("Hopper-v5", 2, kind="sync", **({"mujoco": VERSION} if "mujoco" in rustgym._specs.spec_of("Hopper-v5")["defaults"] else {}))
    envs.reset(seed=0)
    envs.envs[0].data.qpos[1] = 1.3
    assert envs.step(np.zeros((2, 3), np.float32))[0][0, 0] > 1.29
    envs.envs[0].model.opt.gravity[2] = 0.0
    with pytest.raises(gymnasium.error.Error, match="steps no environment of a vector"):
        envs.step(np.zeros((2, 3), np.float32))


def test_types_in_infos() -> None:
    for env_id in ("HalfCheetah-v5", "Ant-v5", "InvertedPendulum-v5", "Reacher-v4", "Hopper-v5"):
        env, other = rustgym.make_vec(env_id, num_envs=2), gymnasium.make_vec(env_id, num_envs=2, vectorization_mode="sync")
        for e in (env, other):
            e.reset(seed=0)
        for dtype in (np.float32, np.float64):
            action = np.full(env.action_space.shape, 0.25, dtype)
            infos = [e.step(action)[4] for e in (env, other)]
            found = [[(key, value.dtype) for key, value in info.items()] for info in infos]
            assert found[0] == found[1], env_id


def test_a_stored_state_has_all_that_mujocos_package_computed() -> None:
    mujoco = pytest.importorskip("mujoco")
    env: Any = rustgym.Env("Hopper-v5", mujoco=".".join(mujoco.__version__.split(".")[:2]))
    env.reset(seed=1)
    env.model.body_mass[1] *= 2.0
    for _ in range(3):
        env.step(np.full(3, 0.5, np.float32))
    stored = json.loads(env.get_state())["native"]["episode"]["data"]["state"]
    for name in ("qpos", "qvel", "qacc_warmstart"):
        assert stored[name] == getattr(env.data, name).tolist() and any(stored[name]), name


def test_each_array_of_the_model_is_watched_to_its_ends() -> None:
    env = ours("HalfCheetah-v5")
    env.reset(seed=1)
    model, mirror = env.model, env._mirror
    names = [name for name in dir(model) if isinstance(getattr(model, name, None), np.ndarray)]
    watched = [name for name in names if 0 < getattr(model, name).nbytes < 1 << 16 and getattr(model, name).flags.writeable]
    assert len(watched) > 100 and mirror.changes() == ({}, None)
    for name in watched:
        array = getattr(model, name).reshape(-1)
        for index in (0, -1):
            bits = array.view(np.uint8)[index]
            array.view(np.uint8)[index] ^= 1
            assert mirror.changes()[1] == "model", f"{name}[{index}]"
            array.view(np.uint8)[index] = bits
    assert mirror.changes() == ({}, None) and not env._is_handed


def test_a_renderer_is_made_as_gymnasium_makes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[dict[str, Any]] = []

    class Renderer:
        def __init__(self, model: Any, data: Any, *args: Any, **kwargs: Any) -> None:
            names = ("default_cam_config", "width", "height", "max_geom", "camera_id", "camera_name", "visual_options")
            made.append({**dict.fromkeys(names), **dict(zip(names, args, strict=False)), **kwargs})

    monkeypatch.setattr("gymnasium.envs.mujoco.mujoco_rendering.MujocoRenderer", Renderer)
    given: list[dict[str, Any]] = [{}, {"width": 64, "height": 48}, {"camera_id": 0}, {"camera_name": "track"}]
    given += [{"max_geom": 7}, {"visual_options": {2: True}}]
    for kwargs in given:
        made.clear()
        _ = ours("Hopper-v5", render_mode="rgb_array", **kwargs).mujoco_renderer
        theirs("Hopper-v5", render_mode="rgb_array", **kwargs)
        assert_same(*made, where=str(kwargs))


@pytest.mark.parametrize("env_id", ["Ant-v5", "HalfCheetah-v5", "Humanoid-v5", "Pusher-v5", "Reacher-v5", "Swimmer-v4"])
@pytest.mark.parametrize("is_handed", [False, True])
def test_what_was_read_of_a_start_is_no_part_of_the_next(env_id: str, is_handed: bool) -> None:
    """Arrays that a user overwrites after an episode began have an effect where they have one in Gymnasium."""

    def use(env: Any, name: str) -> Any:
        env.reset(seed=2)
        if is_handed:
            env.model.body_mass[1] *= 1.5
            env.step(np.zeros(env.action_space.shape, np.float32))
        if isinstance(array := getattr(env, name, None), np.ndarray) and array.flags.writeable:
            array += 1
        return [*go_on(env, actions_of(env, 3)), env.reset()[0], *go_on(env, actions_of(env, 1))]

    for name in ("goal", "goal_pos", "cylinder_pos", "init_qpos", "init_qvel", "observation_structure"):
        assert_same(use(ours(env_id), name), use(theirs(env_id), name), name)


@pytest.mark.parametrize("is_handed", [False, True])
@pytest.mark.parametrize("env_id", ["HalfCheetah-v5", "Hopper-v5", "Walker2d-v5"])
def test_numbers_of_a_task_are_set_whoever_steps_it(env_id: str, is_handed: bool) -> None:
    def use(env: Any, name: str, value: Any) -> Any:
        env.reset(seed=2)
        if is_handed:
            env.model.body_mass[1] *= 1.5
            env.step(actions_of(env, 1)[0])
        setattr(env, name, value)
        return [env.dt, env.frame_skip, *go_on(env, actions_of(env, 3)), env.reset()[0], *go_on(env, actions_of(env, 1))]

    weights = ("_forward_reward_weight", 3.0), ("_ctrl_cost_weight", 0.5), ("_reset_noise_scale", 0.0)
    for name, value in (("frame_skip", 2), *weights):
        assert_same(use(ours(env_id), name, value), use(theirs(env_id), name, value), name)
