"""Each attribute of Gymnasium's environments has the same type and value in ours, in every phase of an episode."""

from __future__ import annotations

import numbers
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import gymnasium
import numpy as np
import pytest

import rustgym

IDS = [
    "Acrobot-v1",
    "BipedalWalker-v3",
    "Blackjack-v1",
    "CarRacing-v3",
    "CartPole-v1",
    "CliffWalking-v1",
    "FrozenLake-v1",
    "LunarLander-v3",
    "MountainCar-v0",
    "MountainCarContinuous-v0",
    "Pendulum-v1",
    "Taxi-v4",
    *(f"{task}-v5" for task in ("Ant", "HalfCheetah", "Hopper", "Humanoid", "InvertedPendulum", "Pusher", "Reacher", "Swimmer")),
]
# attributes with objects of pygame and Box2D, for which our error names a replacement
ABSENT = {
    "BipedalWalker-v3": {"cloud_poly", "fd_edge", "fd_polygon"},
    "CarRacing-v3": {"clock", "contactListener_keepref", "fd_tile", "road", "road_poly", "start_alpha", "surf"},
    "LunarLander-v3": {"moon", "particles"},
}
# attributes that are no part of an episode
BESIDE = {"np_random", "np_random_seed", "spec"}


def make(module: Any, env_id: str) -> Any:
    if env_id.endswith("-v5"):
        mujoco = pytest.importorskip("mujoco")
        if module is rustgym:
            return module.make(env_id, mujoco=".".join(mujoco.__version__.split(".")[:2]))
    if env_id.startswith(("Lunar", "Bipedal", "CarRacing")):
        pytest.importorskip("Box2D")
    if module is rustgym and env_id == "CarRacing-v3":
        pytest.importorskip("pygame")
        return module.make(env_id, score_font=True)
    return module.make(env_id)


def phases(module: Any, env_id: str) -> Iterator[tuple[str, Any]]:
    env = make(module, env_id)
    yield "made", env.unwrapped
    env.reset(seed=3)
    yield "reset", env.unwrapped
    rng = np.random.default_rng(5)
    space = env.action_space

    def step() -> bool:
        is_discrete = isinstance(space, gymnasium.spaces.Discrete)
        action = int(rng.integers(space.n)) if is_discrete else rng.uniform(space.low, space.high).astype(space.dtype)
        return any(env.step(action)[2:4])

    step()
    yield "stepped", env.unwrapped
    if "CarRacing" not in env_id:
        for _ in range(300):
            if step():
                break
        yield "ended", env.unwrapped
        if "Blackjack" not in env_id:  # no card can be drawn after a bust
            step()
            step()
            yield "beyond", env.unwrapped
    env.reset()
    yield "reset again", env.unwrapped
    env.close()
    yield "closed", env.unwrapped


def plain(value: Any) -> Any:
    """The type and value of a number or text; for other objects, such as bodies, only that they exist."""
    if isinstance(value, np.ndarray):
        return (str(value.dtype), value.shape, value.tobytes())
    if isinstance(value, dict):
        return [(key, plain(part)) for key, part in value.items()]
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return "object"
    if isinstance(value, tuple | list):
        return (isinstance(value, list), [plain(part) for part in value])
    if isinstance(value, numbers.Number | str | bytes | np.bool_ | None):
        return repr(value)
    return "object"


def look(env: Any, name: str) -> Any:
    try:
        return plain(getattr(env, name))
    except AttributeError:
        return "absent"


@pytest.mark.parametrize("env_id", IDS)
def test_attributes_have_gymnasiums_types_and_values(env_id: str) -> None:
    for (phase, theirs), (_, ours) in zip(phases(gymnasium, env_id), phases(rustgym, env_id), strict=True):
        names = {name for name in dir(theirs) if not name.startswith("_")} - BESIDE - ABSENT.get(env_id, set())
        different = {name: (look(theirs, name), look(ours, name)) for name in sorted(names) if look(theirs, name) != look(ours, name)}
        assert not different, (phase, different)


@pytest.mark.parametrize("env_id", [env_id for env_id in IDS if "Blackjack" not in env_id and not env_id.endswith("-v5")])
def test_nothing_of_an_episode_is_there_before_it(env_id: str) -> None:
    """What Gymnasium's environment has from the first reset on can be neither read nor set before."""
    _, theirs = next(phases(gymnasium, env_id))
    ours = make(rustgym, env_id).unwrapped
    later = make(gymnasium, env_id)
    later.reset(seed=3)
    for name in sorted(set(dir(later.unwrapped)) - set(dir(theirs)) - ABSENT.get(env_id, set()) - BESIDE):
        with pytest.raises(AttributeError, match=f"{env_id} |'{type(ours).__name__}' object has no attribute '{name}'$"):
            getattr(ours, name)


@pytest.mark.parametrize("env_id", IDS)
def test_an_environment_is_no_class(env_id: str) -> None:
    """``hasattr(env, "__name__")`` is false, without an error: pytest asks a parameter for its name."""
    theirs, ours = gymnasium.Env(), rustgym.make(env_id).unwrapped
    assert [name for name in dir(type) if hasattr(theirs, name) != hasattr(ours, name)] == []


@pytest.mark.parametrize("env_id", ABSENT)
def test_absent_attributes_say_what_to_use(env_id: str) -> None:
    for name in ABSENT[env_id]:
        env = rustgym.make(env_id).unwrapped
        env.reset(seed=1)
        if find_spec("Box2D") and name not in ("clock", "surf"):
            assert hasattr(env, name), "the environment of gymnasium has it"
            continue
        with pytest.raises(AttributeError, match=f"{name}.*: .*(pygame|Box2D|render|track)"):
            getattr(env, name)


def test_what_pictures_have() -> None:
    env = rustgym.make("CartPole-v1", render_mode="rgb_array").unwrapped
    env.reset(seed=1)
    assert env.screen is None and env.isopen
    with pytest.raises(AttributeError, match="screen_width of CartPole-v1 is 600 and cannot be set"):
        env.screen_width = 800
    env.screen_width = 600
    env.render()
    with pytest.raises(AttributeError, match=r"CartPole-v1 has no screen: .* render\(\) returns the picture"):
        _ = env.screen
    env.close()
    assert not env.isopen
    lander = rustgym.make("LunarLander-v3", render_mode="rgb_array").unwrapped
    lander.reset(seed=1)
    lander.render()
    lander.close()
    assert lander.screen is None and lander.isopen  # Gymnasium makes the screen only for a window


def test_a_class_that_draws_itself_sets_what_it_draws_on() -> None:
    class Drawn(rustgym.envs.CartPoleEnv):
        def __init__(self) -> None:
            super().__init__()
            self.screen, self.state, self.steps_beyond_terminated = "a surface", None, None

        def render(self) -> Any:
            return self.screen

    env = Drawn()
    assert env.render() == "a surface" and env.state is None
    with pytest.raises(gymnasium.error.ResetNeeded, match="the state of CartPole-v1 is None: call reset first"):
        env.step(0)
    env.reset(seed=1)
    assert env.state.shape == (4,) and env.step(0)[1] == 1.0


@pytest.mark.parametrize("steps", [0, 3])
def test_steps_beyond_the_end(steps: int) -> None:
    results = []
    for module in (rustgym, gymnasium):
        env = module.make("CartPole-v1").unwrapped
        env.reset(seed=1)
        while not env.step(1)[2]:
            pass
        for _ in range(steps):
            env.step(1)
        seen = [env.steps_beyond_terminated]
        env.state = np.zeros(4)  # back within the bounds: the reward is 1 again
        seen += [float(env.step(1)[1]), env.steps_beyond_terminated]
        env.steps_beyond_terminated = 7
        env.state = np.array([9.0, 0.0, 0.0, 0.0])
        results.append([*seen, float(env.step(1)[1]), env.steps_beyond_terminated])
    assert results[0] == results[1] == [steps, 1.0, steps, 0.0, 8]


def test_wind_needs_a_reset() -> None:
    env = rustgym.make("LunarLander-v3").unwrapped
    env.reset(seed=1)
    with pytest.raises(AttributeError, match="the episode began without wind"):
        _ = env.wind_idx
    env.enable_wind = True
    with pytest.raises(AttributeError, match="reset first, or set wind_idx and torque_idx"):  # as in Gymnasium
        env.step(0)
    env.wind_idx = env.torque_idx = 5
    env.step(0)
    assert repr((env.wind_idx, env.torque_idx)) == repr((np.int64(6), np.int64(6)))
    env.enable_wind = False
    env.reset(seed=1)
    env.enable_wind = True
    env.reset(seed=1)
    env.step(0)


def test_lists_and_cars_refuse_what_has_no_effect() -> None:
    taxi = rustgym.make("Taxi-v4").unwrapped
    assert taxi.locs == [(0, 0), (0, 4), (4, 0), (4, 3)] and isinstance(taxi.locs, list)
    with pytest.raises(TypeError, match="read-only"):
        taxi.locs[0] = (1, 1)
    with pytest.raises(ValueError, match="read-only"):
        taxi.desc[1, 1] = b"X"
    car = rustgym.make("CarRacing-v3").unwrapped
    assert car.car is None and car.bg_color.tolist() == [102, 204, 102] and (car.reward, car.car) == (0.0, None)
    car.reset(seed=1)
    with pytest.raises(AttributeError, match="hull of a car cannot be set"):
        car.car.hull = None
    car.car.gas(0.5)
    car.car.brake(0.25)
    car.car.steer(-0.3)
    seen = [(w.gas, w.brake, w.steer) for w in car.car.wheels]
    assert seen == [(0.0, 0.25, -0.3)] * 2 + [(0.1, 0.25, 0.0)] * 2


def test_cards_of_a_picture_can_be_set() -> None:
    env = rustgym.make("Blackjack-v1").unwrapped
    env.reset(seed=3)
    env.dealer = [10, 6]
    env.dealer_top_card_suit, env.dealer_top_card_value_str = "H", "K"
    assert (env.dealer_top_card_suit, env.dealer_top_card_value_str) == ("H", "K")
    with pytest.raises(ValueError, match="it is C, D, H or S"):
        env.dealer_top_card_suit = "Hearts"
    with pytest.raises(ValueError, match="cannot be 'A'"):
        env.dealer_top_card_value_str = "A"


OF_CLOSING = ["close", "render close", "reset close", "reset render close", "reset render close reset", "reset step render close"]


@pytest.mark.parametrize("env_id", [*IDS[:2], *IDS[4:5], *IDS[7:12]])
@pytest.mark.parametrize("mode", [None, "rgb_array", "ansi"])
@pytest.mark.parametrize("calls", OF_CLOSING)
def test_a_picture_is_open_until_it_is_closed(
    env_id: str, mode: str | None, calls: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    if env_id.startswith(("Lunar", "Bipedal")):
        pytest.importorskip("Box2D")
    if mode == "ansi" and env_id != "Taxi-v4":
        pytest.skip("it has no pictures of text")
    action = 2 if env_id == "Taxi-v4" else rustgym.Env(env_id).action_space.sample()
    found = []
    for module in (gymnasium, rustgym):
        env = module.make(env_id, render_mode=mode, disable_env_checker=True).unwrapped
        try:
            for call in calls.split():
                given: dict[str, Any] = {"reset": {"seed": 1}, "step": {"action": action}}
                getattr(env, call)(**given.get(call, {}))
        except Exception:
            assert module is gymnasium, "it can draw where Gymnasium's cannot"
            return
        found.append([look(env, name) for name in ("isopen", "taxi_orientation")])
    assert found[0] == found[1]
