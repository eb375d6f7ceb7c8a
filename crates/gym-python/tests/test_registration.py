"""The ids in Gymnasium's registry, and rustgym imported instead of Gymnasium."""

from __future__ import annotations

import subprocess
import sys

import gymnasium
import pytest

import rustgym
from rustgym.registration import namespaced


def run(code: str) -> str:
    """Runs ``code`` in a new process, in which a `UserWarning` is an error, and returns the output."""
    command = [sys.executable, "-W", "error::UserWarning", "-c", code]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_every_id_is_in_the_namespace() -> None:
    for env_id in rustgym.ids():
        spec = gymnasium.spec(namespaced(env_id))
        assert isinstance(spec.entry_point, str) and spec.to_json()


def test_an_id_imports_the_package() -> None:
    code = "import gymnasium; print(gymnasium.make('rustgym:rustgym/CartPole-v1'), gymnasium.make_vec('rustgym:rustgym/CartPole-v1', 3))"
    assert "CartPoleEnv<rustgym/CartPole-v1>" in run(code)


def test_replacing() -> None:
    code = """
import gymnasium, rustgym
old = dict(gymnasium.registry)
rustgym.register(replace=True)
rustgym.register(replace=True)
for id in ("CartPole-v1", "LunarLander-v2", "Taxi-v3", "LunarLander-v3", "CarRacing-v2"):
    assert gymnasium.make(id, disable_env_checker=True).unwrapped.__module__ == "rustgym.envs", id
assert type(gymnasium.make_vec("CartPole-v1", 2)).__module__ == "rustgym.envs"
assert type(gymnasium.make_vec("Pendulum-v1", 2)) is gymnasium.vector.SyncVectorEnv
assert gymnasium.registry["GymV26Environment-v0"] is old["GymV26Environment-v0"]
try:
    gymnasium.make("Taxi-v40")
except gymnasium.error.VersionNotFound as error:
    assert "[ `v4` ]" in str(error), error
    print("done")
"""
    assert run(code) == "done\n"


@pytest.mark.parametrize("ale_py_comes", ["before", "after", "never"])
def test_replacing_beside_ale_py(ale_py_comes: str) -> None:
    pytest.importorskip("ale_py")
    ale_py = "import ale_py; gymnasium.register_envs(ale_py)"
    code = f"""
import warnings, gymnasium
warnings.simplefilter("error")
{ale_py if ale_py_comes == "before" else ""}
import rustgym
rustgym.register(replace=True)
{ale_py if ale_py_comes == "after" else ""}
print(gymnasium.make("ALE/Pong-v5").unwrapped.__module__)
"""
    assert run(code) == "rustgym.envs\n"


def test_the_module_in_gymnasiums_place() -> None:
    code = """
import rustgym as gym
assert gym.make("CartPole-v1").unwrapped.__module__ == "rustgym.envs"
assert "CartPole-v1" in gym.envs.registry and "LunarLander-v2" in [name for name, _ in gym.envs.registry.items()]
assert gym.spaces.Discrete(3).n == 3 and gym.wrappers.TimeLimit and gym.vector.SyncVectorEnv and gym.error.Error
gym.register("Mine-v0", entry_point="rustgym.envs:CartPole_v1")
gym.register(id="Mine-v1", entry_point="rustgym.envs:CartPole_v1")
assert gym.make("Mine-v1").spec.id == "Mine-v1" and gym.spec("Mine-v0").id == "Mine-v0"
assert gym.make_vec("CartPole-v1", 4).num_envs == 4
from rustgym.wrappers import TimeLimit
import numpy as np
from gymnasium.utils.env_checker import check_env
class Mine(gym.Env):
    observation_space, action_space = gym.spaces.Box(0, 1, (2,)), gym.spaces.Discrete(2)
    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.np_random.random(2, np.float32), {}
    def step(self, action):
        return self.np_random.random(2, np.float32), 0.0, False, False, {}
check_env(Mine(), skip_render_check=True)
Mine().close()
from rustgym.spaces import Box
print(gym.__version__)
"""
    assert run(code).strip() == rustgym.__version__


def test_ids_without_version() -> None:
    gymnasium.logger.min_level = gymnasium.logger.WARN
    try:
        with pytest.warns(UserWarning, match="Using the latest versioned environment `CartPole-v1`"):
            assert rustgym.make("CartPole").spec.id == "CartPole-v1"
    finally:
        gymnasium.logger.min_level = gymnasium.logger.ERROR
    for name, version in (("CartPole", 1), ("Taxi", 4), ("LunarLander", 3), ("Ant", 5), ("MiniGrid-Empty-5x5", 0), ("dm_control/walker-walk", 0)):
        env = rustgym.make(name)
        assert isinstance(env.unwrapped, rustgym.Env) and env.spec.id == f"{name}-v{version}"


def test_import_is_light() -> None:
    code = "import sys, rustgym; print([m for m in ('pygame', 'Box2D', 'torch', 'stable_baselines3', 'matplotlib') if m in sys.modules])"
    assert run(code).strip() == "[]"


def test_specs_make_the_same_again() -> None:
    env = rustgym.make("FrozenLake-v1", map_name="8x8")
    assert gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json())).spec == env.spec
    envs = rustgym.make_vec("CartPole-v1", 5)
    again = gymnasium.make_vec(envs.spec)
    assert again.spec == envs.spec and again.num_envs == 5


def test_classes_stand_for_gymnasiums() -> None:
    for name, ours in rustgym.CLASSES.items():
        module, _, attribute = name.partition(":")
        try:
            __import__(module)
        except (ImportError, gymnasium.error.DependencyNotInstalled):
            continue
        assert hasattr(sys.modules[module], attribute), name
        assert callable(ours)


def test_register_takes_no_nonsense() -> None:
    with pytest.raises(TypeError, match="replace"):
        rustgym.register(replaced=True)


@pytest.mark.parametrize(
    ("env_id", "error", "hint"),
    [
        ("dm_control/walker-wolk-v0", gymnasium.error.NameNotFound, "did you mean `dm_control/walker-walk-v0`"),
        ("dm_control/cow-run-v0", gymnasium.error.NameNotFound, "dm_control/cow-run"),
        ("dm_control/walker-walk-v3", gymnasium.error.VersionNotFound, "v0"),
        ("no_such/Thing-v0", gymnasium.error.NamespaceNotFound, "no_such"),
    ],
)
def test_errors_of_namespaces_that_gymnasium_lacks(
    env_id: str, error: type[Exception], hint: str
) -> None:
    if env_id.startswith("dm_control/") and "shimmy" in sys.modules:
        pytest.skip("shimmy has registered this namespace, in another test")
    for function in (rustgym.make, rustgym.make_vec, rustgym.spec):
        with pytest.raises(error, match=hint):
            function(env_id)


def test_the_engine_that_the_package_lacks_is_named() -> None:
    try:
        rustgym.make("CarRacing-v3", physics="rapier").close()
    except ValueError as error:
        assert "build with the feature `rapier`" in str(error)
    else:
        pytest.skip("this build has the engine")


def test_an_id_of_this_package_can_be_the_users() -> None:
    code = """
import gymnasium, rustgym
gymnasium.logger.min_level = gymnasium.logger.ERROR  # it warns of every id that is registered again
before = len(rustgym.registry)
rustgym.register("CartPole-v1", entry_point="rustgym.envs:MountainCar_v0", max_episode_steps=7)
rustgym.register("Mine-v0", "rustgym.envs:Pendulum_v1")
env = rustgym.make("CartPole-v1")
print(type(env.unwrapped).__name__, env.spec.max_episode_steps, rustgym.make("CartPole-v0").unwrapped.env_id)
print(type(rustgym.make("Mine-v0").unwrapped).__name__, len(rustgym.registry) - before, "CartPole-v1" in rustgym.registry)
del rustgym.registry["Mine-v0"]
print("Mine-v0" in rustgym.registry, "Mine-v0" in list(rustgym.registry))
"""
    assert run(code) == "MountainCarEnv 7 CartPole-v0\nPendulumEnv 1 True\nFalse False\n"


def test_ids_are_those_that_this_package_computes() -> None:
    ids = rustgym.ids()
    assert len(ids) == len({*ids}) and not any(env_id.startswith("Gym") for env_id in ids)
    assert {env_id.split("-")[0] for env_id in ids} >= {"CartPole", "Taxi", "LunarLander", "Ant", "MiniGrid", "BabyAI", "ALE/Pong"}


def test_what_was_replaced_is_still_found() -> None:
    pytest.importorskip("minigrid")
    code = """
import gymnasium, minigrid, rustgym
rustgym.register(replace=True)
env = gymnasium.make("MiniGrid-Empty-5x5-v0").unwrapped
env.reset(seed=1)
print(type(env).__module__, type(env.grid).__module__, isinstance(env, minigrid.minigrid_env.MiniGridEnv))
"""
    assert run(code).endswith("minigrid.core.grid True\n")
