"""All modules of Gymnasium can be imported under `rustgym`, with Gymnasium's registry."""

from __future__ import annotations

import importlib
import pickle
import pkgutil
import subprocess
import sys

import gymnasium
import pytest

import rustgym


def names() -> list[str]:
    """The names of Gymnasium's modules, without the prefix `gymnasium.`."""
    found = [name for _, name, _ in pkgutil.walk_packages(gymnasium.__path__, "gymnasium.", onerror=lambda name: None)]
    return [name.removeprefix("gymnasium.") for name in found]


@pytest.mark.parametrize("name", names())
def test_every_module_is_there(name: str) -> None:
    try:
        theirs = importlib.import_module(f"gymnasium.{name}")
    except (ImportError, gymnasium.error.DependencyNotInstalled):
        pytest.skip("it lacks what it imports")
    spec = theirs.__spec__
    ours = importlib.import_module(f"rustgym.{name}")
    assert theirs.__spec__ is spec and importlib.import_module(f"rustgym.{name}") is ours
    if ours is theirs:
        return
    assert name == "envs" or theirs.__doc__ in (None, ours.__doc__)
    for attribute in dir(theirs):
        if not attribute.startswith("_"):
            assert hasattr(ours, attribute), attribute
    if hasattr(theirs, "__all__") and not name.startswith("envs"):
        assert list(ours.__all__) == list(theirs.__all__)
    # a class that rustgym does not replace is Gymnasium's own object, not a copy
    for attribute, value in vars(theirs).items():
        if isinstance(value, type) and not attribute.startswith("_"):
            same = getattr(ours, attribute)
            assert same is value or same.__module__.startswith("rustgym"), attribute


def test_a_star_imports_gymnasiums_names_and_ours() -> None:
    found: dict[str, object] = {}
    exec("from rustgym import *", found)
    # (of what is experimental in Gymnasium nothing is left)
    own = {"CLASSES", "PanicError", "VectorEnv", "ids", "view"}
    assert found.keys() - {"__builtins__"} == {*gymnasium.__all__} - {"experimental"} | own
    assert all(value is getattr(rustgym, name) for name, value in found.items() if name != "__builtins__")


def test_classes_are_the_same() -> None:
    from rustgym.spaces.box import Box
    from rustgym.utils.env_checker import check_env
    from rustgym.vector.utils import batch_space
    from rustgym.wrappers.common import TimeLimit

    assert TimeLimit is gymnasium.wrappers.TimeLimit and Box is gymnasium.spaces.Box
    assert batch_space is gymnasium.vector.utils.batch_space and check_env is gymnasium.utils.env_checker.check_env


def test_our_classes_are_found_where_gymnasiums_are() -> None:
    from rustgym.envs.classic_control.cartpole import CartPoleEnv
    from rustgym.envs.registration import EnvSpec, make, registry
    from rustgym.envs.toy_text import frozen_lake

    assert issubclass(type(rustgym.make("CartPole-v1").unwrapped), CartPoleEnv)
    assert make is rustgym.make and registry is rustgym.registry and EnvSpec is gymnasium.envs.registration.EnvSpec
    assert frozen_lake.generate_random_map(seed=3) == gymnasium.envs.toy_text.frozen_lake.generate_random_map(seed=3)
    assert rustgym.envs.toy_text.frozen_lake is frozen_lake and "4x4" in frozen_lake.MAPS


def test_an_import_leaves_gymnasiums_modules_as_they_are() -> None:
    code = """
import importlib, sys, gymnasium
modules = {}
for name in sys.argv[1:]:
    try:
        modules[name] = importlib.import_module(f"gymnasium.{name}")
    except (ImportError, gymnasium.error.DependencyNotInstalled):
        pass  # it lacks what it imports
before = {name: dict(vars(module)) for name, module in modules.items()}
for name in modules:
    importlib.import_module(f"rustgym.{name}")
print([(name, key) for name in modules for key, value in before[name].items() if vars(modules[name]).get(key) is not value])
"""
    result = subprocess.run([sys.executable, "-c", code, *names()], capture_output=True, text=True, timeout=120, check=False)
    assert result.stdout == "[]\n", result.stdout + result.stderr


def test_attributes_need_no_import() -> None:
    code = "import rustgym as gym; print(gym.envs.toy_text.frozen_lake.generate_random_map(seed=1)[0], gym.core.Env)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("name", ["envs.registration", "spaces", "vector.utils"])
def test_a_star_brings_what_gymnasiums_brings(name: str) -> None:
    ours: dict[str, object] = {}
    theirs: dict[str, object] = {}
    exec(f"from rustgym.{name} import *", ours)
    exec(f"from gymnasium.{name} import *", theirs)
    assert ours.keys() == theirs.keys() and len(theirs) > 5
    assert importlib.import_module(f"rustgym.{name}").__file__ == importlib.import_module(f"gymnasium.{name}").__file__


def test_what_is_not_there_is_an_error() -> None:
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("rustgym.wrappers.nothing")
    with pytest.raises(AttributeError, match="neither rustgym.envs.toy_text nor gymnasium.envs.toy_text"):
        _ = rustgym.envs.toy_text.nothing


@pytest.mark.parametrize("env_id", ["Taxi-v4", "Taxi-v3", "CartPole-v1", "HalfCheetah-v5", "LunarLander-v3"])
def test_ids_are_what_they_are(env_id: str) -> None:
    env = rustgym.make(env_id)
    assert env.spec.id == env_id == env.unwrapped.spec.id == rustgym.spec(env_id).id
    assert f"<{env_id}>" in str(env) and str(pickle.loads(pickle.dumps(env))) == str(env)
    for again in (rustgym.make(env.spec), gymnasium.make(env.spec), env.spec.make()):
        assert again.spec == env.spec and type(again.unwrapped) is type(env.unwrapped)
    assert rustgym.make_vec(env_id, num_envs=2).spec.id == env_id
    if env_id in gymnasium.registry and (env_id != "LunarLander-v3" or importlib.util.find_spec("Box2D")):
        assert str(env) == str(gymnasium.make(env_id))
    assert rustgym.make(f"rustgym/{env_id}").spec.id == f"rustgym/{env_id}"


def test_an_id_of_ones_own_takes_its_place() -> None:
    code = """
import rustgym as gym
gym.register("CartPole-v1", entry_point="rustgym.envs:Pendulum_v1")
print(type(gym.make("CartPole-v1", disable_env_checker=True).unwrapped).__name__)
del gym.registry["Acrobot-v1"]
print("Acrobot-v1" in gym.registry, "Taxi-v4" in gym.envs.registration.registry)
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert result.stdout.split() == ["PendulumEnv", "False", "True"], result.stderr
