"""The package itself: stubs, docstrings, examples in them."""

from __future__ import annotations

import doctest
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rustgym
from rustgym import _json, _spaces, env, envs, registration, vector_env

MODULES = [rustgym, env, vector_env, registration, envs, _spaces, _json]


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_examples_in_docstrings(module: object) -> None:
    assert doctest.testmod(module).failed == 0


@pytest.mark.parametrize("cls", [rustgym.Env, rustgym.VectorEnv])
def test_everything_public_is_described(cls: type) -> None:
    for name, member in vars(cls).items():
        if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, property)):
            assert inspect.getdoc(member), f"{cls.__name__}.{name}"


def test_stubs() -> None:
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "rustgym._native", "--ignore-missing-stub"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_sb3() -> None:
    pytest.importorskip("stable_baselines3")
    from stable_baselines3 import A2C
    from stable_baselines3.common.vec_env import VecMonitor

    vec = rustgym.sb3.VecEnv("CartPole-v1", 4)
    assert vec.get_attr("render_mode") == [None] * 4
    A2C("MlpPolicy", VecMonitor(vec), seed=0, device="cpu").learn(200)


def test_everything_can_be_looked_at() -> None:
    code = "import inspect, pydoc, rustgym; pydoc.render_doc(rustgym); inspect.getmembers(rustgym); inspect.getmembers(rustgym.envs); hasattr(rustgym, 'sb3')"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False)
    assert result.returncode == 0, result.stderr[-2000:]


USERS_SCRIPT = """
import gymnasium
from gymnasium.envs.registration import EnvSpec

import rustgym

env: gymnasium.Env = rustgym.make("CartPole-v1", max_episode_steps=3)
envs: gymnasium.vector.VectorEnv = rustgym.make_vec("CartPole-v1", num_envs=3, kind="sync")
spec: EnvSpec = rustgym.spec("CartPole-v1")
steps: int | None = spec.max_episode_steps
observation, info = env.reset(seed=1, options={"low": 0.0})
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
total: float = float(reward)

ours = rustgym.Env("CartPole-v1", render_mode="rgb_array")
ours.set_state(ours.get_state())
vector = rustgym.VectorEnv("CartPole-v1", 3)
observations, rewards, ends, cuts, infos = vector.step(vector.action_space.sample())
names: list[str] = rustgym.ids()
limited = rustgym.wrappers.TimeLimit(env, max_episode_steps=2)
space = rustgym.spaces.Discrete(2)

rustgym.make(3)  # WRONG
rustgym.make_vec("CartPole-v1", num_envs="3")  # WRONG
rustgym.spec("CartPole-v1").no_such_field  # WRONG
"""


@pytest.mark.parametrize(
    ("module", "options", "wrong"),
    [
        ("mypy", ["--strict", "--disable-error-code", "type-arg", "--no-error-summary"], "error:"),
        ("pyright", ["--pythonpath", sys.executable], " error:"),
    ],
)
def test_a_users_types(module: str, options: list[str], wrong: str, tmp_path: Path) -> None:
    pytest.importorskip(module)
    script = tmp_path / "script.py"
    script.write_text(USERS_SCRIPT)
    command = [sys.executable, "-m", module, *options, str(script)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    if module == "pyright" and wrong not in result.stdout and "0 errors" not in result.stdout:
        pytest.skip(f"pyright cannot run here: {result.stdout[-300:]}{result.stderr[-300:]}")
    found = re.findall(r"script\.py:(\d+)\S* -? ?error:", result.stdout)
    lines = [str(number) for number, line in enumerate(USERS_SCRIPT.splitlines(), 1) if line.endswith("# WRONG")]
    assert found == lines, result.stdout + result.stderr
