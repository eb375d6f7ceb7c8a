"""Serves one Python environment over the pipes that the Rust side opened: requests on file 0, replies on file 1.

A frame is its length (4 bytes, little endian) and that many bytes. A request is an operation (1 byte) and values; a
reply is 0 and values, or 1 and a dict that describes an exception. Values have the form that `wire.rs` documents. The
numbers of a large array are not copied into the reply: they are written to the pipe from the array's memory.
"""
import copy
import importlib
import json
import math
import os
import reprlib
import signal
import struct
import sys
import threading

NULL, FALSE, TRUE, INT, FLOAT, TEXT, ARRAY, TUPLE, DICT, GRAPH, ONE_OF = range(11)
MAKE, RESET, STEP, RENDER, DUMP, LOAD, CLOSE = range(7)
DTYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]
LONGEST = 1 << 30  # the largest frame in bytes, as in worker.rs
LARGE = 1 << 14  # arrays of at least this number of bytes are written without copying
DEEPEST = 32  # the largest depth of lists and dicts in `info`
MOST_PARTS = 1_000_000  # the largest number of numbers, texts, arrays, lists and dicts in `info`
U32, I64, F64 = struct.Struct("<I"), struct.Struct("<q"), struct.Struct("<d")


class Refused(Exception):
    """An error of the worker itself, reported without a traceback."""


class NoForm(Exception):
    """A Python object that cannot be sent as a value."""


class TooMany(NoForm):
    """A Python object with too many parts."""


# ---- frames -----------------------------------------------------------------------------------------------------------


def take_pipes():
    """Returns the pipes, and replaces files 0 and 1, so that `print` and `input` do not use the pipes."""
    requests, replies = os.dup(0), os.dup(1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    return requests, replies


def read_exactly(file, count):
    data = bytearray(count)
    view = memoryview(data)
    while view:
        done = os.readv(file, [view])
        if not done:
            os._exit(0)  # the Rust side has ended
        view = view[done:]
    return data


def write_all(file, data):
    view = memoryview(data)
    while view:
        view = view[os.write(file, view) :]


class Frame(bytearray):
    """The bytes of a reply, and the large arrays, which are stored apart from the bytes."""

    def __init__(self, status):
        super().__init__((status,))
        self.arrays = []  # for each large array: its position in the bytes, and its memory
        self.parts_left = 0  # the number of parts that the current value may still have

    def put(self, array):
        """Appends the numbers of an array."""
        memory = memoryview(array.reshape(-1).view(np.uint8))
        if len(memory) < LARGE:
            self += memory
        else:
            self.arrays.append((len(self), memory))

    def cut(self, length):
        """Removes everything that was written after the first `length` bytes."""
        del self[length:]
        while self.arrays and self.arrays[-1][0] > length:
            self.arrays.pop()

    def size(self):
        return len(self) + sum(len(memory) for _, memory in self.arrays)

    def parts(self):
        """Iterates over the frame's pieces: its length and the bytes up to the first array, that array, and so on."""
        start, head = 0, U32.pack(self.size())
        for place, memory in self.arrays:
            yield head + self[start:place]
            yield memory
            start, head = place, b""
        yield head + self[start:]


def watch(requests):
    """Ends this process when the Rust side has ended, even in the middle of a step."""
    import select

    if hasattr(select, "POLLRDHUP"):
        poll = select.poll()
        poll.register(requests, select.POLLRDHUP)
        poll.poll()
        os._exit(0)


# ---- values -----------------------------------------------------------------------------------------------------------


class Reader:
    def __init__(self, data):
        self.data, self.at = memoryview(data), 0

    def take(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def number(self, form):
        return form.unpack(self.take(form.size))[0]

    def text(self):
        return str(self.take(self.number(U32)), "utf-8")

    def value(self):
        tag = self.take(1)[0]
        if tag == NULL:
            return None
        if tag in (FALSE, TRUE):
            return tag == TRUE
        if tag == INT:
            return self.number(I64)
        if tag == FLOAT:
            return self.number(F64)
        if tag == TEXT:
            return self.text()
        if tag == ARRAY:
            dtype = np.dtype(DTYPES[self.take(1)[0]]).newbyteorder("<")
            shape = [self.number(U32) for _ in range(self.take(1)[0])]
            count = int(np.prod(shape, dtype=np.int64))
            return np.frombuffer(self.take(count * dtype.itemsize), dtype).reshape(shape).copy()
        if tag == TUPLE:
            return tuple(self.value() for _ in range(self.number(U32)))
        if tag == DICT:
            return {self.text(): self.value() for _ in range(self.number(U32))}
        if tag == GRAPH:
            return (GRAPH, self.value(), self.value(), self.value())
        return (self.number(U32), self.value())


def text(out, value):
    data = value.encode("utf-8", "replace")
    out += U32.pack(len(data))
    out += data


def array(out, value):
    value = np.asarray(value)
    if value.dtype == bool:
        value = value.astype(np.int8)
    if value.dtype == np.float16:
        value = value.astype(np.float32)  # float32 holds every float16
    if value.dtype.name not in DTYPES:
        raise NoForm(f"an array of {value.dtype}")
    out += bytes((ARRAY, DTYPES.index(value.dtype.name), value.ndim))
    for length in value.shape:
        out += U32.pack(length)
    out.put(np.ascontiguousarray(value, value.dtype.newbyteorder("<")))


def integer(out, value):
    value = int(value)
    if not -(2**63) <= value < 2**63:
        raise NoForm("an integer beyond 64 bits")
    out.append(INT)
    out += I64.pack(value)


def whole(value):
    """Converts a whole number of any type to an `int`."""
    try:
        number = int(value)
        is_whole = bool(number == value)
    except Exception:
        is_whole = False
    if not is_whole:
        raise NoForm("it is not a whole number")
    return number


def plain(out, value, depth=0):
    """Writes a value of `info`: a number, text or array, or a list or dict of them."""
    if depth > DEEPEST:
        raise NoForm("it is nested too deeply")
    if depth == 0:
        out.parts_left = MOST_PARTS
    out.parts_left -= 1
    if out.parts_left < 0:
        raise TooMany(f"it has more than {MOST_PARTS} parts: does a list or dict contain itself?")
    if value is None:
        out.append(NULL)
    elif isinstance(value, (bool, np.bool_)):
        out.append(TRUE if value else FALSE)
    elif isinstance(value, (int, np.integer)):
        integer(out, value)
    elif isinstance(value, (float, np.floating)):
        out.append(FLOAT)
        out += F64.pack(float(value))
    elif isinstance(value, str):
        out.append(TEXT)
        text(out, value)
    elif isinstance(value, np.ndarray):
        array(out, value)
    elif isinstance(value, (list, tuple)):
        out.append(TUPLE)
        out += U32.pack(len(value))
        for item in value:
            plain(out, item, depth + 1)
    elif isinstance(value, dict):
        out.append(DICT)
        place, count = len(out), 0
        out += U32.pack(0)
        for key, item in value.items():
            before = len(out)
            try:
                text(out, str(key))
                plain(out, item, depth + 1)
                count += 1
            except TooMany:
                raise
            except Exception:
                out.cut(before)  # leave out an entry that cannot be sent
        U32.pack_into(out, place, count)
    else:
        raise NoForm(type(value).__name__)


# ---- spaces -----------------------------------------------------------------------------------------------------------


KINDS = ("Box", "Discrete", "MultiDiscrete", "MultiBinary", "Text", "Tuple", "Dict", "Sequence", "Graph", "OneOf")
FOUND = {}  # the kind of each class of spaces that was used


def kind_of(space):
    """The kind of a space, by the names of its base classes. Classes of gym and of Gymnasium count alike."""
    kind = FOUND.get(type(space))
    if kind is None:
        named = (base.__name__ for base in type(space).__mro__ if base.__name__ in KINDS)
        kind = FOUND[type(space)] = next(named, None) or kind_of_sample(space)
    return kind


def kind_of_sample(space):
    """The kind of a space of an unknown class, by a sample of a copy: a sample advances the generator."""
    try:
        if isinstance(copy.deepcopy(space).sample(), str):
            return "AnyText"
    except Exception:
        pass
    raise Refused(f"the space {space!r} is not supported: its class is {type(space).__module__}.{type(space).__name__}")


def bounds(numbers):
    """The bounds of a box; a single number if all bounds are equal."""
    numbers = np.ascontiguousarray(numbers)
    if numbers.dtype.name not in [*DTYPES, "float16", "bool"]:
        raise Refused(f"a box of {numbers.dtype} is not supported: the types are {', '.join(DTYPES)}, float16 and bool")
    bits = numbers.reshape(-1).view(f"u{numbers.itemsize}")
    return numbers.reshape(-1)[:1].reshape(()) if bits.size and (bits == bits[0]).all() else numbers


def alike(a, b):
    """Whether two descriptions of spaces are equal."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    if isinstance(a, dict):
        return a["kind"] == b["kind"] and all(alike(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(alike, a, b))
    return a == b


def describe(space):
    kind = kind_of(space)
    if kind == "Box":
        return {"kind": kind, "low": bounds(space.low), "high": bounds(space.high), "shape": [int(length) for length in space.shape]}
    if kind == "Discrete":
        return {"kind": kind, "n": int(space.n), "start": int(getattr(space, "start", 0))}
    if kind == "MultiDiscrete":
        nvec = np.asarray(space.nvec)
        start = np.asarray(getattr(space, "start", np.zeros_like(nvec)))
        return {"kind": kind, "nvec": nvec.astype(np.int64), "start": start.astype(np.int64), "dtype": np.dtype(space.dtype).name}
    if kind == "MultiBinary":
        return {"kind": kind, "shape": [int(length) for length in space.shape]}
    if kind == "Text":
        return {"kind": kind, "min": space.min_length, "max": space.max_length, "charset": space.characters}
    if kind == "AnyText":
        return {"kind": kind}
    if kind == "Tuple":
        return {"kind": kind, "spaces": [describe(member) for member in space.spaces]}
    if kind == "Dict":
        for key in space.spaces:
            if not isinstance(key, str):
                raise Refused(f"the key {shortened(repr, key)} of a Dict space is of type {type(key).__name__}: it must be a text")
        return {"kind": kind, "keys": list(space.spaces), "spaces": [describe(member) for member in space.spaces.values()]}
    if kind == "Sequence":
        return {"kind": kind, "feature": describe(space.feature_space), "stack": bool(getattr(space, "stack", False))}
    if kind == "Graph":
        edges = None if space.edge_space is None else describe(space.edge_space)
        return {"kind": kind, "nodes": describe(space.node_space), "edges": edges}
    return {"kind": kind, "spaces": [describe(member) for member in space.spaces]}


def is_kept(given, numbers):
    """Whether a conversion kept every integer exactly, and every finite float finite."""
    if numbers.dtype.kind in "iu":
        return np.array_equal(numbers, given)
    return given.dtype.kind != "f" or numbers.itemsize >= given.itemsize or np.array_equal(np.isfinite(numbers), np.isfinite(given))


def numbers_of(space, value):
    """Converts an observation to an array with the space's type; refuses another shape."""
    given = np.asarray(value)
    if given.dtype.kind not in "biuf":
        raise NoForm(f"it has type {given.dtype}, and the space has {np.dtype(space.dtype)}")
    with np.errstate(all="ignore"):
        numbers = np.asarray(given, space.dtype)
    if given.dtype != numbers.dtype and not is_kept(given, numbers):
        raise NoForm(f"it holds numbers that {numbers.dtype} cannot represent")
    if numbers.shape != space.shape:
        raise Refused(f"an observation has the shape {numbers.shape}, and its space has {space.shape}")
    return numbers


def element(out, space, kind, value):
    """Writes an element of a space, with the numbers in the space's type."""
    if kind == "Box" or kind == "MultiDiscrete" or kind == "MultiBinary":
        array(out, numbers_of(space, value))
    elif kind == "Discrete":
        integer(out, whole(value))
    elif kind == "Text" or kind == "AnyText":
        if not isinstance(value, str):
            raise NoForm(f"it is of type {type(value).__name__}, not a text")
        out.append(TEXT)
        text(out, value)
    elif kind == "Tuple":
        if not isinstance(value, (tuple, list, np.ndarray)):
            raise NoForm(f"it is of type {type(value).__name__}, not a tuple")
        if len(value) != len(space.spaces):
            raise NoForm(f"it has {len(value)} members, and the space has {len(space.spaces)}")
        out.append(TUPLE)
        out += U32.pack(len(space.spaces))
        for member, item in zip(space.spaces, value):
            element(out, member, kind_of(member), item)
    elif kind == "Dict":
        if not hasattr(value, "keys") or value.keys() != space.spaces.keys():
            keys = f"the keys {list(value.keys())}" if hasattr(value, "keys") else "no keys"
            raise NoForm(f"it has {keys}, and the space has {list(space.spaces)}")
        out.append(DICT)
        out += U32.pack(len(space.spaces))
        for key, member in space.spaces.items():
            text(out, key)
            element(out, member, kind_of(member), value[key])
    elif kind == "Sequence":
        if getattr(space, "stack", False):
            plain(out, value)
        else:
            out.append(TUPLE)
            out += U32.pack(len(value))
            feature = kind_of(space.feature_space)
            for item in value:
                element(out, space.feature_space, feature, item)
    elif kind == "Graph":
        out.append(GRAPH)
        if getattr(value, "nodes", None) is None:
            raise NoForm("it has no nodes")
        batch(out, space.node_space, value.nodes)
        if value.edges is None:
            out.append(NULL)
        else:
            batch(out, space.edge_space, value.edges)
        plain(out, value.edge_links if value.edge_links is None else np.asarray(value.edge_links))
    else:
        if not isinstance(value, (tuple, list)) or len(value) != 2 or single(value[0]) not in range(len(space.spaces)):
            raise NoForm(f"it is not a pair of an index below {len(space.spaces)} and an element of that space")
        index, item = int(value[0]), value[1]
        out.append(ONE_OF)
        out += U32.pack(int(index))
        element(out, space.spaces[index], kind_of(space.spaces[index]), item)


def batch(out, space, value):
    """Writes a list of elements of a space as one value, in the form of Gymnasium's `batch_space`."""
    kind = kind_of(space)
    if kind == "Tuple":
        out.append(TUPLE)
        out += U32.pack(len(space.spaces))
        for member, part in zip(space.spaces, value, strict=True):
            batch(out, member, part)
    elif kind == "Dict":
        out.append(DICT)
        out += U32.pack(len(space.spaces))
        for key, member in space.spaces.items():
            text(out, key)
            batch(out, member, value[key])
    elif kind in ("Box", "Discrete", "MultiDiscrete", "MultiBinary"):
        array(out, np.asarray(value, space.dtype))
    else:
        out.append(TUPLE)
        out += U32.pack(len(value))
        for item in value:
            element(out, space, kind, item)


def action_of(space, value):
    """Converts a received action to the form that Python environments expect."""
    kind = kind_of(space)
    if kind == "Discrete":
        return np.int64(value)
    if kind == "Box" and np.issubdtype(space.dtype, np.floating) and space.dtype != np.float16:
        return list(value) if isinstance(value, tuple) else value  # keep the precision of the received action
    if kind in ("Box", "MultiDiscrete", "MultiBinary"):
        return np.asarray(value, space.dtype)
    if kind == "Tuple":
        return tuple(action_of(member, item) for member, item in zip(space.spaces, value))
    if kind == "Dict":
        return {key: action_of(member, value[key]) for key, member in space.spaces.items()}
    if kind == "Sequence" and not getattr(space, "stack", False):
        return tuple(action_of(space.feature_space, item) for item in value)
    if kind == "Graph":
        instance = importlib.import_module(type(space).__module__).GraphInstance
        return instance(*value[1:])
    if kind == "OneOf":
        index, item = value
        return (np.int64(index), action_of(space.spaces[index], item))
    return value


# ---- the environment --------------------------------------------------------------------------------------------------


def load_module(name):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        missing = (getattr(error, "name", None) or name).split(".")[0]
        package = missing.replace("_", "-")
        raise Refused(f"{error}: `{sys.executable} -m pip install {package}` installs it") from None


def library(name):
    """Imports the library `name`; without a name, gym or, if gym is not installed, Gymnasium."""
    if name is not None:
        return load_module(name)
    for name in ("gym", "gymnasium"):
        try:
            return importlib.import_module(name)
        except ImportError:
            pass
    raise Refused(f"neither gym nor gymnasium is installed: `{sys.executable} -m pip install gymnasium` installs one")


BRIEF = reprlib.Repr()
BRIEF.maxlevel, BRIEF.maxstring, BRIEF.maxother = 6, 2000, 2000
BRIEF.maxlist = BRIEF.maxtuple = BRIEF.maxdict = 100


def shortened(form, value, limit=2000):
    """The text of a value by `form`, which may raise; long texts are cut."""
    try:
        # without a limit, a list that contains another list very often would have an endless text
        text = BRIEF.repr(value) if form is repr and isinstance(value, (list, tuple, dict)) else form(value)
    except BaseException as error:
        return f"(a {type(value).__name__} whose {form.__name__} fails with {type(error).__name__})"
    return text if len(text) <= limit else f"{text[:limit]}... ({len(text)} characters)"


def single(value):
    """Returns `value` if it is a number, or its number if it is an array of one number; otherwise None."""
    if isinstance(value, (bool, int, float, np.bool_, np.number)):
        return value
    if isinstance(value, np.ndarray) and value.size == 1 and value.dtype.kind in "biuf":
        return value.item()
    return None


def number_of(name, value):
    number = single(value)
    if number is None or isinstance(number, (complex, np.complexfloating)):
        raise Refused(f"the {name} is {shortened(repr, value)} of type {type(value).__name__}: it must be a number")
    try:
        return float(number)
    except OverflowError:
        return math.inf if number > 0 else -math.inf


def flag_of(name, value):
    flag = single(value)
    if flag is None or flag not in (0, 1):
        raise Refused(f"{name} is {shortened(repr, value)} of type {type(value).__name__}: it must be True or False")
    return bool(flag)


def described_as(name, space):
    """The description of a space; errors call it the `name` space."""
    try:
        return describe(space)
    except Refused as error:
        raise Refused(f"the {name} space: {error}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {shortened(str, error)}"
        raise Refused(f"the {name} space {shortened(repr, space)} cannot be read: {reason}") from None


def size_of(space):
    """A property that is cheap to compare in each step, to detect that an environment changed a space in place."""
    return getattr(space, "n", None) if kind_of(space) == "Discrete" else getattr(space, "shape", None)


class Server:
    def __init__(self):
        self.env = None
        self.spaces = self.made = None  # the descriptions that were sent last, and first
        self.is_asked = False

    def interrupt(self, number, frame):
        """Handles Ctrl+C: interrupts a call of the environment, but not the wait for a request."""
        if self.is_asked:
            raise KeyboardInterrupt

    def look(self):
        """Reads the spaces; returns their descriptions. highway-env, for one, makes new spaces in each reset."""
        self.observation_space, self.action_space = self.env.observation_space, self.env.action_space
        described = [described_as("observation", self.observation_space), described_as("action", self.action_space)]
        self.kind = kind_of(self.observation_space)
        self.sizes = size_of(self.observation_space), size_of(self.action_space)
        return described

    def look_again(self):
        """Refuses spaces that a step has changed: agents read them once in an episode. Equal new objects are fine."""
        before = self.observation_space, self.action_space
        if not alike(self.look(), self.spaces):
            after = f"{self.observation_space} and {self.action_space}"
            raise Refused(f"the spaces changed in a step: they are {after}, and were {before[0]} and {before[1]}. Change them in `reset`.")

    def make(self, out, config):
        if config["module"] is not None:
            load_module(config["module"])
        env_id = config["env_id"]
        if ":" in env_id:
            module, env_id = env_id.split(":", 1)
            load_module(module)
        backend = library(config["backend"])
        # the checker of gym 0.26 uses a name that numpy 2 lacks
        kwargs = {"disable_env_checker": True, **config["make_kwargs"]}
        if config["render_mode"] is not None:
            kwargs["render_mode"] = config["render_mode"]
        self.env = backend.make(env_id, **kwargs)
        self.describe(out, backend)

    def describe(self, out, backend=None):
        self.spaces = self.made = self.look()
        metadata = self.env.metadata if isinstance(self.env.metadata, dict) else {}
        modes = metadata.get("render_modes")
        modes = [str(mode) for mode in modes] if isinstance(modes, (list, tuple, set, frozenset)) else []
        about = {"name": type(self.env.unwrapped).__name__, "spaces": self.spaces, "render_modes": modes}
        fps = single(metadata.get("render_fps"))
        about["render_fps"] = int(fps) if fps and 1 <= fps <= 1000 else 30
        plain(out, about)

    def reset(self, out, seed, options):
        keywords = {"seed": None if seed is None else int(seed)}
        if options:
            keywords["options"] = options
        result = self.env.reset(**keywords)
        if not isinstance(result, (tuple, list)) or len(result) != 2:
            raise Refused(f"`reset` returned {shortened(repr, result)}: it must return observation and info")
        observation, info = result
        spaces = self.look()
        # spaces that differ from the first ones are sent with each reset: the Rust side may have refused them before
        are_known = alike(spaces, self.spaces) and alike(spaces, self.made)
        plain(out, None if are_known else spaces)
        self.spaces = spaces
        self.observed(out, observation)
        self.told(out, info)

    def observed(self, out, observation):
        try:
            element(out, self.observation_space, self.kind, observation)
        except Refused:
            raise
        except Exception as error:
            shown = shortened(repr, observation)
            raise Refused(f"the observation {shown} is not an element of {self.observation_space}: {shortened(str, error)}") from None

    def told(self, out, info):
        if not isinstance(info, dict):
            raise Refused(f"the info is {shortened(repr, info)} of type {type(info).__name__}: it must be a dict")
        try:
            plain(out, info)
        except TooMany as error:
            raise Refused(f"the info cannot be read: {error}") from None
        except Exception as error:
            raise Refused(f"the info {shortened(repr, info)} cannot be read: {shortened(str, error)}") from None

    def step(self, out, action):
        result = self.env.step(action_of(self.action_space, action))
        if not isinstance(result, (tuple, list)) or len(result) != 5:
            shown = shortened(repr, result)
            raise Refused(f"`step` returned {shown}: it must return observation, reward, terminated, truncated and info")
        observation, reward, terminated, truncated, info = result
        env = self.env
        observes, acts = env.observation_space, env.action_space
        if observes is not self.observation_space or acts is not self.action_space or (size_of(observes), size_of(acts)) != self.sizes:
            self.look_again()
        out += F64.pack(number_of("reward", reward))
        out += bytes(flag_of(name, flag) for name, flag in (("terminated", terminated), ("truncated", truncated)))
        self.observed(out, observation)
        self.told(out, info)

    def render(self, out):
        picture = self.env.render()
        if hasattr(picture, "getvalue"):
            picture = picture.getvalue()  # the picture is a StringIO
        if isinstance(picture, list):
            picture = picture[-1] if picture else None
        try:
            plain(out, picture if picture is None or isinstance(picture, str) else np.asarray(picture))
        except Exception as error:
            raise Refused(f"`render` returned {shortened(repr, picture)}: {shortened(str, error)}") from None

    def pickler(self):
        import pickle

        try:
            import cloudpickle
        except ImportError:
            cloudpickle = pickle
        return pickle, cloudpickle

    def dump(self, out):
        pickle, cloudpickle = self.pickler()
        try:
            data = pickle.dumps(self.env)
        except Exception:
            data = cloudpickle.dumps(self.env)
        plain(out, np.frombuffer(data, np.uint8))

    def load(self, out, module, data):
        if module is not None:
            load_module(module)
        pickle, _ = self.pickler()
        env = pickle.loads(data.tobytes())
        self.env = env
        self.describe(out)

    def answer(self, request):
        self.is_asked = True
        reader, out = Reader(request), Frame(0)
        operation = reader.take(1)[0]
        if operation == STEP:
            self.step(out, reader.value())
        elif operation == RESET:
            self.reset(out, reader.value(), json.loads(reader.value()))
        elif operation == RENDER:
            self.render(out)
        elif operation == MAKE:
            self.make(out, json.loads(reader.value()))
        elif operation == DUMP:
            self.dump(out)
        elif operation == LOAD:
            self.load(out, reader.value(), reader.value())
        elif operation == CLOSE and self.env is not None:
            self.env.close()
        if out.size() > LONGEST:
            raise Refused(f"the reply has {out.size()} bytes: at most {LONGEST} bytes come from a worker at once")
        return out


def failure(error):
    """The exception as a reply: its type, its message, and the line that raised it."""
    out = Frame(1)
    place = None
    if not isinstance(error, Refused):
        frames = error.__traceback__
        while frames is not None:
            place = f"{frames.tb_frame.f_code.co_filename}:{frames.tb_lineno}"
            frames = frames.tb_next
    name = None if isinstance(error, Refused) else type(error).__name__
    plain(out, {"type": name, "message": shortened(str, error), "place": place})
    return out


def flush():
    """Writes out the environment's output. Its streams may be closed or replaced, so errors are ignored."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except Exception:
            pass


def main():
    requests, replies = take_pipes()
    threading.Thread(target=watch, args=(requests,), daemon=True).start()
    global np
    server, worker = Server(), os.getpid()
    signal.signal(signal.SIGINT, server.interrupt)
    while True:
        request = read_exactly(requests, U32.unpack(read_exactly(requests, 4))[0])
        try:
            try:
                import numpy as np
            except ImportError:
                sys.stderr.write(f"numpy is missing: `{sys.executable} -m pip install numpy` installs it\n")
                os._exit(3)
            out = server.answer(request)
        except SystemExit as error:
            out = failure(RuntimeError(f"the environment called sys.exit({shortened(repr, error.code)})"))
        except BaseException as error:  # including KeyboardInterrupt and GeneratorExit
            out = failure(error)
        finally:
            server.is_asked = False
        if os.getpid() != worker:
            os._exit(1)  # the environment forked this process: only the worker itself replies
        for part in out.parts():
            write_all(replies, part)
        if request[0] == CLOSE:
            flush()
            os._exit(0)


if __name__ == "__main__":
    main()
