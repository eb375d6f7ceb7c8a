"""A robot in a notebook: the page of the gallery, with a model in it, as the value of a cell."""

from __future__ import annotations

import base64
import gzip
import html
import os
from pathlib import Path
from typing import Any

import gymnasium

from rustgym import _native as native
from rustgym.env import Env

__all__ = ["View", "view"]

#: The variable with the path of the page, for a build of the package without it.
VARIABLE = "RUSTGYM_PAGE"
#: The page in the package; see docs/python/learners.md for how it comes there.
_PAGE = Path(__file__).with_name("robot.html")


def _page() -> str:
    """The page as one file."""
    named = os.environ.get(VARIABLE)
    path = Path(named) if named else _PAGE
    try:
        return path.read_text("utf-8")
    except OSError as error:
        raise FileNotFoundError(
            f"there is no page for rustgym.view at {path} ({error.strerror}): this package was built without it. In the project's "
            f"checkout, `cargo xtask web --robot` makes target/web-robot/robot.html; give its path in the variable {VARIABLE}"
        ) from error


class View:
    """A robot in a page that needs no server and no network: the value of a cell in JupyterLab, Jupyter, VS Code and Colab.

    Args:
        model: The compiled model as JSON.
        height: The height of the page in the notebook, in pixels.
    """

    def __init__(self, model: bytes, height: int) -> None:
        if not 100 <= height <= 10_000:
            raise ValueError(f"height is {height}: it must be from 100 to 10000 pixels")
        self._model, self.height = gzip.compress(model, 6, mtime=0), height
        self._source = _page()

    def html(self) -> str:
        """The page with the model, which a browser opens as a file too."""
        model = base64.b64encode(self._model).decode()
        return self._source.replace("<head>", f'<head><script>globalThis.GYM_ROBOT = "{model}";</script>', 1)

    def _repr_html_(self) -> str:
        page = html.escape(self.html(), quote=True)
        return f'<iframe srcdoc="{page}" title="A robot" width="100%" height="{self.height}" style="border: 0"></iframe>'

    def __repr__(self) -> str:
        return f"<a robot in a page, {self.height} pixels high: the last value of a cell in a notebook shows it>"


def view(model_or_env: str | os.PathLike[str] | gymnasium.Env[Any, Any], *, height: int = 720, mujoco: str | None = None) -> View:
    """Shows a robot in a notebook, to be watched, driven by sliders, and pulled: offline, from the package's own files.

        import rustgym
        rustgym.view("unitree_go2/scene.xml")

    Args:
        model_or_env: The path of a model in MJCF, the text of one, or an environment of the MuJoCo families, which is shown in its
            current state. What happens in the page does not change the environment.
        height: The height of the page, in pixels.
        mujoco: The version of MuJoCo whose numbers the engine gives, for a path or a text; an environment has its own.

    Raises:
        ValueError: for a model that is refused, with file, line and what to do, and for an environment without a model.
        FileNotFoundError: if the package was built without the page.
    """
    if isinstance(model_or_env, gymnasium.Env):
        env = model_or_env.unwrapped
        model = env._native.compiled_model() if isinstance(env, Env) and env._native is not None else None
        if model is None:
            raise ValueError(f"{model_or_env} has no MuJoCo model of this package: give an environment such as rustgym.make('Ant-v5'), or a model")
        if mujoco is not None:
            raise ValueError("mujoco goes with a path or a text: make the environment with it")
        return View(model, height)
    if isinstance(model_or_env, str | os.PathLike):
        text = os.fspath(model_or_env)
        is_text = isinstance(model_or_env, str) and text.lstrip().startswith("<")
        return View(native.compiled_model(text if is_text else os.path.expanduser(text), is_text, mujoco), height)
    raise TypeError(f"rustgym.view takes a path, a text or an environment, not {type(model_or_env).__name__}")
