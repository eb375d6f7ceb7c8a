"""Environments for the tests of the bridge: one for every kind of space, and some with faults."""
import os
import signal
import time

import gymnasium
import numpy as np
from gymnasium import spaces

SPACES = {
    "box": spaces.Box(-1.0, 2.0, (2, 3), np.float64),
    "discrete": spaces.Discrete(5, start=-2),
    "multi_discrete": spaces.MultiDiscrete([3, 4]),
    "multi_binary": spaces.MultiBinary((2, 2)),
    "text": spaces.Text(5),
    "tuple": spaces.Tuple((spaces.Discrete(3), spaces.Box(0, 255, (2,), np.uint8))),
    "dict": spaces.Dict({"b": spaces.Discrete(2), "a": spaces.Box(0.0, 1.0, (1,), np.float32)}),
    "sequence": spaces.Sequence(spaces.Discrete(4)),
    "graph": spaces.Graph(spaces.Box(0.0, 1.0, (2,), np.float32), spaces.Discrete(3)),
    "graph_of_dicts": spaces.Graph(
        spaces.Dict({"b": spaces.Discrete(2), "a": spaces.Text(5)}), spaces.Tuple((spaces.Box(0.0, 1.0, (2,), np.float64), spaces.Text(3)))
    ),
    "one_of": spaces.OneOf((spaces.Discrete(2), spaces.Box(0.0, 1.0, (2,), np.float32))),
    # each with what the ones above leave as it is by default
    "number": spaces.Box(-1.0, 2.0, (), np.float32),
    "picture": spaces.Box(0, 255, (2, 3, 3), np.uint8),
    "several_bounds": spaces.Box(np.array([[-1.0, 0.0]]), np.array([[2.0, 0.5]]), dtype=np.float64),
    "half_bounded": spaces.Box(np.array([-np.inf, 0.0], np.float32), np.array([1.0, np.inf], np.float32)),
    "shifted": spaces.MultiDiscrete([3, 4], dtype=np.int32, start=[1, -2]),
    "grid": spaces.MultiDiscrete([[3, 4], [1, 2]], dtype=np.uint8),
    "bits": spaces.MultiBinary(3),
    "letters": spaces.Text(4, min_length=2, charset="abc"),
    "stacked": spaces.Sequence(spaces.Discrete(4), stack=True),
    "stacked_arrays": spaces.Sequence(spaces.Box(0.0, 1.0, (2,), np.float32), stack=True),
    "arrays": spaces.Sequence(spaces.Box(0.0, 1.0, (2,), np.float32)),
    "nested": spaces.Dict({"b": spaces.Tuple((spaces.Discrete(2), spaces.MultiBinary(2))), "a": spaces.Dict({"c": spaces.Discrete(3)})}),
    "nodes": spaces.Graph(spaces.Discrete(3), None),
    # classes of one name
    "namesakes": spaces.Tuple((type("Mine", (spaces.Discrete,), {})(3), type("Mine", (spaces.MultiBinary,), {})(2))),
}


class Echo(gymnasium.Env):
    """Observes the last action; the action space can be of any kind."""

    metadata = {"render_modes": ["rgb_array", "ansi"], "render_fps": 7}

    def __init__(self, kind="discrete", render_mode=None):
        self.observation_space = self.action_space = SPACES[kind]
        self.render_mode = render_mode

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.action_space.seed(seed)
        self.level = seed or 0
        return self.action_space.sample(), {"options": str(options), "object": object(), "seed": seed}

    def step(self, action):
        print("this does not disturb the pipes")
        return action, np.float32(0.5), np.bool_(False), False, {"nested": {"list": [1, 2.5, None]}, "array": np.eye(2), "space": str(self.action_space)}

    def render(self):
        return "a text" if self.render_mode == "ansi" else np.full((4, 6, 3), self.level, np.uint8)


class Bad(gymnasium.Env):
    """Does what the action asks for, such as raising an error."""

    observation_space = spaces.Discrete(2)
    action_space = spaces.Discrete(6)

    def reset(self, *, seed=None, options=None):
        if options and "grow" in options:
            self.observation_space = spaces.Box(0.0, 1.0, (3,))
            return np.zeros(3, np.float32), {}
        return 0, {"pid": os.getpid()}

    def step(self, action):
        if action == 1:
            raise ValueError("it does not like 1")
        if action == 2:
            os._exit(7)
        if action == 3:
            time.sleep(3600)
        if action == 4:
            raise SystemExit(1)
        if action == 5:
            os.kill(os.getpid(), 11)
        return 0, 0.0, False, False, {}


class Mute(Exception):
    def __str__(self):
        raise RuntimeError("no words")


class Whim(spaces.Space):
    """Texts, drawn by the space's own generator."""

    def __init__(self):
        super().__init__(None, str)

    def sample(self, mask=None, probability=None):
        return str(self.np_random.integers(1_000_000))

    def contains(self, x):
        return isinstance(x, str)


class Odd(gymnasium.Env):
    """Returns or raises something invalid in each step; the action selects what."""

    STEPS = {
        "reward text": lambda self: ("1", "1.0", False, False, {}),
        "reward none": lambda self: ("1", None, False, False, {}),
        "flag": lambda self: ("1", 0.0, "no", False, {}),
        "info": lambda self: ("1", 0.0, False, False, [1]),
        "four": lambda self: ("1", 0.0, False, {}),
        "interrupt": lambda self: self.throw(KeyboardInterrupt()),
        "exit": lambda self: self.throw(GeneratorExit()),
        "mute": lambda self: self.throw(Mute()),
        "long": lambda self: self.throw(ValueError("x" * 5_000_000)),
        "signal": lambda self: os.kill(os.getpid(), signal.SIGINT),
        "exit code": lambda self: self.throw(SystemExit(Mute())),
        "observation": lambda self: (1, 0.0, False, False, {}),
        "much": lambda self: ("1", 0.0, False, False, {"much": np.zeros(1 << 30, np.uint8)}),
        "info keys": lambda self: ("1", 0.0, False, False, {Mute(): 1}),
        "fine": lambda self: (self.observation_space.sample(), np.array([0.5]), np.int64(1), 0, {}),
    }
    action_space = spaces.Discrete(len(STEPS))

    def __init__(self, hangs=False):
        self.observation_space = Whim()
        self.hangs = hangs

    def throw(self, error):
        raise error

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.observation_space.seed(3)
        return "alone" if options else (self.observation_space.sample(), {"pid": os.getpid()})

    def step(self, action):
        return list(self.STEPS.values())[action](self)

    def close(self):
        if self.hangs:
            time.sleep(3600)
        raise OSError("it does not close")


class Half(gymnasium.Env):
    """Observes float16. The info contains the type of the received action."""

    observation_space = spaces.Box(-2, 2, (2,), np.float16)
    action_space = spaces.Box(-1, 1, (2,), np.float32)

    def reset(self, *, seed=None, options=None):
        return np.array([0.5, -1], np.float16), {}

    def step(self, action):
        if action[0] > 5:
            return np.array(["a", "b"]), 0.0, False, False, {}
        return np.asarray(action, np.float16), 0.0, False, False, {"type": str(np.asarray(action).dtype), "kind": type(action).__name__}


class Observes(gymnasium.Env):
    """Observes the given elements, which may lie outside of its space."""

    OBSERVATIONS = {
        "Discrete": (spaces.Discrete(3), [1.5, "1", None]),
        "Box": (spaces.Box(0, 9, (2,), np.uint8), [[0.5, 1], ["1", "2"], [300, 0], [1, 2, 3], None, [None, 1], [1j, 0]]),
        "Text": (spaces.Text(5), [5, b"x"]),
        "Tuple": (spaces.Tuple((spaces.Discrete(2), spaces.Discrete(2))), [(1,), (1, 1, 1), 1, None]),
        "Dict": (spaces.Dict({"a": spaces.Discrete(2)}), [{}, {"a": "x"}, [1], {"a": 1, "b": 1}]),
        "Graph": (SPACES["graph"], [None, spaces.GraphInstance(None, None, None)]),
        "OneOf": (SPACES["one_of"], [(2, 1), (-3, 1), 0]),
    }

    def __init__(self, kind):
        self.observation_space, self.bad = self.OBSERVATIONS[kind]
        self.action_space = spaces.Discrete(len(self.bad))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.observation_space.sample(), {}

    def step(self, action):
        return self.bad[action], 0.0, False, False, {}


class Widens(gymnasium.Env):
    """Counts its steps in its info. A reset option selects wider bounds or other actions."""

    def __init__(self, start=0):
        self.observation_space = spaces.Box(0.0, 1.0, (1,), np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.steps = self.start = start

    def told(self):
        return np.zeros(1, np.float32), {"steps": self.steps}

    def reset(self, *, seed=None, options=None):
        self.steps = self.start
        if options and "wide" in options:
            self.observation_space = spaces.Box(0.0, 9.0, (1,), np.float32)
        if options and "actions" in options:
            self.action_space = spaces.Discrete(3)
        self.late = (options or {}).get("late")
        return self.told()

    def step(self, action):
        self.steps += 1
        if self.late == "equal":
            self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        if self.late == "actions" and self.steps == self.start + 2:
            self.action_space = spaces.Box(-1.0, 0.5, (2,), np.float32)
        if self.late == "observations" and self.steps == self.start + 2:
            self.observation_space = spaces.Box(0.0, 2.0, (1,), np.float32)
        observation, info = self.told()
        return observation, 0.0, False, False, info


gymnasium.register("bridge/Widens-v0", Widens)
gymnasium.register("bridge/Observes-v0", Observes)
gymnasium.register("bridge/Odd-v0", Odd)
gymnasium.register("bridge/Half-v0", Half)
gymnasium.register("bridge/Echo-v0", Echo)
gymnasium.register("bridge/Bad-v0", Bad)


class Large(gymnasium.Env):
    """Observes the given number of bytes."""

    action_space = spaces.Discrete(2)

    def __init__(self, mebibytes=32, dtype="uint8"):
        dtype = np.dtype(dtype)
        shape = (mebibytes, 1024, 1024 // dtype.itemsize)
        self.observation_space = spaces.Box(0, 255, shape, dtype)
        self.frame = np.full(shape, 7, dtype)

    def reset(self, *, seed=None, options=None):
        return self.frame, {}

    def step(self, action):
        self.frame[0, 0, 0] += 1
        return self.frame, 0.0, False, False, {}


gymnasium.register("bridge/Large-v0", Large)


class Lies(gymnasium.Env):
    """Has an invalid space, metadata or picture; an argument selects the fault."""

    metadata = {"render_modes": ["rgb_array", "ansi"], "render_fps": 7}

    def __init__(self, fault, render_mode=None):
        self.observation_space, self.action_space = spaces.Discrete(3), spaces.Discrete(3)
        self.fault, self.render_mode, self.steps = fault, render_mode, 0
        if fault == "no action space":
            self.action_space = None
        elif fault == "n":
            self.observation_space.n = "many"
        elif fault == "keys":
            self.observation_space = spaces.Dict([(0, spaces.Discrete(2))])
        elif fault == "size":
            self.observation_space = spaces.Box(0.0, 1.0, (2,), np.float32)
            self.observation_space.low = self.observation_space.high = np.zeros((), np.float32)
            self.observation_space._shape = (1 << 31, 1 << 31)
        elif fault == "bounds":
            self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
            self.action_space.low = np.array([np.nan, 0], np.float32)
        elif fault == "metadata":
            self.metadata = ["rgb_array"]
        elif fault == "precision":
            self.observation_space = spaces.Box(-np.inf, np.inf, (2,), np.float32)

    def reset(self, *, seed=None, options=None):
        return (0 if self.fault != "precision" else np.zeros(2, np.float32)), {}

    def step(self, action):
        self.steps += 1
        info = {"steps": self.steps}
        if self.fault == "in place":
            self.observation_space.n = 5
        if self.fault == "action in place":
            self.action_space.n = 2
        if self.fault == "cycle":
            info["left"] = info["right"] = info
        if self.fault == "double":
            for _ in range(30):
                info = {"left": info, "right": info}
        if self.fault == "fork" and os.fork() == 0:
            raise SystemExit(0)
        if self.fault == "fork quietly":
            os.fork()
        if self.fault == "precision":
            return np.array([1e300, 0]), 0.0, False, False, info
        return 0, 0.0, False, False, info

    def render(self):
        return {"text": "a text", "nothing": None, "empty": np.zeros((0, 3, 3), np.uint8)}.get(self.fault, np.zeros((2, 2, 3), np.uint8))


gymnasium.register("bridge/Lies-v0", Lies)
