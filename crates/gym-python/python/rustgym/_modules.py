"""Makes each of Gymnasium's modules importable under ``rustgym``: as the same object, or as a module of this package.

``import rustgym.wrappers.common`` gives ``gymnasium.wrappers.common`` itself, so that its classes are Gymnasium's.
``rustgym.envs.toy_text.frozen_lake`` is a copy of Gymnasium's module in which this package's classes and functions replace
Gymnasium's.
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

# what replaces the members of Gymnasium's modules, by the module's name under `rustgym`; values are made on first use
_replacements: dict[str, dict[str, Callable[[], Any]]] = {}


def replace(module: str, name: str, make: Callable[[], Any]) -> None:
    """Replaces ``name`` in the copy of Gymnasium's ``module``, such as ``envs.registration``, by the result of ``make``."""
    _replacements.setdefault(f"{_OURS}.{module}", {})[name] = make


def _is_theirs(name: str) -> bool:
    """Whether ``name``, which begins with ``rustgym.``, stands for a module of Gymnasium's."""
    try:
        return find_spec(_THEIRS + name.removeprefix(_OURS)) is not None
    except ImportError:  # the parent does not exist, is not a package, or cannot import a dependency
        return False
    except Exception as error:
        if type(error).__module__ == "gymnasium.error":  # for example, MuJoCo is not installed
            return False
        raise


class _StandIn(ModuleType):
    """A copy of one of Gymnasium's modules, with replacements."""

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
    """Loads Gymnasium's module itself."""

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = importlib.import_module(_THEIRS + spec.name.removeprefix(_OURS))
        self._spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec  # the import system has just replaced it
        # An import of a part sets it as an attribute of the whole, which here is Gymnasium's own module, where a function may
        # have the same name (`gymnasium.utils.colorize`). What is loaded already needs no import.
        theirs = f"{module.__name__}."
        for name in [name for name in sys.modules if name.startswith(theirs)]:
            sys.modules.setdefault(_OURS + name.removeprefix(_THEIRS), sys.modules[name])


class Finder(MetaPathFinder):
    """Finds the modules under ``rustgym``."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module's spec: of this package's file if there is one, else of Gymnasium's module."""
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
    """The ``__getattr__`` of ``module``: missing names are submodules, or members of Gymnasium's module."""

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
    """Installs the finder before all others, once."""
    if not any(isinstance(finder, Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, Finder())
