"""Pictures in notebooks, without files: ``show`` makes the value of a cell in JupyterLab, Jupyter, VS Code and Colab.

    >>> import rustgym
    >>> from rustgym.notebook import show
    >>> env = rustgym.make("CartPole-v1", render_mode="rgb_array_list")
    >>> observation, info = env.reset(seed=1)
    >>> for _ in range(10):
    ...     _ = env.step(1)
    >>> show(env)
    <11 pictures of 600x400 pixels, 50 in a second>
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Sequence
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

__all__ = ["Pictures", "show"]

# what the fields of an animation are numbered with
_MOST = 0xFFFF


def _chunk(kind: bytes, data: bytes) -> bytes:
    """A part of a PNG file."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


class Pictures:
    """A picture, or several as an animation, that a notebook shows as the value of a cell.

    Args:
        frames: Arrays of ``uint8`` and shape ``(height, width, 3)``, all of one size.
        fps: How many are shown in a second.

    Raises:
        ValueError: for frames of another form, or none.
    """

    def __init__(self, frames: Sequence[npt.NDArray[np.uint8]], fps: float) -> None:
        if len(frames) == 0:
            raise ValueError("there is no picture to show: step the environment first")
        if not 0 < fps <= 1000:
            raise ValueError(f"fps is {fps}: it must be above 0, and at most 1000")
        first = np.asarray(frames[0])
        for index, frame in enumerate(map(np.asarray, frames)):
            if frame.dtype != np.uint8 or frame.ndim != 3 or frame.shape[2] != 3 or 0 in frame.shape:
                raise ValueError(
                    f"picture {index} is of type {frame.dtype} and shape {frame.shape}: it must be uint8, of shape (height, width, 3)"
                )
            if frame.shape != first.shape:
                raise ValueError(f"picture {index} has the shape {frame.shape}, and the first one has {first.shape}")
        self.frames, self.fps = list(frames), fps
        self.height, self.width = first.shape[:2]

    def png(self) -> bytes:
        """A PNG file; of several pictures an animated one, which repeats for ever."""
        return b"\x89PNG\r\n\x1a\n" + b"".join(self._chunks())

    _repr_png_ = png

    def _chunks(self) -> Iterator[bytes]:
        yield _chunk(b"IHDR", struct.pack(">IIBBBBB", self.width, self.height, 8, 2, 0, 0, 0))
        is_animated, number = len(self.frames) > 1, 0
        if is_animated:
            yield _chunk(b"acTL", struct.pack(">II", len(self.frames), 0))
        for index, frame in enumerate(self.frames):
            if is_animated:
                delay = round(1000 / self.fps), 1000
                yield _chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, self.width, self.height, 0, 0, *delay, 0, 0))
                number += 1
            # each row begins with the number of its filter: 0, none
            rows = np.zeros((self.height, 1 + 3 * self.width), np.uint8)
            rows[:, 1:] = np.asarray(frame).reshape(self.height, -1)
            data = zlib.compress(rows.tobytes(), 6)
            if index == 0:
                yield _chunk(b"IDAT", data)
            else:
                yield _chunk(b"fdAT", struct.pack(">I", number) + data)
                number += 1
        yield _chunk(b"IEND", b"")

    def __repr__(self) -> str:
        size = f"{self.width}x{self.height} pixels"
        if len(self.frames) == 1:
            return f"<a picture of {size}>"
        return f"<{len(self.frames)} pictures of {size}, {self.fps:g} in a second>"


def show(what: Any, fps: float | None = None) -> Pictures:
    """Pictures as the value of a cell.

    Args:
        what: An environment or a vector, which is rendered; or a picture or a list of pictures, as ``render`` returns them. With
            the render mode ``"rgb_array_list"`` an environment gives all pictures since the last call, as an animation.
        fps: How many are shown in a second; those of the environment, or 30, unless given.

    Raises:
        ValueError: for what is no picture, such as the text of the render mode ``"ansi"``.
    """
    if isinstance(what, (gymnasium.Env, gymnasium.vector.VectorEnv)):
        fps = fps or what.metadata.get("render_fps")
        mode, made = what.render_mode, what
        what = made.render()
        if what is None or isinstance(what, str):
            raise ValueError(f'the environment has the render mode {mode!r}: make it with render_mode="rgb_array" or "rgb_array_list"')
    is_one = isinstance(what, np.ndarray) and what.ndim == 3
    return Pictures([what] if is_one else what, fps or 30)
