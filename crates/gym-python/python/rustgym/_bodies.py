"""Bodies, joints and the world of Box2D's environments, with Box2D's names. They read and write the environment's state."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rustgym._pictures import ReadOnlyList

if TYPE_CHECKING:
    from rustgym.envs.box2d import Box2DEnv

__all__ = ["Body", "Car", "Joint", "Leg", "Vec2", "Wheel", "World"]


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
        """The joint that holds the wheel."""
        return Joint(self._env, lambda episode: int(episode["car"]["wheels"][self._index]["joint"]))


class Car:
    """The car of CarRacing."""

    hull: Body
    wheels: list[Wheel]

    def __init__(self, env: Box2DEnv) -> None:
        hull = Body(env, lambda episode: int(episode["car"]["hull"]))
        self.__dict__.update(hull=hull, wheels=ReadOnlyList(Wheel(env, i) for i in range(4)))

    @property
    def fuel_spent(self) -> float:
        """The fuel of a step, which each step sets to 0 when it ends."""
        return 0.0

    def gas(self, gas: float) -> None:
        """Gives gas, 0 to 1, to the rear wheels: at most 0.1 more than they get already."""
        gas = float(np.clip(gas, 0, 1))
        for wheel in self.wheels[2:]:
            wheel.gas += min(gas - wheel.gas, 0.1)

    def brake(self, brake: float) -> None:
        """Brakes all wheels, 0 to 1."""
        for wheel in self.wheels:
            wheel.brake = brake

    def steer(self, steer: float) -> None:
        """Steers the front wheels, -1 to 1."""
        for wheel in self.wheels[:2]:
            wheel.steer = steer

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{name} of a car cannot be set: the velocities of hull and wheels can")


class Leg(Body):
    """A leg that feels the ground."""

    _index: int

    def __init__(self, env: Box2DEnv, body: int, index: int) -> None:
        super().__init__(env, lambda episode: int(episode["legs"][body]))
        self.__dict__["_index"] = index

    @property
    def ground_contact(self) -> bool:
        """Whether the leg touches the ground."""
        return bool(self._env._episode()["ground_contact"][self._index])
