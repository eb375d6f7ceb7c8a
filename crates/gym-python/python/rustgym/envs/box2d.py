"""LunarLander, BipedalWalker and CarRacing: Gymnasium's classes, with their attributes."""

from __future__ import annotations

import json
from importlib import import_module
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym.env import TunableEnv, entropy

__all__ = ["BipedalWalker", "CarRacing", "LunarLander", "Terrain"]


class Box2DEnv(TunableEnv):
    """An environment of bodies in a physics engine."""

    _fixed = frozenset({"continuous", "physics"})

    def _episode(self) -> dict[str, Any]:
        episode: dict[str, Any] | None = self._take_apart()[1]
        if episode is None:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        return episode


class LunarLander(Box2DEnv):
    """Land a craft on a pad."""

    _id = "LunarLander-v3"

    @property
    def wind_idx(self) -> int:
        """The position of the wind in the pattern of gusts."""
        return int(self._episode()["wind_idx"])

    @property
    def torque_idx(self) -> int:
        """The position of the turbulence in the pattern of gusts."""
        return int(self._episode()["torque_idx"])

    @property
    def game_over(self) -> bool:
        """Whether the hull has touched the ground."""
        return bool(self._episode()["game_over"])


class Terrain(NamedTuple):
    """The colours of a piece of ground."""

    color1: tuple[int, int, int]
    color2: tuple[int, int, int]


class BipedalWalker(Box2DEnv):
    """Walk on two legs, over stumps, stairs and pits if ``hardcore``."""

    _id = "BipedalWalker-v3"

    @property
    def terrain(self) -> list[Terrain]:
        """The pieces of the ground, the farthest first: its edges, and the obstacles in white and grey."""
        episode = self._episode()
        obstacles = [Terrain((255, 255, 255), (153, 153, 153))] * len(episode["obstacles"])
        greens = [(76, 255 if i % 2 == 0 else 204, 76) for i in range(len(episode["terrain_y"]) - 1)]
        return [*(Terrain(green, green) for green in reversed(greens)), *obstacles]

    @property
    def game_over(self) -> bool:
        """Whether the hull has touched the ground."""
        return bool(self._episode()["game_over"])


def _score_glyphs() -> str:
    """Pictures of the digits of pygame's font, in the form of the Rust side's ``ScoreGlyphs``."""
    try:
        pygame: Any = import_module("pygame")
    except ImportError as error:
        raise gymnasium.error.DependencyNotInstalled("score_font needs pygame: `pip install pygame-ce`") from error
    pygame.font.init()
    font = pygame.font.Font(pygame.font.get_default_font(), 42)
    glyphs = {}
    for character in "-0123456789":
        picture = font.render(character, True, (255, 255, 255), (0, 0, 0))
        gray = pygame.surfarray.array3d(picture)[:, 3:35, 0]
        glyphs[character] = [gray.shape[0], gray.T.tobytes().hex()]
    return json.dumps(glyphs)


class CarRacing(Box2DEnv):
    """Drive a car around a track, seen from above.

    Args:
        score_font: Whether the score is written in pygame's font, as Gymnasium writes it, instead of digits of our own. Needs
            pygame; with the pygame that Gymnasium uses, observations are Gymnasium's to the last byte.
        kwargs: The other arguments of the environment.
    """

    _id = "CarRacing-v3"

    def __init__(self, render_mode: str | None = None, *, score_font: bool = False, **kwargs: Any) -> None:
        self._glyphs = _score_glyphs() if score_font else None
        super().__init__(render_mode, **kwargs)
        self._write_score()

    def _write_score(self) -> None:
        if self._glyphs is not None:
            self._native.set_score_glyphs(self._glyphs)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._write_score()

    def render(self) -> Any:
        """As ``Env.render``; for ``"state_pixels"`` the observation, a ``uint8`` array of shape ``(96, 96, 3)``."""
        return self._native.observation() if self.render_mode == "state_pixels" else super().render()

    @property
    def road_color(self) -> npt.NDArray[np.float64]:
        """Red, green and blue of the road, 0 to 255."""
        return self._color("road")

    @property
    def bg_color(self) -> npt.NDArray[np.float64]:
        """Red, green and blue of the field, 0 to 255."""
        return self._color("background")

    @property
    def grass_color(self) -> npt.NDArray[np.float64]:
        """Red, green and blue of the patches on the field, 0 to 255."""
        return self._color("grass")

    def _color(self, name: str) -> npt.NDArray[np.float64]:
        if self._take_apart()[1] is None:
            # Gymnasium draws the first colours in its constructor; a reset with `randomize=False` keeps them
            self._native.reset(str(entropy()), None)
            self._native.restore(self._native.snapshot(), False)
        return np.array(self._episode()["colors"][name])
