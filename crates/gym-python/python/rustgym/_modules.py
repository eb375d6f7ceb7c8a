"""One tree of modules: each module of Gymnasium's under our name, as the same object, or as ours where it is ours.

``import rustgym.wrappers.common`` gives ``gymnasium.wrappers.common`` itself, so that its classes are Gymnasium's.
``rustgym.envs.toy_text.frozen_lake`` is a module of ours: Gymnasium's, with our classes and functions in place of its own.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

__all__ = ["Finder", "forwarder", "replace"]

_HERE = Path(__file__).parent
_OURS = __name__.partition(".")[0]
_THEIRS = "gymnasium"

# what a module of Gymnasium's has of ours, by its name under `rustgym`: each value is made when it is asked for
_replacements: dict[str, dict[str, Callable[[], Any]]] = {}


def replace(module: str, name: str, make: Callable[[], Any]) -> None:
    """Puts what ``make`` gives under ``name`` into our form of Gymnasium's ``module``, such as ``envs.registration``."""
    _replacements.setdefault(f"{_OURS}.{module}", {})[name] = make


def _is_theirs(name: str) -> bool:
    """Whether Gymnasium has the module that ``name``, which begins with ``rustgym.``, stands for."""
    try:
        return find_spec(_THEIRS + name.removeprefix(_OURS)) is not None
    except ImportError:  # a module above it is none, or lacks what it imports
        return False
    except Exception as error:
        if type(error).__module__ == "gymnasium.error":  # such as MuJoCo's modules without MuJoCo
            return False
        raise


class _StandIn(ModuleType):
    """A module of Gymnasium's with replacements."""

    def __getattr__(self, name: str) -> Any:
        make = _replacements[self.__name__].get(name)
        if make is not None:
            value = make()
        elif name.startswith("__") and name not in ("__all__", "__file__"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        else:
            return getattr(importlib.import_module(_THEIRS + self.__name__.removeprefix(_OURS)), name)
        self.__dict__[name] = value
        return value

    def __dir__(self) -> list[str]:
        theirs = dir(importlib.import_module(_THEIRS + self.__name__.removeprefix(_OURS)))
        return sorted({*self.__dict__, *_replacements[self.__name__], *theirs})


class _StandInLoader(Loader):
    def create_module(self, spec: ModuleSpec) -> ModuleType:
        theirs = importlib.import_module(_THEIRS + spec.name.removeprefix(_OURS))
        return _StandIn(spec.name, theirs.__doc__)

    def exec_module(self, module: ModuleType) -> None:
        pass


class _SameLoader(Loader):
    """Gives Gymnasium's module itself."""

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = importlib.import_module(_THEIRS + spec.name.removeprefix(_OURS))
        self._spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec  # the import system has just replaced it


class Finder(MetaPathFinder):
    """Finds the modules under ``rustgym``."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module: ours where there is a file of ours, else Gymnasium's."""
        if not fullname.startswith(f"{_OURS}."):
            return None
        *folders, name = fullname.split(".")[1:]
        folder = _HERE.joinpath(*folders)
        if folder.is_dir() and (own := PathFinder.find_spec(fullname, [str(folder)], target)) is not None:
            return own
        if not _is_theirs(fullname):
            return None
        if fullname in _replacements:
            return ModuleSpec(fullname, _StandInLoader())
        return ModuleSpec(fullname, _SameLoader())


def forwarder(module: str) -> Callable[[str], Any]:
    """The ``__getattr__`` of our ``module``: what it lacks is a module below it, or Gymnasium's."""

    def __getattr__(name: str) -> Any:
        if not name.startswith("__"):
            if _is_theirs(f"{module}.{name}"):
                return importlib.import_module(f"{module}.{name}")
            if _is_theirs(module):
                try:
                    return getattr(importlib.import_module(_THEIRS + module.removeprefix(_OURS)), name)
                except AttributeError:
                    pass
        theirs = _THEIRS + module.removeprefix(_OURS)
        raise AttributeError(f"neither {module} nor {theirs} has an attribute {name!r}")

    return __getattr__


def install() -> None:
    """Puts the finder before all others, once."""
    if not any(isinstance(finder, Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, Finder())
