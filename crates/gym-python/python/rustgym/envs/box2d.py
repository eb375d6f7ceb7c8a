"""LunarLander, BipedalWalker and CarRacing: Gymnasium's classes, with their attributes."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym._live import Live, same
from rustgym._modules import forwarder
from rustgym.env import TunableEnv, entropy

__all__ = ["BipedalWalker", "CarRacing", "LunarLander", "Terrain"]

# a package, as in Gymnasium: `rustgym._modules` finds the modules below it
__path__: list[str] = []
__getattr__ = forwarder(__name__)


class Box2DEnv(TunableEnv):
    """An environment of bodies in a physics engine."""

    _fixed = frozenset({"continuous", "physics"})

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
        self._native.restore(json.dumps(whole), self._native.is_running())


def _field(name: str, kind: Callable[[Any], Any], doc: str) -> property:
    """A property for a number or flag of the episode, which can be set."""

    def get(self: Box2DEnv) -> Any:
        value = self._episode()[name]
        return None if value is None else kind(value)

    def put(self: Box2DEnv, value: Any) -> None:
        try:
            self._set(lambda episode: episode.update({name: None if value is None else kind(value)}))
        except ValueError as error:
            raise ValueError(f"{name} of this {self.env_id} cannot be {value!r} now") from error

    return property(get, put, doc=doc)


class Vec2(NamedTuple):
    """A vector in the plane, with the operators of Box2D's, in single precision."""

    x: float
    y: float

    @classmethod
    def _of(cls, x: Any, y: Any) -> Vec2:
        return cls(float(np.float32(x)), float(np.float32(y)))

    @property
    def length(self) -> float:
        """The Euclidean norm."""
        x, y = np.float32(self.x), np.float32(self.y)
        return float(np.sqrt(x * x + y * y))

    def __add__(self, other: Any) -> Vec2:
        return Vec2._of(self.x + other[0], self.y + other[1])

    def __sub__(self, other: Any) -> Vec2:
        return Vec2._of(self.x - other[0], self.y - other[1])

    def __mul__(self, factor: Any) -> Vec2:
        return Vec2._of(self.x * factor, self.y * factor)

    __rmul__ = __mul__

    def __truediv__(self, divisor: float) -> Vec2:
        return Vec2._of(self.x / divisor, self.y / divisor)

    def __neg__(self) -> Vec2:
        return Vec2(-self.x, -self.y)


class Body:
    """A body of the physics engine. Its velocities can be set; the rest is read-only."""

    _env: Box2DEnv
    _find: Callable[[dict[str, Any]], int]

    def __init__(self, env: Box2DEnv, find: Callable[[dict[str, Any]], int]) -> None:
        self.__dict__.update(_env=env, _find=find)

    def _slot(self, episode: dict[str, Any]) -> dict[str, Any]:
        (engine,) = episode["world"]["engine"].values()
        slot: dict[str, Any] = engine["bodies"]["slots"][self._find(episode)]
        return slot

    def _read(self) -> dict[str, Any]:
        return self._slot(self._env._episode())

    @property
    def position(self) -> Vec2:
        """The body's origin, in m."""
        return Vec2(*self._read()["xf"]["translation"])

    @property
    def worldCenter(self) -> Vec2:  # noqa: N802 - Box2D's name
        """The centre of mass, in m."""
        return Vec2(*self._read()["sweep"]["c"])

    @property
    def angle(self) -> float:
        """The angle, in rad."""
        return float(self._read()["sweep"]["a"])

    @property
    def mass(self) -> float:
        """The mass, in kg."""
        return float(self._read()["mass"])

    @property
    def awake(self) -> bool:
        """Whether the engine moves the body."""
        return bool(self._read()["awake"])

    @property
    def linearVelocity(self) -> Vec2:  # noqa: N802 - Box2D's name
        """The velocity of the centre of mass, in m/s."""
        return Vec2(*self._read()["velocity"])

    @linearVelocity.setter
    def linearVelocity(self, velocity: Any) -> None:  # noqa: N802 - Box2D's name
        x, y = velocity
        self._move(velocity=[float(np.float32(x)), float(np.float32(y))])

    @property
    def angularVelocity(self) -> float:  # noqa: N802 - Box2D's name
        """The angular velocity, in rad/s."""
        return float(self._read()["angular_velocity"])

    @angularVelocity.setter
    def angularVelocity(self, velocity: float) -> None:  # noqa: N802 - Box2D's name
        self._move(angular_velocity=float(np.float32(velocity)))

    def ApplyForceToCenter(self, force: Any, wake: bool = True) -> None:  # noqa: N802 - Box2D's name
        """Adds a force, in N, for the next step."""
        self._add(wake, lambda body: {"force": np.float32(body["force"]) + np.float32(force)})

    def ApplyTorque(self, torque: float, wake: bool = True) -> None:  # noqa: N802 - Box2D's name
        """Adds a torque, in N m, for the next step."""
        self._add(wake, lambda body: {"torque": np.float32(body["torque"]) + np.float32(torque)})

    def ApplyLinearImpulse(self, impulse: Any, point: Any, wake: bool = True) -> None:  # noqa: N802 - Box2D's name
        """Adds an impulse, in N s, at a point of the world."""

        def change(body: dict[str, Any]) -> dict[str, Any]:
            push, center = np.asarray(impulse, np.float32), np.asarray(body["sweep"]["c"], np.float32)
            arm = np.asarray(point, np.float32) - center
            turn = np.float32(body["inv_inertia"]) * (arm[0] * push[1] - arm[1] * push[0])
            velocity = np.asarray(body["velocity"], np.float32) + np.float32(body["inv_mass"]) * push
            return {"velocity": velocity, "angular_velocity": np.float32(body["angular_velocity"]) + turn}

        self._add(wake, change)

    def ApplyAngularImpulse(self, impulse: float, wake: bool = True) -> None:  # noqa: N802 - Box2D's name
        """Adds an angular impulse, in N m s."""
        turn = np.float32(impulse)
        self._add(
            wake,
            lambda body: {"angular_velocity": np.float32(body["angular_velocity"]) + np.float32(body["inv_inertia"]) * turn},
        )

    def _add(self, wake: bool, change: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
        body = self._read()
        if wake or body["awake"]:
            self._move(wake, **{name: value.tolist() for name, value in change(body).items()})

    def _move(self, wake: bool | None = None, **fields: Any) -> None:
        def change(episode: dict[str, Any]) -> None:
            slot = self._slot(episode)
            slot.update(fields)
            if np.any([*fields.values()]) if wake is None else wake and not slot["awake"]:
                slot.update(awake=True, sleep_time=0.0)

        self._env._set(change)

    def __setattr__(self, name: str, value: Any) -> None:
        found = getattr(type(self), name, None)
        if not isinstance(found, property) or found.fset is None:
            names = dir(type(self))
            free = [n for n in names if isinstance(f := getattr(type(self), n), property) and f.fset is not None]
            raise AttributeError(f"{name} of a {type(self).__name__.lower()} cannot be set: {', '.join(free)} can")
        object.__setattr__(self, name, value)


class World:
    """The world of the physics engine."""

    _env: Box2DEnv

    def __init__(self, env: Box2DEnv) -> None:
        self.__dict__["_env"] = env

    @property
    def gravity(self) -> Vec2:
        """The gravity, in m/s². It can be set, until the next reset."""
        (engine,) = self._env._episode()["world"]["engine"].values()
        return Vec2(*engine["gravity"])

    @gravity.setter
    def gravity(self, gravity: Any) -> None:
        x, y = np.asarray(gravity, np.float32).tolist()

        def change(episode: dict[str, Any]) -> None:
            (engine,) = episode["world"]["engine"].values()
            engine["gravity"] = [x, y]

        self._env._set(change)

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "gravity":
            raise AttributeError(f"{name} of the world cannot be set: gravity can")
        object.__setattr__(self, name, value)


class Joint:
    """A hinge with a motor between two bodies. Read-only."""

    __slots__ = ("_env", "_find")

    def __init__(self, env: Box2DEnv, find: Callable[[dict[str, Any]], int]) -> None:
        self._env, self._find = env, find

    def _read(self) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
        episode = self._env._episode()
        (engine,) = episode["world"]["engine"].values()
        joint, bodies = engine["joints"]["slots"][self._find(episode)], engine["bodies"]["slots"]
        return joint, bodies[joint["body_a"]], bodies[joint["body_b"]]

    @property
    def angle(self) -> float:
        """The angle, in rad."""
        joint, a, b = self._read()
        return float(np.float32(b["sweep"]["a"]) - np.float32(a["sweep"]["a"]) - np.float32(joint["reference_angle"]))

    @property
    def speed(self) -> float:
        """The angular velocity, in rad/s."""
        _, a, b = self._read()
        return float(np.float32(b["angular_velocity"]) - np.float32(a["angular_velocity"]))

    @property
    def motorSpeed(self) -> float:  # noqa: N802 - Box2D's name
        """The angular velocity that the motor aims at, in rad/s."""
        return float(self._read()[0]["motor_speed"])

    @property
    def maxMotorTorque(self) -> float:  # noqa: N802 - Box2D's name
        """The motor's largest torque, in N m."""
        return float(self._read()[0]["max_motor_torque"])


class Wheel(Body):
    """A wheel of the car."""

    _index: int

    def __init__(self, env: Box2DEnv, index: int) -> None:
        super().__init__(env, lambda episode: int(episode["car"]["wheels"][index]["body"]))
        self.__dict__["_index"] = index

    @staticmethod
    def _own(name: str, doc: str) -> property:
        def get(self: Wheel) -> float:
            return float(self._env._episode()["car"]["wheels"][self._index][name])

        def put(self: Wheel, value: float) -> None:
            self._env._set(lambda episode: episode["car"]["wheels"][self._index].update({name: float(value)}))

        return property(get, put, doc=doc)

    gas = _own("gas", "How much gas it gets, 0 to 1.")
    brake = _own("brake", "How much it brakes, 0 to 1.")
    steer = _own("steer", "The angle to which it is steered, in rad.")
    phase = _own("phase", "Its angle around the axle, in rad.")
    omega = _own("omega", "Its angular velocity around the axle, in rad/s.")

    @property
    def joint(self) -> Joint:
        """The joint that holds it."""
        return Joint(self._env, lambda episode: int(episode["car"]["wheels"][self._index]["joint"]))


class Car:
    """The car of CarRacing."""

    def __init__(self, env: Box2DEnv) -> None:
        self.hull = Body(env, lambda episode: int(episode["car"]["hull"]))
        self.wheels = [Wheel(env, i) for i in range(4)]


class Leg(Body):
    """A leg that feels the ground."""

    _index: int

    def __init__(self, env: Box2DEnv, body: int, index: int) -> None:
        super().__init__(env, lambda episode: int(episode["legs"][body]))
        self.__dict__["_index"] = index

    @property
    def ground_contact(self) -> bool:
        """Whether it touches the ground."""
        return bool(self._env._episode()["ground_contact"][self._index])


class LunarLander(Box2DEnv):
    """Land a craft on a pad."""

    _id = "LunarLander-v3"

    wind_idx = _field("wind_idx", int, "The position of the wind in the pattern of gusts.")
    torque_idx = _field("torque_idx", int, "The position of the turbulence in the pattern of gusts.")
    game_over = _field("game_over", bool, "Whether the hull has touched the ground.")
    prev_shaping = _field("prev_shaping", float, "The potential of the last state, of which a reward is a difference.")

    #: The pad: its ends and its height, in m.
    helipad_x1, helipad_x2, helipad_y = 8.0, 12.0, 400 / 30 / 4
    _constants = frozenset({"helipad_x1", "helipad_x2", "helipad_y"})

    @property
    def lander(self) -> Body:
        """The hull."""
        return Body(self, lambda episode: int(episode["lander"]))

    @property
    def legs(self) -> list[Leg]:
        """The legs."""
        return [Leg(self, i, i) for i in range(2)]


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

    @property
    def terrain(self) -> list[Terrain]:
        """The pieces of the ground, the farthest first: its edges, and the obstacles in white and grey."""
        episode = self._episode()
        obstacles = [Terrain((255, 255, 255), (153, 153, 153))] * len(episode["obstacles"])
        greens = [(76, 255 if i % 2 == 0 else 204, 76) for i in range(len(episode["terrain_y"]) - 1)]
        return [*(Terrain(green, green) for green in reversed(greens)), *obstacles]

    game_over = _field("game_over", bool, "Whether the hull has touched the ground.")
    prev_shaping = _field("prev_shaping", float, "The potential of the last state, of which a reward is a difference.")

    @property
    def hull(self) -> Body:
        """The hull."""
        return Body(self, lambda episode: int(episode["hull"]))

    @property
    def legs(self) -> list[Body]:
        """The upper and the lower part of each leg; the lower ones have ``ground_contact``."""

        def upper(i: int) -> Body:
            return Body(self, lambda episode: int(episode["legs"][i]))

        return [upper(0), Leg(self, 1, 0), upper(2), Leg(self, 3, 1)]

    @property
    def joints(self) -> list[Joint]:
        """The hip and the knee of each leg."""
        return [Joint(self, lambda episode, i=i: int(episode["joints"][i])) for i in range(4)]  # type: ignore[misc]

    @property
    def lidar(self) -> list[Ray]:
        """The rays of the last observation."""
        return [Ray(fraction) for fraction in self._episode()["lidar"]]

    @property
    def terrain_x(self) -> list[float]:
        """The points of the ground, in m."""
        return [i * (14 / 30) for i in range(len(self._episode()["terrain_y"]))]

    @property
    def terrain_y(self) -> list[float]:
        """The heights of the points of the ground, in m."""
        return [float(y) for y in self._episode()["terrain_y"]]

    @property
    def scroll(self) -> float:
        """The left edge of a picture, in m."""
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

    def _write_score(self) -> None:
        if self._glyphs is not None:
            self._native.set_score_glyphs(self._glyphs)

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._write_score()

    def render(self) -> Any:
        """As ``Env.render``; in the mode ``"state_pixels"`` the observation, a ``uint8`` array of shape ``(96, 96, 3)``."""
        return self._native.observation() if self.render_mode == "state_pixels" else super().render()

    @property
    def car(self) -> Car:
        """The car."""
        return Car(self)

    reward = _field("reward", float, "The return so far.")
    prev_reward = _field("prev_reward", float, "The return at the last step, of which a step's reward is the difference.")
    t = _field("t", float, "The time in the episode, in s.")
    tile_visited_count = _field("tile_visited_count", int, "The number of tiles visited.")
    new_lap = _field("new_lap", bool, "Whether the lap is complete.")

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
        color = np.array(self._episode()["colors"][name])
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
        return [tuple(point.values() if isinstance(point, dict) else point) for point in self._episode()["track"]]
