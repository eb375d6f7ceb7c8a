"""Objects read from an environment can be changed in place, with the same effect as in Gymnasium."""

from __future__ import annotations

import copy
import inspect
import math
import pickle
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym
from rustgym._live import Live

Change = Callable[[Any], None]
WAYS: dict[str, Callable[[Any], Any]] = {
    "itself": lambda env: env,
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
}


def play(env: Any, actions: list[Any]) -> list[Any]:
    """The results of the actions, of a reset, and of a step after the reset."""
    results = [env.step(action)[:4] for action in actions]
    return [*results, env.reset()[0], env.step(actions[0])[:4]]


def both(
    env_id: str, change: Change, actions: list[Any], way: str = "itself", before_reset: Change | None = None, **kwargs: Any
) -> None:
    """Compares our environment with Gymnasium's after the same change and the same actions."""
    results = []
    for module in (rustgym, gymnasium):
        # (`copy.copy` of a wrapper copies the wrapper alone)
        env = module.make(env_id, disable_env_checker=True, **kwargs).unwrapped
        if before_reset is not None:
            before_reset(env)
        first = env.reset(seed=3)[0]
        change(env)
        results.append([first, *play(WAYS[way](env) if module is rustgym else env, actions)])
    assert_same(*results)


@pytest.mark.parametrize("env_id", ["CartPole-v1", "Taxi-v4", "LunarLander-v3", "Acrobot-v1", "FrozenLake-v1", "HalfCheetah-v5"])
def test_close_frees_the_window_alone(env_id: str) -> None:
    env, twin = rustgym.make(env_id), rustgym.make(env_id)
    for e in (env, twin):
        e.reset(seed=1)
    env.close()
    action = env.action_space.sample()
    assert_same(env.step(action), twin.step(action))
    assert_same(copy.deepcopy(env).step(action), copy.deepcopy(twin).step(action))
    assert_same(pickle.loads(pickle.dumps(env.unwrapped)).reset(), twin.unwrapped.reset())


@pytest.mark.parametrize("kind", ["sync", "native"])
def test_a_closed_vector_goes_on(kind: str) -> None:
    envs, twin = (rustgym.VectorEnv("CartPole-v1", 3, kind=kind) for _ in range(2))
    for e in (envs, twin):
        e.reset(seed=1)
    envs.close()
    envs.close()
    assert_same(envs.step([0, 1, 0]), twin.step([0, 1, 0]))
    assert_same(envs.reset(), twin.reset())


def put(name: str, value: Any) -> Change:
    return lambda env: setattr(env, name, copy.deepcopy(value))


def put_in(name: str, index: Any, value: Any) -> Change:
    return lambda env: getattr(env, name).__setitem__(index, value)


CHANGES: list[tuple[str, Change, list[Any]]] = [
    ("CartPole-v1", put_in("state", 0, 1.5), [1, 0]),
    ("CartPole-v1", put("state", np.array([0.1, 0.2, 0.03, 0.4])), [1, 0]),
    ("CartPole-v1", put("state", np.array([0.1, 0.2, 0.03, 0.4], np.float32)), [1, 0, 1]),
    ("CartPole-v1", put("state", np.array([0.1, 0.2, 0.2, 3.0], np.float32)), [1, 1, 1]),
    ("CartPole-v1", put("state", (0, 0, 0, 0)), [1, 0]),
    ("CartPole-v1", put("steps_beyond_terminated", 1), [1, 0]),
    ("MountainCar-v0", put("state", np.array([-0.4, 0.01])), [2, 2]),
    ("MountainCar-v0", put("state", np.array([-0.4, 0.01], np.float32)), [2, 2, 2]),
    ("Pendulum-v1", put("state", np.array([-0.4, 0.01], np.float32)), [np.array([0.5], np.float32)] * 3),
    ("MountainCarContinuous-v0", put("state", np.array([-0.4, 0.01], np.float32)), [np.array([0.5], np.float32)] * 2),
    ("Acrobot-v1", put("state", np.array([0.1, 0.2, 0.3, 0.4], np.float32)), [2, 0]),
    ("MountainCarContinuous-v0", put_in("state", 1, 0.02), [np.array([0.5], np.float32)]),
    ("Pendulum-v1", put_in("state", slice(None), [1.0, -2.0]), [np.array([0.5], np.float32)]),
    ("Acrobot-v1", put_in("state", 2, 0.7), [2, 0]),
    ("Acrobot-v1", put("AVAIL_TORQUE", [-1.0, 0.0, 0.25]), [2, 2]),
    ("Blackjack-v1", put("player", [10, 7]), [0]),
    ("Blackjack-v1", put_in("dealer", 0, 3), [0]),
    ("Blackjack-v1", lambda env: env.player.append(2), [0]),
    ("Blackjack-v1", put("sab", False), [1]),
    ("FrozenLake-v1", put_in("P", 0, {a: [(0.5, 9, 2.0, False), (0.5, 2, -1.0, False)] for a in range(4)}), [1, 1, 2]),
    ("FrozenLake-v1", put_in("initial_state_distrib", slice(None), np.eye(16)[14]), [1, 1]),
    ("FrozenLake-v1", put("initial_state_distrib", np.full(16, 1 / 16)), [1, 1]),
    ("FrozenLake-v1", put("s", 6), [1, 1]),
    ("CliffWalking-v1", lambda env: env.P[36].update({1: [(1.0, 20, 7.0, True)]}), [1]),
    ("Taxi-v4", put("P", {s: {a: [(1.0, 77, -3.0, False)] for a in range(6)} for s in range(500)}), [1, 3]),
    ("Taxi-v4", put("fickle_passenger", True), [1, 3]),
    ("LunarLander-v3", put("prev_shaping", -10.0), [2, 1]),
    ("LunarLander-v3", put("game_over", True), [2]),
    ("LunarLander-v3", lambda env: setattr(env.lander, "linearVelocity", (1.0, -2.0)), [2, 1, 3]),
    ("LunarLander-v3", lambda env: setattr(env.lander, "angularVelocity", 0.5), [2, 1, 3]),
    ("LunarLander-v3", lambda env: setattr(env.world, "gravity", (0.5, -3.0)), [2, 1, 3]),
    ("LunarLander-v3", lambda env: env.lander.ApplyForceToCenter((30.0, 70.0), True), [2, 1, 3]),
    ("LunarLander-v3", lambda env: env.lander.ApplyTorque(3.0, True), [2, 1, 3]),
    ("LunarLander-v3", lambda env: env.legs[0].ApplyLinearImpulse((0.1, 0.2), (10.0, 13.0), True), [2, 1, 3]),
    ("LunarLander-v3", lambda env: env.lander.ApplyAngularImpulse(0.3, True), [2, 1, 3]),
    ("BipedalWalker-v3", lambda env: setattr(env.hull, "linearVelocity", (0.5, 0.25)), [np.zeros(4, np.float32)] * 3),
]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("env_id", "change", "actions"), CHANGES)
def test_changes_count(env_id: str, change: Change, actions: list[Any], way: str) -> None:
    if env_id in ("LunarLander-v3", "BipedalWalker-v3"):
        pytest.importorskip("Box2D")
    both(env_id, change, actions, way)


def row(batch: Any, index: int) -> Any:
    return tuple(part[index] for part in batch) if isinstance(batch, tuple) else batch[index]


@pytest.mark.parametrize("way", ["itself", "deep copy", "pickle"])
@pytest.mark.parametrize("index", [0, 1])
@pytest.mark.parametrize(("env_id", "change", "actions"), CHANGES)
def test_changes_count_in_any_environment_of_a_vector(
    env_id: str, change: Change, actions: list[Any], index: int, way: str
) -> None:
    alone, envs = rustgym.Env(env_id), rustgym.VectorEnv(env_id, 2, kind="sync")
    alone.reset(seed=3 + index), envs.reset(seed=3)
    change(alone)
    if getattr(getattr(alone, "state", None), "dtype", None) == np.float32:
        pytest.skip("a vector computes in `float64`")
    try:
        change(envs.envs[index])
    except gymnasium.error.Error as error:
        assert str(error).endswith(" of an environment of a vector cannot be set: give it to the vector")
        return
    envs = WAYS[way](envs)
    for action in [*actions, actions[0]]:
        expected, (observations, *parts) = alone.step(action), envs.step(np.stack([action, action]))
        assert_same([row(observations, index), *(part[index] for part in parts[:3])], list(expected[:4]))
        if expected[2]:
            break
    assert_same(row(envs.reset()[0], index), alone.reset()[0])


def test_a_state_that_was_kept_is_the_states_no_longer() -> None:
    env = rustgym.make("CartPole-v1").unwrapped
    env.reset(seed=1)
    kept = env.state
    seen = kept.copy()
    env.step(1)
    assert np.array_equal(kept, seen) and env.state is not kept
    kept[:] = 5.0
    assert not np.array_equal(env.state, kept)


def test_a_changed_table_is_played_from_a_subclass() -> None:
    class Icy(rustgym.envs.FrozenLake_v1):  # type: ignore[misc,name-defined]
        def __init__(self, **kwargs: Any) -> None:
            super().__init__(**kwargs)
            for actions in self.P.values():
                for action, outcomes in actions.items():
                    actions[action] = [(p, s, r - 0.25, t) for p, s, r, t in outcomes]

    env = Icy()
    env.reset(seed=0)
    assert [env.step(1)[1] for _ in range(3)] == [-0.25] * 3


def test_torques_in_place() -> None:
    env, twin = (rustgym.make("Acrobot-v1").unwrapped for _ in range(2))
    twin.AVAIL_TORQUE = [-1.0, 0.0, 0.25]
    env.AVAIL_TORQUE[2] = 0.25
    for e in (env, twin):
        e.reset(seed=0)
    assert_same(env.step(2), twin.step(2))
    assert rustgym.make("Acrobot-v1").unwrapped.AVAIL_TORQUE == [-1.0, 0.0, 1.0]


def test_a_list_that_was_read_is_replaced() -> None:
    env = rustgym.make("Acrobot-v1").unwrapped
    assert env.AVAIL_TORQUE == [-1.0, 0.0, 1.0]
    env.AVAIL_TORQUE = [-2.0, 0.0, 2.0]
    assert env.AVAIL_TORQUE == [-2.0, 0.0, 2.0]
    env.AVAIL_TORQUE[0] = -3.0
    env.reset(seed=0)
    env.step(0)
    assert env.AVAIL_TORQUE == [-3.0, 0.0, 2.0]


def test_metadata_is_the_classes() -> None:
    env, theirs = (module.make("CartPole-v1").unwrapped for module in (rustgym, gymnasium))
    try:
        for e in (env, theirs):
            e.metadata["render_fps"] = 7
        assert rustgym.make("CartPole-v1").metadata["render_fps"] == gymnasium.make("CartPole-v1").metadata["render_fps"] == 7
    finally:
        for e in (env, theirs):
            e.metadata["render_fps"] = 50


def test_reading_a_table_changes_nothing() -> None:
    env, twin = (rustgym.make("Taxi-v4") for _ in range(2))
    assert len(env.unwrapped.P) == 500
    for e in (env, twin):
        e.reset(seed=0)
    assert_same([env.step(a) for a in (0, 1, 2, 3)], [twin.step(a) for a in (0, 1, 2, 3)])


def test_a_map_is_drawn_and_the_table_stays() -> None:
    env = rustgym.make("FrozenLake-v1", is_slippery=False, render_mode="ansi")
    env.reset(seed=0)
    env.unwrapped.desc[0, 1] = b"H"
    assert "H" in env.render().splitlines()[-4]
    assert env.step(2)[2] is False


def test_a_map_of_characters() -> None:
    desc = [list("SFF"), list("FHF"), list("FFG")]
    envs = rustgym.make_vec("FrozenLake-v1", num_envs=2, desc=desc, is_slippery=False)
    envs.reset(seed=0)
    assert envs.step([1, 2])[0].tolist() == [3, 1]
    both("FrozenLake-v1", lambda env: None, [1, 1], desc=desc, is_slippery=False)


@pytest.mark.parametrize("action", [1.0, np.float32(1.0), np.True_, True, np.array(1)])
def test_toy_texts_take_what_is_equal_to_an_action(action: Any) -> None:
    env, twin = (rustgym.make("FrozenLake-v1", disable_env_checker=True) for _ in range(2))
    for e in (env, twin):
        e.reset(seed=0)
    assert_same(env.step(action), twin.step(1))
    with pytest.raises(gymnasium.error.InvalidAction):
        env.step(1.5)


def test_the_last_torque() -> None:
    env = rustgym.make("Pendulum-v1").unwrapped
    env.reset(seed=0)
    assert env.last_u is None
    env.step(np.array([5.0], np.float32))
    assert env.last_u == 2.0 and isinstance(env.last_u, np.float32)


@pytest.mark.parametrize("name", ["bg_color", "grass_color", "road_color"])
def test_colours_of_a_track(name: str) -> None:
    env = rustgym.make("CarRacing-v3").unwrapped
    before = env.reset(seed=1)[0]
    getattr(env, name)[:] = [10, 20, 30]
    if name == "road_color":
        with pytest.raises(gymnasium.error.ResetNeeded, match="road_color was changed"):
            env.step(np.zeros(3, np.float32))
    seen = env.reset(seed=1)[0]
    assert not np.array_equal(seen, before) and getattr(env, name).tolist() == [10, 20, 30]
    if name != "road_color":  # what was read before a step, or a reset, can be changed after it
        kept = getattr(env, name)
        for go_on in (lambda: env.step(np.zeros(3, np.float32)), lambda: env.reset(seed=1)):
            go_on()
            kept[:] = kept[::-1] + 1
            colour = kept.tolist()
            assert getattr(env, name).tolist() == colour
            env.step(np.zeros(3, np.float32))
            assert getattr(env, name).tolist() == colour
    with pytest.raises(ValueError, match="a colour is"):
        setattr(env, "bg_color", [1, 2, 300])


def test_names_that_are_unknown_are_warned_of() -> None:
    gymnasium.logger.min_level = gymnasium.logger.WARN
    try:
        env = rustgym.make("CartPole-v1").unwrapped
        with pytest.warns(UserWarning, match="has no wind"):
            env.wind = 300
        env = rustgym.make("HalfCheetah-v5").unwrapped
        with pytest.warns(UserWarning, match="has no _healthy_reward"):
            env._healthy_reward = 1
    finally:
        gymnasium.logger.min_level = gymnasium.logger.ERROR


def test_constants_cannot_be_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rustgym._class_env, "package_of", lambda env_id: None)  # without Box2D
    env = rustgym.make("LunarLander-v3").unwrapped
    env.helipad_x1 = 8.0
    env.reset(seed=1)
    env.helipad_x1 = 8
    with pytest.raises(AttributeError, match="helipad_y of LunarLander-v3 is 3.33.* and cannot be set"):
        env.helipad_y = 5.0
    with pytest.raises(AttributeError, match="locs of Taxi-v4"):
        rustgym.make("Taxi-v4").unwrapped.locs = ((0, 0),) * 4
    monkeypatch.undo()
    both("Taxi-v4", put("locs", [(0, 1), (0, 4), (4, 0), (4, 3)]), [0, 1, 2, 3, 4])


def test_environments_of_a_vector_are_live() -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 3, kind="sync")
    envs.reset(seed=1)
    envs.envs[1].state = np.array([0.5, 0.0, 0.0, 0.0])
    assert envs.step([0, 0, 0])[0][1, 0] == 0.5
    kept = envs.envs[2]
    envs.step([0, 0, 0])
    assert np.array_equal(kept.state, envs.envs[2].state) and kept is envs.envs[2]
    envs.get_attr("state")[0][0] = 1.0
    assert envs.step([0, 0, 0])[0][0, 0] > 0.9


@pytest.mark.parametrize("env_id", ["CartPole-v1", "Acrobot-v1", "Pendulum-v1", "FrozenLake-v1", "Taxi-v4", "Hopper-v5", "Blackjack-v1"])
def test_what_was_read_of_an_environment_of_a_vector_goes_on_as_of_one_alone(env_id: str) -> None:
    envs, alone = rustgym.VectorEnv(env_id, 2, kind="sync"), rustgym.Env(env_id)
    envs.reset(seed=[3, 4]), alone.reset(seed=4)
    within = envs.envs[1]
    live = [name for name in dir(type(alone)) if isinstance(inspect.getattr_static(type(alone), name), Live) and hasattr(alone, name)]
    # (a card more)
    action = np.int64(1) if env_id == "Blackjack-v1" else alone.action_space.sample()

    def step() -> None:
        envs.step(np.stack([action, action])), alone.step(action)

    for go_on in (step, lambda: (envs.reset(seed=[5, 6]), alone.reset(seed=6)), step):
        kept = {name: (getattr(within, name), getattr(alone, name)) for name in live}
        go_on()
        for name, (ours, expected) in kept.items():
            assert_same(ours, expected, name)
            assert (getattr(within, name) is ours) == (getattr(alone, name) is expected), name
            assert_same(getattr(within, name), getattr(alone, name), name)
    assert live


@pytest.mark.parametrize("way", ["itself", "pickle"])
def test_a_table_of_an_environment_of_a_vector(way: str) -> None:
    envs = rustgym.VectorEnv("FrozenLake-v1", 2, kind="sync")
    envs.reset(seed=1)
    envs.envs[0].P[0][1] = [(1.0, 5, 2.0, False)]
    envs = WAYS[way](envs)
    observations, rewards, *_ = envs.step([1, 1])
    assert observations[0] == 5 and rewards.tolist() == [2.0, 0.0]
    envs.envs[1].initial_state_distrib[:] = np.eye(16)[14]
    assert envs.reset(seed=1)[0].tolist() == [0, 14]


@pytest.mark.parametrize("outcome", [(math.nan, 0, 0.0), (1.0, 0, math.nan), (1.5, 0, 0.0), (1.0, 16, 0.0)])
@pytest.mark.parametrize("num_envs", [1, 2])
def test_a_table_that_cannot_be_is_refused(outcome: tuple[float, int, float], num_envs: int) -> None:
    envs = rustgym.VectorEnv("FrozenLake-v1", num_envs, kind="sync")
    env = rustgym.make("FrozenLake-v1")
    envs.reset(seed=1)
    env.reset(seed=1)
    for lake, step in ((env.unwrapped, lambda: env.step(0)), (envs.envs[0], lambda: envs.step([0] * num_envs))):
        lake.P[0][0] = [(*outcome, False)]
        with pytest.raises(ValueError, match=r"finite"):
            step()


@pytest.mark.parametrize("starts", [math.nan, -1.0, 2.0])
def test_starts_that_cannot_be_are_refused(starts: float) -> None:
    env = rustgym.make("FrozenLake-v1")
    env.unwrapped.initial_state_distrib[:] = starts
    with pytest.raises(ValueError, match="probabilities from 0 to 1"):
        env.reset(seed=1)


def test_frames_per_second_follow_the_step() -> None:
    assert rustgym.make("Ant-v5", frame_skip=2).metadata["render_fps"] == 50
    assert rustgym.make("Hopper-v5", frame_skip=1).metadata["render_fps"] == 500
    assert rustgym.make("Ant-v5").metadata["render_fps"] == 20


def walker(env: Any) -> list[Any]:
    lower = [leg.ground_contact for leg in env.legs[1::2]]
    joints = [(joint.angle, joint.speed, joint.motorSpeed) for joint in env.joints]
    return [lower, joints, [ray.fraction for ray in env.lidar], env.terrain_x, env.terrain_y, env.scroll]


def lander(env: Any) -> list[Any]:
    body = env.lander
    position, velocity = body.position, body.linearVelocity
    sums = position + velocity, position - velocity, position * 2.0, 2.0 * position, -position, position / 2.0
    return [position.x, velocity.y, tuple(body.worldCenter), velocity.length, *map(tuple, sums), tuple(env.world.gravity)]


def car(env: Any) -> list[Any]:
    wheels = [(w.gas, w.brake, w.steer, w.phase, w.omega, tuple(w.position), w.joint.angle) for w in env.car.wheels]
    return [*wheels, tuple(env.car.hull.linearVelocity)]


@pytest.mark.parametrize(
    ("env_id", "see", "action"),
    [
        ("BipedalWalker-v3", walker, np.array([0.5, -0.5, 0.2, 0.1], np.float32)),
        ("LunarLander-v3", lander, 2),
        ("CarRacing-v3", car, np.array([0.1, 0.5, 0.1], np.float32)),
    ],
)
def test_bodies_are_seen(env_id: str, see: Callable[[Any], list[Any]], action: Any) -> None:
    pytest.importorskip("Box2D")
    found = []
    for module in (rustgym, gymnasium):
        env = module.make(env_id, disable_env_checker=True).unwrapped
        env.reset(seed=3)
        for _ in range(5):
            env.step(action)
        found.append(see(env))
    assert_same(*found)


def test_a_wheel_is_changed() -> None:
    env, twin = (rustgym.make("CarRacing-v3").unwrapped for _ in range(2))
    for e in (env, twin):
        e.reset(seed=3)
    env.car.wheels[2].omega = 50.0
    for e in (env, twin):
        e.step(np.zeros(3, np.float32))
    assert env.car.wheels[2].omega != twin.car.wheels[2].omega
    with pytest.raises(AttributeError, match="angle of a wheel cannot be set: angularVelocity, brake, gas"):
        env.car.wheels[2].angle = 1.0


@pytest.mark.parametrize("make", [lambda: rustgym.make("CartPole-v1").unwrapped, lambda: rustgym.VectorEnv("CartPole-v1", 2)])
def test_a_step_of_ones_own_stays(make: Callable[[], Any]) -> None:
    env = make()
    env.reset(seed=1)
    env.step = lambda action: "mine"
    _ = env.state if hasattr(env, "np_random") else env.envs
    env.reset(seed=2)
    assert env.step(0) == "mine"
    del env.step
    assert len(env.step(env.action_space.sample())) == 5


@pytest.mark.parametrize("way", WAYS)
def test_copies_step_themselves(way: str) -> None:
    env = rustgym.make("CartPole-v1").unwrapped
    env.reset(seed=1)
    twin = WAYS[way](env)
    expected = env.step(1)
    if twin is not env:
        assert_same(twin.step(1), expected)
        twin.state[0] = 1.0  # from this read of `state` on, each step of `twin` looks for changes
        assert twin.step(1)[0][0] > 0.9 and env.state[0] < 0.9
    envs = rustgym.VectorEnv("CartPole-v1", 2)
    envs.reset(seed=1)
    other = WAYS[way](envs) if way != "copy" else envs
    assert len(other.step([0, 1])) == 5


@pytest.mark.parametrize("steps", [0, 2])
@pytest.mark.parametrize("number", [np.float64, np.float32])
@pytest.mark.parametrize(
    ("env_id", "state", "action"),
    [
        ("CartPole-v1", [0.1, 0.2, 0.03, 0.4], 1),
        ("MountainCar-v0", [-0.4, 0.01], 2),
        ("MountainCarContinuous-v0", [-0.4, 0.01], np.array([0.3], np.float32)),
        ("Pendulum-v1", [0.7, -0.3], np.array([0.3], np.float32)),
        ("Acrobot-v1", [0.1, 0.2, 0.3, 0.4], 2),
    ],
)
def test_a_state_has_the_precision_that_it_was_set_with(env_id: str, state: list[float], action: Any, number: Any, steps: int) -> None:
    def use(module: Any) -> list[Any]:
        env = module.make(env_id, disable_env_checker=True)
        env.reset(seed=1)
        for _ in range(steps):
            env.step(action)
        env.unwrapped.state = np.array(state, number)
        if module is rustgym:
            twin = rustgym.Env(env_id)
            twin.set_state(env.unwrapped.get_state())
            # the other three compute with Python's floats
            kept = number if env_id in ("Acrobot-v1", "MountainCarContinuous-v0") else np.float64
            assert_same(np.asarray(twin.state), np.array(state, number).astype(kept), env_id)
        results = [env.step(action)[:4] for _ in range(3)]
        return [*results, np.asarray(env.unwrapped.state)]

    assert_same(use(rustgym), use(gymnasium), env_id)


def test_a_picture_has_a_face_only_where_the_dealers_card_has_one() -> None:
    faces = set()
    for seed in range(40):
        env = rustgym.make("Blackjack-v1").unwrapped
        env.reset(seed=seed)
        card, shown = env.dealer[0], env.dealer_top_card_value_str
        assert shown in {1: ("A",), 10: ("10", "J", "Q", "K")}.get(card, (str(card),))
        faces.add(shown)
        env.dealer_top_card_value_str = shown
        if shown in ("J", "Q", "K"):
            env.dealer_top_card_value_str = "K"
            assert env.dealer_top_card_value_str == "K"
        else:
            with pytest.raises(ValueError, match=f"^dealer_top_card_value_str cannot be 'J': it shows the card dealer.0., {card}$"):
                env.dealer_top_card_value_str = "J"
        with pytest.raises(ValueError, match="^dealer_top_card_value_str cannot be 'Joker'"):
            env.dealer_top_card_value_str = "Joker"
        assert env.dealer_top_card_value_str == ("K" if shown in ("J", "Q", "K") else shown)
    assert faces >= {"A", "2", "J", "Q", "K"}
