"""The package itself: stubs, docstrings, examples in them."""

from __future__ import annotations

import ast
import doctest
import inspect
import io
import json
import os
import pydoc
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rustgym
from rustgym import _json, _spaces, env, envs, notebook, registration, vector_env
from rustgym.notebook import show

MODULES = [rustgym, env, vector_env, registration, envs, notebook, _spaces, _json]


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


PLAY = """
import sys
import rustgym

assert "dm_env" not in sys.modules
for env_id in sys.argv[1:]:
    env = rustgym.make(env_id)
    env.reset(seed=0)
    env.step(env.action_space.sample())
    str(env), repr(env), env.close()
    envs = rustgym.make_vec(env_id, num_envs=2)
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    envs.close()
packages = "ale_py Box2D dm_control gymnasium_robotics minigrid mujoco pygame shimmy".split()
print([name for name in packages if name in sys.modules])
"""


def test_who_opens_nothing_imports_no_package() -> None:
    ids = "CartPole-v1 Taxi-v4 LunarLander-v3 CarRacing-v3 Ant-v5 Pusher-v4 PointMaze_UMaze-v3 MiniGrid-DoorKey-5x5-v0 BabyAI-GoToLocal-v0"
    command = [sys.executable, "-W", "ignore", "-c", PLAY, *ids.split(), "dm_control/cartpole-swingup-v0"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert result.stdout.strip() == "[]", result.stdout + result.stderr[-2000:]


def test_texts() -> None:
    env = rustgym.Env("CartPole-v1", gravity=3.7)
    assert str(env) == repr(env) == "rustgym.Env('CartPole-v1', gravity=3.7)"
    assert str(rustgym.make("CliffWalking-v1")) == "<OrderEnforcing<PassiveEnvChecker<CliffWalkingEnv<CliffWalking-v1>>>>"
    assert str(rustgym.spec("CliffWalking-v1")).startswith("EnvSpec(id='CliffWalking-v1', entry_point='rustgym.envs:CliffWalking_v1'")
    for function in (rustgym.make, rustgym.make_vec, rustgym.spec, rustgym.pprint_registry, rustgym.register):
        text = pydoc.plain(pydoc.render_doc(function))
        assert len(text) < 4000 and max(map(len, text.splitlines()[3:])) <= 135 and ":meth:" not in text, text


def test_pictures_for_notebooks() -> None:
    image = pytest.importorskip("PIL.Image")
    env = rustgym.make("CartPole-v1", render_mode="rgb_array_list")
    env.reset(seed=1)
    for _ in range(4):
        env.step(1)
    frames = env.render()
    shown = show(frames, fps=25)
    assert repr(shown) == "<5 pictures of 600x400 pixels, 25 in a second>"
    with image.open(io.BytesIO(shown._repr_png_())) as file:
        assert (file.format, file.n_frames, file.info["duration"], file.info["loop"]) == ("PNG", 5, 40.0, 0)
        for index, frame in enumerate(frames):
            file.seek(index)
            assert np.array_equal(np.asarray(file.convert("RGB")), frame)
    env = rustgym.make("FrozenLake-v1", render_mode="rgb_array")
    env.reset(seed=1)
    with image.open(io.BytesIO(show(env).png())) as file:
        assert np.array_equal(np.asarray(file), env.render()) and getattr(file, "n_frames", 1) == 1
    envs = rustgym.make_vec("CartPole-v1", num_envs=3, render_mode="rgb_array")
    envs.reset(seed=1)
    assert len(show(envs).frames) == 3


@pytest.mark.parametrize(
    ("frames", "fps", "message"),
    [
        ([], 30, "no picture"),
        (["x"], 30, "picture 0 is of type"),
        ([np.zeros((2, 3, 3), np.uint8), np.zeros((3, 3, 3), np.uint8)], 30, r"picture 1 has the shape \(3, 3, 3\)"),
        (np.zeros((2, 3, 3)), 30, "float64"),
        (np.zeros((2, 0, 3), np.uint8), 30, "picture 0"),
        (np.zeros((2, 3, 3), np.uint8), -1, "fps is -1"),
    ],
)
def test_what_is_no_picture(frames: Any, fps: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        show(frames, fps)


def test_a_text_is_no_picture() -> None:
    env = rustgym.make("FrozenLake-v1", render_mode="ansi")
    env.reset(seed=1)
    with pytest.raises(ValueError, match="render_mode=\"rgb_array\""):
        show(env)


STRICT_SCRIPT = """
import gymnasium
import numpy as np
import numpy.typing as npt

import rustgym
from rustgym.notebook import show

env = rustgym.make("CartPole-v1", render_mode="rgb_array", max_episode_steps=3)
observation, info = env.reset(seed=1, options={"low": 0.0})
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
total: float = float(reward)
ours = rustgym.Env("CartPole-v1", render_mode="rgb_array", gravity=3.7)
state: str = ours.get_state()
ours.set_state(state)
envs = rustgym.VectorEnv("CartPole-v1", 3, kind="async", autoreset_mode="SameStep", arg_each={"gravity": (3.0, 11.0)})
observations, rewards, ends, cuts, infos = envs.step(envs.action_space.sample())
best: float = float(rewards.max())
mask: npt.NDArray[np.bool_] = ends | cuts
both = rustgym.make_vec("LunarLander-v3", num_envs=4, kind="async")
wrapped = gymnasium.wrappers.vector.RecordEpisodeStatistics(both)
print(rustgym.spec("CartPole-v1").max_episode_steps, rustgym.ids()[0], rustgym.__version__)
png: bytes = show(env).png()
cart = rustgym.envs.CartPole_v1()
cart.reset(seed=1)
rustgym.register(replace=True)


class Mine(rustgym.Env):
    def bonus(self) -> float:
        return 1.0


limited = rustgym.wrappers.TimeLimit(env, max_episode_steps=2)
space = rustgym.spaces.Discrete(2)
error: type[Exception] = rustgym.error.InvalidAction
"""


def test_a_users_strict_project(tmp_path: Path) -> None:
    pytest.importorskip("pyright")
    (tmp_path / "script.py").write_text(STRICT_SCRIPT)
    (tmp_path / "pyrightconfig.json").write_text('{"typeCheckingMode": "strict"}')
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "."]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, cwd=tmp_path)
    if " error:" not in result.stdout and "0 errors" not in result.stdout:
        pytest.skip(f"pyright cannot run here: {result.stdout[-300:]}{result.stderr[-300:]}")
    assert "0 errors, 0 warnings" in result.stdout, result.stdout


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


def test_the_notebook_runs(capsys: pytest.CaptureFixture[str]) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pytest.importorskip("tqdm")
    path = Path(__file__).parents[3] / "docs/python/notebook.ipynb"
    if not path.exists():
        pytest.skip("the notebook is not part of the source distribution")
    pyplot.switch_backend("agg")
    scope: dict[str, Any] = {}
    values = []
    for cell in json.loads(path.read_text())["cells"]:
        if cell["cell_type"] == "code":
            *body, last = ast.parse("".join(cell["source"])).body
            if not isinstance(last, ast.Expr):
                body.append(last)
            exec(compile(ast.Module(body, []), "notebook", "exec"), scope)
            if isinstance(last, ast.Expr):
                values.append(eval(compile(ast.Expression(last.value), "notebook", "eval"), scope))
    shown = [value for value in values if isinstance(value, notebook.Pictures)]
    assert len(shown) == 4 and len(shown[1].frames) > 50 and (shown[2].width, shown[2].height) == (1200, 200)
    assert all(picture._repr_png_().startswith(b"\x89PNG") for picture in shown)
    assert "CartPole-v1" in capsys.readouterr().out and (64, 105) in values


def test_a_level_of_the_cpu_that_is_none_is_refused() -> None:
    command = [sys.executable, "-c", "import rustgym; print(rustgym.make('CartPole-v1').reset(seed=1)[0].tolist())"]
    told = {}
    for level in ("baseline", "avx2", "", "pentium"):
        result = subprocess.run(command, capture_output=True, text=True, timeout=60, env={**os.environ, "GYM_CPU": level}, check=False)
        told[level] = result.stdout or result.stderr.splitlines()[-1]
    assert told["baseline"] == told["avx2"] and told["baseline"].startswith("[")
    assert told["pentium"].startswith("ValueError: ") and "GYM_CPU" in told["pentium"] and "pentium" in told["pentium"], told
