"""``rustgym.view``: a robot in a page."""

from __future__ import annotations

import base64
import gzip
import html
import json
import re
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import rustgym

MODEL = """
<mujoco model="arm">
  <worldbody><body name="upper"><joint name="elbow"/><geom size=".1"/></body></worldbody>
  <actuator><motor joint="elbow" ctrlrange="-2 2"/></actuator>
</mujoco>"""
CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"


@pytest.fixture(autouse=True)
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A page of one line stands for the built one."""
    path = tmp_path / "page.html"
    path.write_text("<html><head><title>'A' & \"B\"</title></head></html>")
    monkeypatch.setenv("RUSTGYM_PAGE", str(path))
    return path


def model_in(view: rustgym._view.View) -> dict[str, Any]:
    """The model that the cell of a notebook holds."""
    (source,) = re.findall(r'<iframe srcdoc="([^"]*)"', view._repr_html_())
    page = html.unescape(source)
    assert page == view.html() and "<title>'A' & \"B\"</title>" in page
    (packed,) = re.findall(r'<head><script>globalThis.GYM_ROBOT = "([A-Za-z0-9+/=]*)";</script>', page)
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def test_texts_and_files(tmp_path: Path) -> None:
    assert model_in(rustgym.view(MODEL))["model"] == "arm"
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "cube.obj").write_text(CUBE)
    file = tmp_path / "robot.xml"
    text = MODEL.replace("<worldbody>", '<asset><mesh file="meshes/cube.obj"/></asset><worldbody>').replace('<geom size=".1"/>', '<geom type="mesh" mesh="cube"/>')
    file.write_text(text)
    for path in (file, str(file)):
        view = rustgym.view(path, height=400, mujoco="3.12")
        assert len(model_in(view)["mesh_vert"]) >= 8
        assert 'height="400"' in view._repr_html_() and "400 pixels" in repr(view)


def test_an_environment_in_its_state() -> None:
    env = gymnasium.make("rustgym/Hopper-v5")
    assert model_in(rustgym.view(env))["key_qpos"][-1] == [0, 1.25, 0, 0, 0, 0]
    env.reset(seed=1)
    for _ in range(3):
        env.step(env.action_space.sample())
    model = model_in(rustgym.view(env))
    data = env.unwrapped.data
    for name in ("qpos", "qvel", "ctrl"):
        assert np.array_equal(model[f"key_{name}"][-1], getattr(data, name)), name
    assert model["key_time"][-1] == pytest.approx(0.024)


@pytest.mark.parametrize("env_id", [i for i in rustgym.ids() if re.fullmatch(r"(Ant|HalfCheetah|Humanoid|Pusher|Reacher|Swimmer|Walker2d|PointMaze_UMaze|AdroitHandDoor)-v\d+", i)])
def test_no_number_is_lost(env_id: str) -> None:
    """JSON has no infinity: where one stood would be nothing."""
    model = model_in(rustgym.view(rustgym.make(env_id)))
    del model["names"]  # some bodies have none
    assert "null" not in json.dumps(model)


def test_what_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"line 4: <motor>"):
        rustgym.view(MODEL.replace('joint="elbow" ctrl', 'joint="knee" ctrl'))
    with pytest.raises(ValueError, match="nowhere.xml"):
        rustgym.view(tmp_path / "nowhere.xml")
    with pytest.raises(ValueError, match="no MuJoCo model"):
        rustgym.view(rustgym.make("CartPole-v1"))
    with pytest.raises(ValueError, match="mujoco"):
        rustgym.view(MODEL, mujoco="1.5")
    with pytest.raises(ValueError, match="make the environment"):
        rustgym.view(rustgym.make("Hopper-v5"), mujoco="3.12")
    for height in (0, 99, 10_001):
        with pytest.raises(ValueError, match=f"^height is {height}: it must be from 100 to 10000 pixels$"):
            rustgym.view(MODEL, height=height)
    assert [rustgym.view(MODEL, height=height).height for height in (100, 10_000)] == [100, 10_000]
    with pytest.raises(TypeError, match="not int"):
        rustgym.view(7)  # type: ignore[arg-type]
    monkeypatch.setenv("RUSTGYM_PAGE", str(tmp_path / "none.html"))
    with pytest.raises(FileNotFoundError, match="cargo xtask web --robot"):
        rustgym.view(MODEL)
