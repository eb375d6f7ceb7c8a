"""The package itself: stubs, docstrings, examples in them."""

from __future__ import annotations

import doctest
import inspect
import subprocess
import sys

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
