"""LunarLander, BipedalWalker and CarRacing: Gymnasium's classes, with their attributes."""

from __future__ import annotations

import json
import operator
from collections.abc import Callable
from importlib import import_module
from itertools import pairwise
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym._bodies import Body, Car, Joint, Leg, World
from rustgym._class_env import TunableEnv
from rustgym._errors import ResetNeeded
from rustgym._json import brief
from rustgym._live import Live, same
from rustgym._modules import forwarder
from rustgym._pictures import IsOpen, OfPicture, ReadOnlyList, absent
from rustgym.env import entropy

__all__ = ["BipedalWalker", "CarRacing", "LunarLander", "Terrain"]

# a package, as in Gymnasium: `rustgym._modules` finds the modules below it
__path__: list[str] = []
__getattr__ = forwarder(__name__)


class Box2DEnv(TunableEnv):
    """An environment of bodies in a physics engine."""

    _constants = frozenset({"continuous", "physics"})

    screen, clock, isopen = OfPicture(until="window"), OfPicture(until="render"), IsOpen(until="window")

    def _episode(self) -> dict[str, Any]:
        episode: dict[str, Any] | None = self._take_apart()[1]
        if episode is None:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        return episode

    @property
    def world(self) -> World:
        """The world of the physics engine."""
        return World(self)

    def _set(self, change: Callable[[dict[str, Any]], None]) -> None:
        """Changes the stored episode by ``change``, and continues from it."""
        whole, episode = self._take_apart()
        if episode is None:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        change(episode)
        self._go_on_from(whole)


_NOTHING: Any = object()


def _field(name: str, kind: Callable[[Any], Any], doc: str, before_reset: Any = _NOTHING) -> property:
    """A property for a number or flag of the episode, which can be set.

    Args:
        before_reset: Gymnasium's value before the first reset, which overwrites it. Leave it out if there is none.
    """

    def get(self: Box2DEnv) -> Any:
        if before_reset is not _NOTHING and not self._was_reset():
            return self.__dict__.get(name, before_reset)
        value = self._episode()[name]
        return None if value is None else kind(value)

    def put(self: Box2DEnv, value: Any) -> None:
        if before_reset is not _NOTHING and not self._was_reset():
            self.__dict__[name] = value
            return
        try:
            self._set(lambda episode: episode.update({name: None if value is None else kind(value)}))
        except ValueError as error:
            raise ValueError(f"{name} of this {self.env_id} cannot be {brief(value)} now") from error

    return property(get, put, doc=doc)


class LunarLander(Box2DEnv):
    """Land a craft on a pad."""

    _id = "LunarLander-v3"

    game_over = _field("game_over", bool, "Whether the hull has touched the ground.")
    prev_shaping = _field("prev_shaping", np.float64, "The potential of the last state, of which a reward is a difference.")

    _constants = Box2DEnv._constants | {"helipad_x1", "helipad_x2", "helipad_y"}
    _beside = {"prev_reward": lambda self: None}
    _absent = absent("surf") | {
        "moon": "in Gymnasium it is a body of Box2D; sky_polys has the heights of the ground",
        "particles": "the flames are a part of the pictures alone: render() returns the picture",
    }

    enable_wind: bool

    #: Whether the wind was turned on in an episode that began without wind.
    _lacks_wind = False

    @property
    def helipad_x1(self) -> float:
        """The left end of the pad, in m."""
        self._episode()
        return 8.0

    @property
    def helipad_x2(self) -> float:
        """The right end of the pad, in m."""
        self._episode()
        return 12.0

    @property
    def helipad_y(self) -> float:
        """The height of the pad, in m."""
        self._episode()
        return 400 / 30 / 4

    @property
    def lander(self) -> Body | None:
        """The hull; ``None`` before the first reset."""
        return Body(self, lambda episode: int(episode["lander"])) if self._was_reset() else None

    @property
    def legs(self) -> list[Leg]:
        """The legs."""
        self._episode()
        return ReadOnlyList(Leg(self, i, i) for i in range(2))

    @property
    def drawlist(self) -> list[Body | None]:
        """The bodies that a picture shows."""
        return ReadOnlyList([self.lander, *self.legs])

    @property
    def sky_polys(self) -> list[list[tuple[float, float]]]:
        """The polygons of the sky, whose first two points are points of the ground."""
        heights = [np.float64(y) for y in self._episode()["smooth_y"]]
        points = [(2.0 * i, y) for i, y in enumerate(heights)]
        top = 400 / 30
        return ReadOnlyList([a, b, (b[0], top), (a[0], top)] for a, b in pairwise(points))

    def _gust(name: str, doc: str) -> property:  # type: ignore[misc]
        def get(self: LunarLander) -> np.int64:
            value = self._episode()[name]
            if value is None:
                raise AttributeError(f"{self.env_id} has no {name}: the episode began without wind")
            return np.int64(value)

        def put(self: LunarLander, value: int) -> None:
            self._set(lambda episode: episode.update({name: operator.index(value)}))
            self._look_for_wind()

        return property(get, put, doc=doc)

    wind_idx = _gust("wind_idx", "The position of the wind in the pattern of gusts.")
    torque_idx = _gust("torque_idx", "The position of the turbulence in the pattern of gusts.")

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        if name == "enable_wind":
            self._look_for_wind()

    def _look_for_wind(self) -> None:
        episode = self._take_apart()[1] if self.enable_wind else None
        lacks = episode is not None and None in (episode["wind_idx"], episode["torque_idx"])
        self.__dict__["_lacks_wind"] = lacks
        self._watch()

    def _watch(self) -> None:
        super()._watch()
        if self._lacks_wind:
            self._set_watched(True)

    def _watched_step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        if self._lacks_wind and not any(self._episode()["ground_contact"]):
            raise ResetNeeded(
                "the episode began without wind, so that its gusts have no position: reset first, or set wind_idx and torque_idx"
            )
        return super()._watched_step(action)

    def _follow(self, is_reset: bool = False) -> None:
        if is_reset:
            self.__dict__["_lacks_wind"] = False
        super()._follow(is_reset)


class Terrain(NamedTuple):
    """The colours of a piece of ground."""

    color1: tuple[int, int, int]
    color2: tuple[int, int, int]


class Ray(NamedTuple):
    """A ray of the lidar."""

    fraction: float
    """The distance to the ground, as a part of the ray's length."""


class BipedalWalker(Box2DEnv):
    """Walk on two legs, over stumps, stairs and pits if ``hardcore``."""

    _id = "BipedalWalker-v3"

    game_over = _field("game_over", bool, "Whether the hull has touched the ground.")
    prev_shaping = _field(
        "prev_shaping", float, "The potential of the last state, of which a reward is a difference.", before_reset=None
    )
    _absent = (
        absent("surf")
        | absent("fd_edge fd_polygon", "in Gymnasium it is a definition of Box2D, from which a reset makes the ground")
        | absent("cloud_poly", "clouds are a part of the pictures alone: render() returns the picture")
    )

    @property
    def terrain(self) -> list[Terrain]:
        """The pieces of the ground, the farthest first: its edges, and the obstacles in white and grey."""
        if not self._was_reset():
            return []
        episode = self._episode()
        obstacles = [Terrain((255, 255, 255), (153, 153, 153))] * len(episode["obstacles"])
        greens = [(76, 255 if i % 2 == 0 else 204, 76) for i in range(len(episode["terrain_y"]) - 1)]
        return ReadOnlyList([*(Terrain(green, green) for green in reversed(greens)), *obstacles])

    @property
    def terrain_poly(self) -> list[tuple[list[tuple[float, float]], tuple[int, int, int]]]:
        """The polygons of the ground, and their colour."""
        edges = pairwise(zip(self.terrain_x, self.terrain_y, strict=True))
        return ReadOnlyList(([a, b, (b[0], 0), (a[0], 0)], (102, 153, 76)) for a, b in edges)

    @property
    def hull(self) -> Body | None:
        """The hull; ``None`` before the first reset."""
        return Body(self, lambda episode: int(episode["hull"])) if self._was_reset() else None

    @property
    def legs(self) -> list[Body]:
        """The upper and the lower part of each leg; the lower ones have ``ground_contact``."""
        self._episode()

        def upper(i: int) -> Body:
            return Body(self, lambda episode: int(episode["legs"][i]))

        return ReadOnlyList([upper(0), Leg(self, 1, 0), upper(2), Leg(self, 3, 1)])

    @property
    def drawlist(self) -> list[Any]:
        """What a picture shows: the ground and the bodies."""
        return ReadOnlyList([*self.terrain, *self.legs, self.hull])

    @property
    def joints(self) -> list[Joint]:
        """The hip and the knee of each leg."""
        self._episode()
        return ReadOnlyList(Joint(self, lambda episode, i=i: int(episode["joints"][i])) for i in range(4))  # type: ignore[misc]

    @property
    def lidar(self) -> list[Ray]:
        """The rays of the last observation."""
        return ReadOnlyList(Ray(fraction) for fraction in self._episode()["lidar"])

    @property
    def lidar_render(self) -> int:
        """The position in the cycle of pictures, one of which shows a ray."""
        return int(self._episode()["pictures"])

    @property
    def terrain_x(self) -> list[float]:
        """The points of the ground, in m."""
        return ReadOnlyList(i * (14 / 30) for i in range(len(self._episode()["terrain_y"])))

    @property
    def terrain_y(self) -> list[float]:
        """The heights of the points of the ground, in m."""
        return ReadOnlyList(np.float64(y) for y in self._episode()["terrain_y"])

    @property
    def scroll(self) -> float:
        """The left edge of a picture, in m."""
        self._episode()
        assert self.hull is not None
        return self.hull.position.x - 600 / 30 / 5


def _score_glyphs() -> str:
    """Pictures of the digits in pygame's font, as JSON of the Rust side's ``ScoreGlyphs``."""
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


class _OfTrack(Live):
    """An attribute that a reset uses to make the track."""

    def __set__(self, env: Any, value: Any) -> None:
        self._hand(env, value)
        env._seen[self.name] = None

    def push(self, env: Any, value: Any, call: str) -> None:
        """Writes changes to the Rust side before a reset. Refuses a step after a change."""
        if same(value, env._seen[self.name]):
            return
        if call == "step" and env._native.is_running():
            raise gymnasium.error.ResetNeeded(f"{self.name} was changed: the track has its colour from the reset, so reset first")
        if call == "reset":
            super().push(env, value, call)


class CarRacing(Box2DEnv):
    """Drive a car around a track, seen from above.

    Args:
        score_font: Whether the score is drawn in pygame's font, as in Gymnasium, instead of this package's own digits. It
            needs pygame; with Gymnasium's version of pygame, observations equal Gymnasium's to the last byte.
        kwargs: The other arguments of the environment.
    """

    _id = "CarRacing-v3"

    def __init__(self, render_mode: str | None = None, *, score_font: bool = False, **kwargs: Any) -> None:
        self._glyphs = _score_glyphs() if score_font else None
        super().__init__(render_mode, **kwargs)
        self._write_score()

    @classmethod
    def _given_there(cls, kwargs: dict[str, Any]) -> dict[str, Any]:
        given = super()._given_there(kwargs)
        given.pop("score_font", None)  # pygame's is the only font there
        return given

    def _write_score(self) -> None:
        if self._glyphs is not None:
            self._native.set_score_glyphs(self._glyphs)

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._write_score()

    def render(self) -> Any:
        """As ``Env.render``; in the mode ``"state_pixels"`` the observation, a ``uint8`` array of shape ``(96, 96, 3)``."""
        return self._native.observation() if self.render_mode == "state_pixels" else super().render()

    clock, surf = OfPicture(until="reset"), OfPicture(until="reset")
    _beside = {"invisible_state_window": lambda self: None, "invisible_video_window": lambda self: None}
    _absent = absent("road road_poly start_alpha", "track has the points of the road") | absent(
        "contactListener_keepref fd_tile", "in Gymnasium it is an object of Box2D"
    )

    #: Whether the native environment was reset only to draw colours, before the user's first reset.
    _has_early_colors = False

    def _was_reset(self) -> bool:
        return super()._was_reset() and not self._has_early_colors

    def _episode(self) -> dict[str, Any]:
        if self._has_early_colors:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        return super()._episode()

    def _follow(self, is_reset: bool = False) -> None:
        if is_reset:
            self.__dict__.pop("_has_early_colors", None)
        super()._follow(is_reset)

    @property
    def car(self) -> Car | None:
        """The car; ``None`` before the first reset."""
        return Car(self) if self._was_reset() else None

    @property
    def state(self) -> npt.NDArray[np.uint8]:
        """The last observation."""
        self._episode()
        observation: npt.NDArray[np.uint8] = self._native.observation()
        return observation

    reward = _field("reward", float, "The return so far.", before_reset=0.0)
    prev_reward = _field(
        "prev_reward", float, "The return at the last step, of which a step's reward is the difference.", before_reset=0.0
    )
    t = _field("t", float, "The time in the episode, in s.")
    tile_visited_count = _field("tile_visited_count", int, "The number of tiles visited.")
    new_lap = _field("new_lap", bool, "Whether the lap is complete.", before_reset=False)

    road_color = _OfTrack(
        lambda self: self._color("road"),
        lambda self, color: self._set_color("road", color),
        outlives_reset=lambda self: not self.domain_randomize,
        outlives_step=True,
        doc="Red, green and blue of the road, 0 to 255. It can be changed before a reset, which makes a track of that colour.",
    )
    bg_color = Live(
        lambda self: self._color("background"),
        lambda self, color: self._set_color("background", color),
        outlives_reset=lambda self: not self.domain_randomize,
        outlives_step=True,
        doc="Red, green and blue of the field, 0 to 255. It can be changed.",
    )
    grass_color = Live(
        lambda self: self._color("grass"),
        lambda self, color: self._set_color("grass", color),
        outlives_reset=lambda self: not self.domain_randomize,
        outlives_step=True,
        doc="Red, green and blue of the patches on the field, 0 to 255. It can be changed.",
    )

    def _color(self, name: str) -> npt.NDArray[Any]:
        if self._take_apart()[1] is None:
            # Gymnasium draws the first colours in its constructor; a reset with `randomize=False` keeps them
            self._native.reset(str(entropy()), None)
            self._native.restore(self._native.snapshot(), False)
            self.__dict__["_has_early_colors"] = True
        color = np.array(super()._episode()["colors"][name])
        return color if self.arguments["domain_randomize"] else color.astype(np.int64)

    def _set_color(self, name: str, color: Any) -> None:
        numbers = np.asarray(color, np.float64)
        if numbers.shape != (3,) or not ((numbers >= 0) & (numbers <= 255)).all():
            raise ValueError(f"a colour is red, green and blue, each 0 to 255, not {color!r}")
        self._color(name)
        self._set(lambda episode: episode["colors"].update({name: numbers.tolist()}))

    @property
    def track(self) -> list[tuple[float, float, float, float]]:
        """The points of the track: angle around the centre, direction, x, y."""
        return ReadOnlyList(tuple(point.values() if isinstance(point, dict) else point) for point in self._episode()["track"])
