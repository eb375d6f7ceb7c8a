"""The whole text of what is refused: each names what was given, and what to do."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym
from rustgym._json import to_json
from rustgym._spaces import space_from
from rustgym._view import View

# without their types, which refuse much of this before it runs
Env: Any = rustgym.Env
VectorEnv: Any = rustgym.VectorEnv
view: Any = rustgym.view
register: Any = rustgym.register

OF_CARTPOLE = (
    "force_mag, gravity, kinematics_integrator, length, masscart, masspole, polemass_length, sutton_barto_reward, tau, "
    "theta_threshold_radians, total_mass, x_threshold"
)


def begun(env_id: str, **kwargs: Any) -> Any:
    env = Env(env_id, **kwargs)
    env.reset(seed=1)
    return env


def put(env: Any, name: str, value: Any) -> Callable[[], None]:
    return lambda: setattr(env(), name, value)


def two(**kwargs: Any) -> Any:
    return VectorEnv("CartPole-v1", 2, **kwargs)


TOLD: list[tuple[Callable[[], Any], type[Exception], str]] = [
    (lambda: Env("CartPole-v1", 3), TypeError, "rustgym.Env takes an id; its other arguments have names"),
    (lambda: Env(), TypeError, 'rustgym.Env needs an id, such as "CartPole-v1": rustgym.ids() lists them'),
    (lambda: Env(3), TypeError, 'an id is a text such as "CartPole-v1", not 3 of type int'),
    (
        lambda: Env("CartPole-v1", wind=3),
        TypeError,
        f"CartPole-v1 got an unexpected keyword argument 'wind': its arguments are {OF_CARTPOLE}, and render_mode",
    ),
    (
        lambda: two(wind=3),
        TypeError,
        f"CartPole-v1 got an unexpected keyword argument 'wind': its arguments are {OF_CARTPOLE}, and those of rustgym.VectorEnv",
    ),
    (lambda: begun("CartPole-v1").reset(options=3), TypeError, "options must be a dict or None, not 3 of type int"),
    (lambda: two().reset(options=[1]), TypeError, "options must be a dict or None, not [1] of type list"),
    (
        lambda: begun("CartPole-v1").reset(seed=1.5),
        gymnasium.error.Error,
        "Seed must be a whole number, zero or greater, not 1.5 of type float",
    ),
    (
        lambda: begun("CartPole-v1").set_state(3),
        TypeError,
        "a state must be a text returned by get_state, not 3 of type int",
    ),
    (
        put(lambda: begun("CartPole-v1"), "np_random", np.random.Generator(np.random.MT19937(1))),
        ValueError,
        "np_random must be a generator on PCG64, not MT19937: np.random.default_rng(seed) makes one",
    ),
    (
        put(lambda: begun("CartPole-v1"), "np_random", 3),
        ValueError,
        "np_random must be a generator on PCG64, not int: np.random.default_rng(seed) makes one",
    ),
    (lambda: begun("CartPole-v1").nothing, AttributeError, "'CartPoleEnv' object has no attribute 'nothing'"),
    (
        lambda: begun("CartPole-v1", render_mode="ansi").render(),
        gymnasium.error.UnsupportedMode,
        "CartPole-v1 cannot render as ansi: its modes are human, rgb_array",
    ),
    (lambda: begun("Taxi-v4").locs.append(3), TypeError, "this list is read-only: no step would see the change"),
    (lambda: Env("Hopper-v5", xml_file="./no.xml"), OSError, "File ./no.xml does not exist"),
    (
        lambda: VectorEnv("CartPole-v1", 2, preprocessing=True),
        TypeError,
        "preprocessing needs an Atari game, and CartPole-v1 is not one",
    ),
    (
        lambda: VectorEnv("ALE/Pong-v5", 2, preprocessing=3),
        TypeError,
        "preprocessing must be True or a dict of settings, not 3",
    ),
    (
        lambda: VectorEnv("ALE/Pong-v5", 2, preprocessing={"noop": 3}),
        TypeError,
        "preprocessing has no 'noop': its settings are noop_max, frame_skip, screen_size, terminal_on_life_loss, clip_reward, "
        "frame_stack",
    ),
    (
        lambda: VectorEnv("ALE/Pong-v5", 2, preprocessing={"clip_reward": 3}),
        TypeError,
        "clip_reward is 3: it must be True or False",
    ),
    (lambda: view(3), TypeError, "rustgym.view takes a path, a text or an environment, not int"),
    (
        lambda: view(begun("CartPole-v1")),
        ValueError,
        "rustgym.Env('CartPole-v1') has no MuJoCo model of this package: give an environment such as rustgym.make('Ant-v5'), or a "
        "model",
    ),
    (lambda: View(b"", 99), ValueError, "height is 99: it must be from 100 to 10000 pixels"),
    (lambda: View(b"", 10001), ValueError, "height is 10001: it must be from 100 to 10000 pixels"),
    (lambda: rustgym.nothing, AttributeError, "neither rustgym nor gymnasium has an attribute 'nothing'"),
    (lambda: rustgym.envs.nothing, AttributeError, "neither rustgym.envs nor gymnasium.envs has an attribute 'nothing'"),
    (lambda: space_from({"type": "Nope"}), ValueError, "there is no space of type 'Nope' in gymnasium"),
    (lambda: to_json({"b": 1.0, "a": float("nan")}), ValueError, "a is nan: every number must be finite"),
    (lambda: two(autoreset_mode="x"), ValueError, "autoreset_mode is 'x': it must be one of NextStep, SameStep, Disabled"),
    (lambda: two().set_attr("gravity", [1]), ValueError, "there are 1 values for 2 environments"),
    (lambda: VectorEnv("CartPole-v1", 0), ValueError, "num_envs is 0: it must be at least 1"),
    (lambda: VectorEnv("CartPole-v1", 1.5), TypeError, "num_envs is 1.5: it must be a whole number"),
    (lambda: VectorEnv("CartPole-v1", 1 << 63), ValueError, f"num_envs is {1 << 63}: that is too many"),
    (lambda: two(kind=3), TypeError, "kind is 3: it must be a text or None"),
    (lambda: two(arg_each={"wind": [1, 2]}), TypeError, "arg_each has the key 'wind', which is not an argument of CartPole-v1"),
    (
        lambda: two(arg_each={"gravity": 3}),
        TypeError,
        "arg_each has 3 for gravity: it takes a list with a value for each environment, or a pair (low, high)",
    ),
    (
        lambda: two(seeds=[[1], [2]]).reset(),
        gymnasium.error.Error,
        "Seed 0 must be a whole number, zero or greater, not [1] of type list",
    ),
    (
        lambda: two(seeds=[1]).reset(),
        gymnasium.error.Error,
        "the 1 seeds are used up: give as many as there are resets, or an iterator such as itertools.count()",
    ),
    (
        lambda: two(seeds=[1, 2]).send(np.zeros(2, int)),
        gymnasium.error.Error,
        "a vector with seeds steps all of its environments at once: it has no send and recv",
    ),
    (
        lambda: two().reset(options={"reset_mask": [True]}),
        ValueError,
        "options['reset_mask'] must be a bool array of shape (2,), not of type bool and shape (1,)",
    ),
    (lambda: two().state, AttributeError, "the state of CartPole-v1 is not an array of numbers, or the vector was not reset yet"),
    (
        put(lambda: begun("LunarLander-v3").lander, "mass", 3),
        AttributeError,
        "mass of a body cannot be set: angularVelocity, linearVelocity can",
    ),
    (
        put(lambda: begun("LunarLander-v3").world, "contacts", 3),
        AttributeError,
        "contacts of the world cannot be set: gravity can",
    ),
    (
        put(lambda: begun("CarRacing-v3").car, "hull", 3),
        AttributeError,
        "hull of a car cannot be set: the velocities of hull and wheels can",
    ),
    (
        put(lambda: begun("CarRacing-v3").car.wheels[0], "mass", 3),
        AttributeError,
        "mass of a wheel cannot be set: angularVelocity, brake, gas, linearVelocity, omega, phase, steer can",
    ),
]


@pytest.mark.parametrize(("call", "kind", "text"), TOLD, ids=[text[:60] for *_, text in TOLD])
def test_what_is_refused_has_its_text(call: Callable[[], Any], kind: type[Exception], text: str) -> None:
    with pytest.raises(kind) as raised:
        call()
    assert str(raised.value) == text


def test_register_refuses_what_it_does_not_take() -> None:
    text = "register() takes an id and the arguments of gymnasium.register, or `replace` alone"
    for args, kwargs in (((None, "rustgym.envs:CartPole_v1"), {}), ((), {"replaced": True}), ((None, 3), {"kwargs": {}})):
        with pytest.raises(TypeError) as raised:
            register(*args, **kwargs)
        assert str(raised.value) == text


#: What cannot be set without the package that has it: each name, its value, and whether another environment can have another.
CONSTANTS: dict[str, dict[str, str]] = {
    "LunarLander-v3": {
        "helipad_x1": "8.0",
        "helipad_x2": "12.0",
        "helipad_y": "3.3333333333333335",
        "continuous": "False",
        "physics": "'box2d'",
    },
    "BipedalWalker-v3": {"physics": "'box2d'"},
    "CarRacing-v3": {"continuous": "True", "physics": "'box2d'"},
    "Taxi-v4": {
        "locs": "[(0, 0), (0, 4), (4, 0), (4, 3)]",
        "locs_colors": "[(255, 0, 0), (0, 255, 0), (255, 255, 0), (0, 0, 255)]",
        "desc": "array(",
    },
    "CliffWalking-v1": {"nS": "48", "nA": "4", "shape": "(4, 12)", "start_state_index": "36"},
}


@pytest.mark.parametrize("env_id", CONSTANTS)
def test_what_no_step_would_read_cannot_be_set(env_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rustgym._class_env, "package_of", lambda env_id: None)
    env, other = begun(env_id), begun(env_id)
    for name, value in CONSTANTS[env_id].items():
        before = getattr(env, name)
        with pytest.raises(AttributeError) as raised:
            setattr(env, name, (9,))
        text = str(raised.value)
        assert text.replace("np.int64(", "").startswith(f"{name} of {env_id} is {value}") and "and cannot be set" in text
        assert text.endswith(f": make another environment with {name}=(9,)") == (name in ("continuous", "physics"))
        assert_same(getattr(env, name), before, name)
        setattr(env, name, before)
    action = other.action_space.sample()
    assert_same(env.step(action), other.step(action), env_id)


def test_what_needs_the_package_mujoco_names_the_version_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["rustgym.envs.mujoco"], "_has_package", lambda: False)
    env, other = begun("Hopper-v5", mujoco="3.12"), begun("Hopper-v5", mujoco="3.12")
    changed = "model was changed, which needs the package mujoco: run `pip install mujoco==3.12.*`"
    lacking = (
        "`model` needs the package mujoco: run `pip install mujoco`; `data`, `dt`, `init_qpos`, `state_vector()` and "
        "`get_body_com()` work without it"
    )
    needed = gymnasium.error.DependencyNotInstalled
    for call, kind, text in (
        (lambda: setattr(env, "model", 7), needed, changed),
        (lambda: env.model, needed, lacking),
        (lambda: env.mujoco_renderer, needed, lacking),
        (
            lambda: setattr(env.data, "xpos", 7),
            AttributeError,
            "xpos is read-only: without the package mujoco, qpos, qvel, qacc_warmstart and time can be written",
        ),
    ):
        with pytest.raises(kind) as raised:
            call()
        assert str(raised.value) == text
    with pytest.raises(AttributeError, match=r"^data has no 'nothing': without the package mujoco it has time, qpos, .*, cfrc_ext$"):
        _ = env.data.nothing
    action = other.action_space.sample()
    assert_same(env.step(action), other.step(action), "Hopper-v5")
