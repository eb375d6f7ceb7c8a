"""A single environment: what `reset`, `step` and `render` return, and which errors they raise."""

from __future__ import annotations

import copy
import json
import pickle
import re
from importlib.util import find_spec
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same
from gymnasium.utils.env_checker import check_env

import rustgym


def test_gymnasiums_checker(env_id: str) -> None:
    env = rustgym.make(env_id)
    check_env(env.unwrapped, skip_render_check=True)


def test_results_are_new_each_time(env_id: str) -> None:
    env = rustgym.make(env_id).unwrapped
    results = [env.reset(seed=1)[0], env.reset(seed=1)[0]]
    results += [env.step(env.action_space.sample())[0] for _ in range(3)]
    arrays = [result for result in results if isinstance(result, np.ndarray)]
    for i, array in enumerate(arrays):
        assert array.flags.writeable and array.flags.c_contiguous
        assert not any(np.shares_memory(array, other) for other in arrays[:i])


@pytest.mark.parametrize("mode", ["rgb_array", "ansi"])
def test_rendering(env_id: str, mode: str) -> None:
    env = rustgym.make(env_id, render_mode=mode) if mode in rustgym.make(env_id).metadata["render_modes"] else None
    if env is None:
        pytest.skip(f"it has no mode {mode}")
    env.reset(seed=0)
    shown = env.render()
    if mode == "ansi":
        assert isinstance(shown, str) and len(shown) > 10
    else:
        for _ in range(20):  # Amidar's first pictures are black, as ale-py's are
            if len(np.unique(shown)) > 1:
                break
            env.step(env.action_space.sample())
            shown = env.render()
        assert shown.dtype == np.uint8 and shown.ndim == 3 and shown.shape[2] == 3
        assert shown.flags.writeable and shown.flags.c_contiguous and len(np.unique(shown)) > 1
        assert not np.shares_memory(shown, env.render())


def test_state_pixels() -> None:
    env = rustgym.make("CarRacing-v3", render_mode="state_pixels")
    observation, _ = env.reset(seed=0)
    assert np.array_equal(env.render(), observation) and env.render() is not observation


def test_unknown_render_modes() -> None:
    env = rustgym.Env("CartPole-v1", render_mode="no-such-mode")
    env.reset(seed=0)
    with pytest.raises(gymnasium.error.UnsupportedMode, match="human, rgb_array"):
        env.render()
    env = rustgym.Env("CartPole-v1")
    env.reset(seed=0)
    assert env.render() is None


@pytest.mark.parametrize("action", [0, np.int64(1), np.int8(1), np.array(1), True])
def test_discrete_actions(action: object) -> None:
    env = rustgym.Env("CartPole-v1")
    env.reset(seed=0)
    assert env.step(action)[1] == 1.0


@pytest.mark.parametrize("action", [2, -1, 1.0, None, "left", [0], np.array([0, 1]), np.float32(0), 2**70])
def test_bad_discrete_actions(action: object) -> None:
    env = rustgym.Env("CartPole-v1")
    env.reset(seed=0)
    before = env.get_state()
    with pytest.raises(gymnasium.error.InvalidAction, match=r"Discrete\(2\)"):
        env.step(action)
    assert env.get_state() == before


@pytest.mark.parametrize("action", [[0.5], (0.5,), np.array([0.5]), np.array([0.5], np.float32), [0], np.array([5.0])])
def test_continuous_actions(action: object) -> None:
    env = rustgym.Env("Pendulum-v1")
    env.reset(seed=0)
    assert env.step(action)[0].dtype == np.float32


@pytest.mark.parametrize("action", [0.5, [[0.5]], [0.5, 0.5], [], "x", None, [np.nan], [1j]])
def test_bad_continuous_actions(action: object) -> None:
    env = rustgym.Env("Pendulum-v1")
    env.reset(seed=0)
    with pytest.raises(gymnasium.error.InvalidAction, match="Box"):
        env.step(action)


def test_strided_and_swapped_actions() -> None:
    env = rustgym.Env("BipedalWalker-v3")
    results = []
    numbers = np.arange(8, dtype=np.float32) / 8
    for action in (numbers[::2].copy(), numbers[::2], numbers[::2].astype(">f4"), numbers[::2].astype(np.float64)):
        env.reset(seed=0)
        results.append(env.step(action)[0])
    assert all(np.array_equal(results[0], result) for result in results)


def test_order() -> None:
    env = rustgym.Env("CartPole-v1")
    with pytest.raises(gymnasium.error.ResetNeeded, match="reset"):
        env.step(0)
    env.reset(seed=1)
    twin = copy.deepcopy(env)
    env.close()
    env.close()
    assert_same([env.step(0), env.reset(), env.state], [twin.step(0), twin.reset(), twin.state])


@pytest.mark.parametrize("seed", [-1, 1.5, "1", [1]])
def test_bad_seeds(seed: object) -> None:
    with pytest.raises(gymnasium.error.Error, match=r"[Ss]eed"):
        rustgym.Env("CartPole-v1").reset(seed=seed)


def test_seeds() -> None:
    env = rustgym.Env("CartPole-v1")
    same = [env.reset(seed=seed)[0] for seed in (5, np.int64(5), np.uint8(5))]
    assert all(np.array_equal(same[0], other) for other in same)
    assert not np.array_equal(env.reset(seed=2**200)[0], same[0])
    assert not np.array_equal(env.reset()[0], env.reset()[0])


@pytest.mark.parametrize("options", [{"low": "x"}, {"low": [1.0, 2.0]}, {"low": 1.0, "high": 0.5}, {"low": float("nan")}])
def test_bad_options(options: dict[str, object]) -> None:
    env = rustgym.Env("CartPole-v1")
    env.reset(seed=0)
    with pytest.raises(ValueError, match="low|reset options of CartPole"):
        env.reset(options=options)


@pytest.mark.parametrize("name", ["CartPole-v1", "Pendulum-v1", "Blackjack-v1", "CarRacing-v3", "LunarLander-v3"])
def test_options_of_others_are_ignored(name: str) -> None:
    for env in (rustgym.make(name), rustgym.VectorEnv(name, 1)):
        plain = env.reset(seed=1)
        assert_same(env.reset(seed=1, options={"somebody's": object()}), plain)
        for options in ("x", 3, [("low", 0)]):
            with pytest.raises(TypeError, match="options must be a dict"):
                env.reset(options=options)


def test_an_environment_is_of_its_class() -> None:
    env = rustgym.Env("CartPole-v1", gravity=3.7)
    assert isinstance(env, rustgym.envs.CartPoleEnv) and env.state is None and env.gravity == 3.7
    assert repr(env) == "rustgym.Env('CartPole-v1', gravity=3.7)"
    assert rustgym.Env(env_id="FrozenLake-v1").P[0][0]
    assert repr(rustgym.VectorEnv("CartPole-v1", 3)) == "rustgym.VectorEnv('CartPole-v1', num_envs=3, kind='native')"
    for wrong in ("CartPol-v1", "none/CartPole-v1"):
        with pytest.raises(gymnasium.error.Error) as error:
            rustgym.Env(wrong)
        assert "crate" not in str(error.value)


def test_options() -> None:
    env = rustgym.envs.CartPoleEnv()
    env.reset(seed=0, options={"low": np.array(0.2), "high": np.float32(0.25)})
    assert (np.abs(env.state - 0.225) <= 0.026).all()


def test_numbers_have_names() -> None:
    env = gymnasium.make("rustgym/HalfCheetah-v5", exclude_current_positions_from_observation=False)
    names = env.unwrapped.observation_names  # type: ignore[attr-defined]
    assert len(names) == 18 == env.observation_space.shape[0]  # type: ignore[index]
    assert names[:3] == ["position of torso along x (m)", "position of torso along z (m)", "angle of torso about y (rad)"]
    assert rustgym.Env("HalfCheetah-v5").action_names[0] == "torque of bthigh (120 N m)"
    assert rustgym.Env("CarRacing-v3").observation_names == []


def test_arguments() -> None:
    lake = rustgym.Env("FrozenLake-v1", desc=["SFG", "HHH", "FFF"], is_slippery=False)
    assert lake.observation_space.n == 9 and lake.arguments["is_slippery"] is False
    assert lake.unwrapped.arguments["desc"] == ["SFG", "HHH", "FFF"]
    same = rustgym.envs.FrozenLakeEnv(desc=np.asarray(["SFG", "HHH", "FFF"], dtype="c"))
    assert (same.desc == np.asarray(["SFG", "HHH", "FFF"], dtype="c")).all() and (same.nrow, same.ncol) == (3, 3)
    with pytest.raises(TypeError, match="is_slipery.*is_slippery"):
        rustgym.Env("FrozenLake-v1", is_slipery=False)
    with pytest.raises(ValueError, match="gravity is 3"):
        rustgym.Env("LunarLander-v3", gravity=3.0)
    with pytest.raises(TypeError, match="takes no arguments"):
        rustgym.make("Taxi-v3", is_rainy=True)


CONSTANTS: dict[str, dict[str, Any]] = {
    "CartPole-v1": {"gravity": 3.7, "masspole": 0.3, "length": 0.8, "kinematics_integrator": "semi-implicit", "x_threshold": 1.0},
    "MountainCar-v0": {"gravity": 0.002, "force": 0.0015, "max_speed": 0.05},
    "MountainCarContinuous-v0": {"power": 0.002, "min_action": -0.7, "goal_position": -0.3},
    "Pendulum-v1": {"g": 3.7, "m": 2.0, "l": 0.7, "max_torque": 1.5, "dt": 0.04},
    "Acrobot-v1": {"LINK_MASS_2": 0.7, "book_or_nips": "nips", "torque_noise_max": 0.5, "AVAIL_TORQUE": [-2.0, 0.5, 1.0]},
}


@pytest.mark.parametrize("env_id", CONSTANTS)
def test_constants_that_are_set_take_effect_as_gymnasiums(env_id: str) -> None:
    ours, theirs = rustgym.make(env_id).unwrapped, gymnasium.make(env_id).unwrapped
    space = ours.observation_space
    for env in (ours, theirs):
        env.reset(seed=3)
        env.action_space.seed(3)
    for name, value in CONSTANTS[env_id].items():
        for env in (ours, theirs):
            setattr(env, name, value)
            assert getattr(env, name) == value
        for _ in range(15):
            ours = copy.deepcopy(pickle.loads(pickle.dumps(ours)))
            action = theirs.action_space.sample()
            mine, yours = ours.step(action), theirs.step(action)
            assert mine[0].tobytes() == yours[0].tobytes() and mine[1:4] == yours[1:4], name
    assert ours.observation_space == space
    with pytest.raises(ValueError, match="must lie between"):
        setattr(ours, next(iter(CONSTANTS[env_id])), 1e9)


def test_constants_are_keywords_and_attributes_of_classes() -> None:
    cart = rustgym.make("CartPole-v1", masspole=0.5, x_threshold=3.0).unwrapped
    assert (cart.total_mass, cart.polemass_length) == (1.5, 0.25) and cart.observation_space.high[0] == 6.0
    cart.masspole = 1.0
    assert cart.total_mass == 1.5

    class Heavy(rustgym.envs.AcrobotEnv):
        LINK_MASS_1 = 2.0

    assert rustgym.envs.AcrobotEnv.LINK_MASS_1 == 1.0 and Heavy().arguments["LINK_MASS_1"] == 2.0


BOX2D: dict[str, dict[str, Any]] = {
    "LunarLander-v3": {"gravity": -5.0, "enable_wind": True, "wind_power": 9.0, "turbulence_power": 0.4},
    "BipedalWalker-v3": {"hardcore": True},
    "CarRacing-v3": {"lap_complete_percent": 0.5, "domain_randomize": True},
}


@pytest.mark.parametrize("env_id", BOX2D)
@pytest.mark.parametrize("peer", ["rustgym", "gymnasium"])
def test_arguments_of_box2d_that_are_set_take_effect_with_the_next_reset(env_id: str, peer: str) -> None:
    if peer == "gymnasium":
        pytest.importorskip("Box2D")
    arguments = BOX2D[env_id]
    ours = rustgym.make(env_id).unwrapped
    # Gymnasium's attributes, or our environment made with the arguments
    theirs = gymnasium.make(env_id).unwrapped if peer == "gymnasium" else rustgym.make(env_id, **arguments).unwrapped
    for env in (ours, theirs) if peer == "gymnasium" else (ours,):
        env.reset(seed=1)
        for name, value in arguments.items():
            setattr(env, name, value)
            assert getattr(env, name) == value
    ours = copy.deepcopy(pickle.loads(pickle.dumps(ours)))
    # below row 84, CarRacing shows the score, whose digits differ from Gymnasium's
    rows = slice(0, 84) if env_id == "CarRacing-v3" else slice(None)
    # Gymnasium's first picture still has the colours of its constructor's arguments
    assert peer == "gymnasium" or ours.reset(seed=3)[0].tobytes() == theirs.reset(seed=3)[0].tobytes()
    if peer == "gymnasium":
        assert (ours.reset(seed=3)[0][rows] == theirs.reset(seed=3)[0][rows]).all()
    ours.action_space.seed(3)
    for _ in range(40):
        action = ours.action_space.sample()
        mine, yours = ours.step(action), theirs.step(action)
        assert (mine[0][rows] == yours[0][rows]).all() and mine[1:4] == yours[1:4]


def test_what_decides_spaces_is_not_set() -> None:
    lander = rustgym.make("LunarLander-v3").unwrapped
    with pytest.raises(ValueError, match="gravity is 3"):
        lander.gravity = 3.0
    if find_spec("Box2D"):  # the package's environment takes the value
        lander.continuous = True
        return
    with pytest.raises(AttributeError, match="make another environment with continuous=True"):
        lander.continuous = True
    lander.continuous = False


def test_unknown_ids() -> None:
    with pytest.raises(gymnasium.error.NameNotFound, match="did you mean `CartPole-v1`"):
        rustgym.Env("Cartpole-v1")
    with pytest.raises(gymnasium.error.VersionNotFound):
        rustgym.Env("CartPole-v9")


def test_what_is_seen_of_toy_text() -> None:
    taxi = rustgym.Env("Taxi-v4")
    taxi = rustgym.make("Taxi-v4").unwrapped
    with pytest.raises(AttributeError, match="before the first reset"):
        _ = taxi.s
    state, _ = taxi.reset(seed=0)
    assert taxi.s == state and taxi.lastaction is None
    taxi.s = 42
    taxi.step(1)
    assert taxi.lastaction == 1 and taxi.decode(taxi.s)[2:] == taxi.decode(42)[2:]
    with pytest.raises(ValueError, match="does not occur"):
        taxi.s = 500
    blackjack = rustgym.make("Blackjack-v1").unwrapped
    observation, _ = blackjack.reset(seed=1)
    assert observation[1] == blackjack.dealer[0] and len(blackjack.player) == 2


def test_what_is_seen_of_box2d() -> None:
    lander = rustgym.make("LunarLander-v3", enable_wind=True).unwrapped
    lander.reset(seed=1)
    first = lander.wind_idx, lander.torque_idx
    lander.step(0)
    assert (lander.wind_idx, lander.torque_idx) == (first[0] + 1, first[1] + 1)
    assert lander.enable_wind is True and lander.gravity == -10.0 and not lander.game_over
    walker = rustgym.make("BipedalWalkerHardcore-v3").unwrapped
    walker.reset(seed=1)
    assert walker.hardcore and any(piece.color1 == (255, 255, 255) for piece in walker.terrain)


def test_stored_states() -> None:
    env = rustgym.Env("Acrobot-v1")
    env.reset(seed=3)
    state = env.get_state()
    assert json.loads(state)
    ways = []
    for _ in range(2):
        env.set_state(state)
        ways.append([env.step(a % 3)[0] for a in range(20)])
    assert np.array_equal(*ways)
    for damaged in ("", "{}", rustgym.Env("CartPole-v1").get_state()):
        with pytest.raises(ValueError, match="snapshot"):
            env.set_state(damaged)


def test_panics_are_exceptions(faults: str) -> None:
    env = rustgym.Env(faults)
    env.reset()
    env.step(0)
    with pytest.raises(rustgym.PanicError, match="asked to panic at step 1"):
        env.step(1)
    assert issubclass(rustgym.PanicError, Exception)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(0)
    assert env.reset()[0] == 0 and env.step(0)[0] == 1
    with pytest.raises(gymnasium.error.Error, match="asked to refuse"):
        env.step(2)
    assert env.step(0)[0] == 2, "a refusal changes nothing"
    with pytest.raises(rustgym.PanicError, match="at a reset"):
        env.reset(options={"panic": True})
    assert env.reset()[0] == 0


def test_closing_a_window_of_pygame(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.delenv("DISPLAY", raising=False)
    env = rustgym.Env("Acrobot-v1", render_mode="human")
    first, _ = env.reset(seed=0)
    plain = rustgym.Env("Acrobot-v1")
    assert np.array_equal(first, plain.reset(seed=0)[0])
    assert np.array_equal(env.step(1)[0], plain.step(1)[0])
    assert env.render() is None
    env.close()


def test_options_that_no_json_holds_are_named() -> None:
    endless: list[object] = []
    endless.append(endless)
    for value, wrong in ((float("nan"), "low is nan: every number must be finite$"), (endless, "low is .*: it must not contain itself$")):
        with pytest.raises(ValueError, match=wrong):
            rustgym.make("CartPole-v1").reset(options={"low": value})


def test_no_message_speaks_of_rust() -> None:
    for env_id, kwargs in (
        ("ALE/Breakout-v5", {"rom_dir": "/nonexistent"}),
        ("ALE/Breakout-v5", {"mode": "x"}),
        ("CartPole-v1", {"gravity": "x"}),
        ("Ant-v5", {"frame_skip": -1}),
        ("FrozenLake-v1", {"map_name": "9x9"}),
        ("FrozenLake-v1", {"desc": 3}),
        ("ALE/Breakout-v5", {"frameskip": "x"}),
        ("CartPole-v1", {"gravity": None}),
        ("Ant-v5", {"xml_file": "/nonexistent.xml"}),
        ("Blackjack-v1", {"natural": "x"}),
    ):
        with pytest.raises(Exception) as raised:
            rustgym.Env(env_id, **kwargs)
        assert not words_of_rust(raised.value), raised.value
    for env_id in ("Ant-v5", "Pendulum-v1", "BipedalWalker-v3", "CarRacing-v3", "MountainCarContinuous-v0"):
        env = rustgym.Env(env_id)
        env.reset(seed=0)
        for number in (np.nan, np.inf):
            action = np.full(env.action_space.shape, number)
            for same in (action, action.astype(np.float32), action.tolist()):
                with pytest.raises(gymnasium.error.InvalidAction, match=r"(nan|inf).*numbers must be finite.*Box") as raised:
                    env.step(same)
                assert not words_of_rust(raised.value), raised.value


@pytest.mark.parametrize(
    ("env_id", "kwargs", "options", "theirs"),
    [
        ("FrozenLake-v1", {"map_name": "9x9"}, None, KeyError),
        ("LunarLander-v3", {"gravity": -20.0}, None, AssertionError),
        ("LunarLander-v3", {"gravity": 1.0}, None, AssertionError),
        ("CartPole-v1", {}, {"low": 1.0, "high": -1.0}, ValueError),
        ("Pendulum-v1", {}, {"x_init": -5.0}, ValueError),
        ("Pendulum-v1", {}, {"y_init": -1e-3}, ValueError),
    ],
)
def test_what_is_refused_has_gymnasiums_class(env_id, kwargs, options, theirs) -> None:
    if env_id != "LunarLander-v3":  # Gymnasium's environment needs the package Box2D
        with pytest.raises(theirs):
            gymnasium.make(env_id, **kwargs).reset(options=options)
    with pytest.raises(theirs, match=" "):
        rustgym.make(env_id, **kwargs).reset(options=options)


def test_maps_have_a_size() -> None:
    for size in (-1, 0, 1):
        with pytest.raises(ValueError, match=f"size is {size}: the smallest map is 2 by 2"):
            rustgym.envs.generate_random_map(size)


def words_of_rust(error: BaseException) -> list[str]:
    words = r"crate|cargo|usize|\b[iuf](?:8|16|32|64)\b|Option|unwrap|serde|untagged|variant|null|os error|boolean|F64|NaN|shape:"
    return re.findall(words, str(error))


def test_what_is_no_id_or_state_is_named() -> None:
    for made in (rustgym.Env, rustgym.VectorEnv):
        with pytest.raises(TypeError, match="an id is a text .* not 3 of type int"):
            made(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="returned by get_state, not 3"):
        rustgym.Env("CartPole-v1").set_state(3)  # type: ignore[arg-type]
    with pytest.raises(AttributeError, match="neither rustgym nor gymnasium has an attribute 'nothing'"):
        _ = rustgym.nothing


def test_exceptions_are_those_that_gymnasium_raises() -> None:
    for env_id, action, kind in [
        ("CartPole-v1", 5, AssertionError),
        ("FrozenLake-v1", 9, KeyError),
        ("Taxi-v4", 9, KeyError),
        ("Acrobot-v1", 7, IndexError),
        ("CarRacing-v3", [0.0, 0.0], ValueError),
    ]:
        env = rustgym.make(env_id, disable_env_checker=True)
        env.reset(seed=0)
        for expected in (kind, gymnasium.error.InvalidAction):
            with pytest.raises(expected, match="invalid action"):
                env.step(action)
    with pytest.raises(AssertionError, match="call `reset"):
        rustgym.Env("CartPole-v1").step(0)


def test_a_state_that_is_not_finite_is_refused_by_its_name() -> None:
    for env_id, state in (("CartPole-v1", [0.0, float("nan"), 0.0, 0.0]), ("Pendulum-v1", [0.0, float("inf")])):
        env = rustgym.make(env_id)
        env.reset(seed=1)
        before = env.unwrapped.state
        with pytest.raises(ValueError, match=r"^\w+_dot is (nan|inf): every number must be finite$"):
            env.unwrapped.state = np.array(state)
            env.step(env.action_space.sample())
        env.unwrapped.state = before
        env.step(env.action_space.sample())
        env.close()
