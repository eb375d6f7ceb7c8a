"""The package itself: stubs, docstrings, examples in them."""

from __future__ import annotations

import doctest
import inspect
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


def test_a_users_types(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    script = tmp_path / "script.py"
    script.write_text("""
import gymnasium
import rustgym

env: gymnasium.Env = rustgym.make("CartPole-v1", max_episode_steps=3)
envs: gymnasium.vector.VectorEnv = rustgym.make_vec("CartPole-v1", num_envs=3, kind="sync")
steps: int | None = rustgym.spec("CartPole-v1").max_episode_steps
rustgym.make(3)  # type: ignore[arg-type]
rustgym.make_vec("CartPole-v1", num_envs="3")  # type: ignore[arg-type]
""")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--disable-error-code", "type-arg", str(script)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
