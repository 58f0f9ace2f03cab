# SPDX-License-Identifier: Apache-2.0
"""Python packages that only some verbs need: extras of the package that pip installs.

    mujoco = lazily_imported("mujoco", "a simulation")   # imported when it is first used

One that is missing is a MissingPackageError, whose text names the command that installs it.
"""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from inverse_dynamics.errors import UserError

# Importable module to the extra of pyproject.toml that brings it.
EXTRAS = {
    "collada": "meshes",
    "dask": "dask",
    "distributed": "dask",
    "matplotlib": "plots",
    "mujoco": "sim",
    "pyarrow": "parquet",
    "rosbags": "rosbags",
    "scipy": "mat",
    "trimesh": "meshes",
    "xacro": "xacro",
    "yaml": "sim",
}


# What Debian and Ubuntu have as python3-MODULE, and what PyPI names otherwise.
_OF_APT = {
    "argcomplete",
    "collada",
    "dask",
    "distributed",
    "jinja2",
    "matplotlib",
    "numpy",
    "rich",
    "scipy",
    "yaml",
}
_OF_PYPI = {"collada": "pycollada", "yaml": "pyyaml"}


class MissingPackageError(UserError):
    """An optional Python package isn't installed."""


def is_installed(module: str) -> bool:
    """Whether a module can be imported, found without importing it."""
    return find_spec(module) is not None


def require(use: str, *modules: str) -> None:
    """Raise MissingPackageError unless all modules are installed. use: what needs them, as `a figure`."""
    absent = [module for module in modules if not is_installed(module)]
    if absent:
        raise missing(use, *absent)


def missing(use: str, *modules: str) -> MissingPackageError:
    """The error of modules that aren't installed."""
    return MissingPackageError(f"{use} needs {', '.join(modules)}: {how_to_install(*modules)}")


def how_to_install(*modules: str) -> str:
    """The command that installs modules, for whoever has installed this package."""
    if installed_by_pip() and set(modules) <= EXTRAS.keys():
        extras = ",".join(sorted({EXTRAS[module] for module in modules}))
        return f'pip install "inverse-dynamics[{extras}]"'
    pip = f"pip install {' '.join(_OF_PYPI.get(module, module) for module in modules)}"
    if installed_by_pip():
        return pip
    apt = f"sudo apt install {' '.join(f'python3-{module}' for module in modules)}, or "
    return f"run ./scripts/setup in the workspace, or {apt if set(modules) <= _OF_APT else ''}{pip}"


def installed_by_pip() -> bool:
    """Whether this is a wheel, which contains solvers and data."""
    return (Path(__file__).parents[1] / "share" / "ament_index").is_dir()


class _LazyModule:
    """Stands for a module until something of it is used."""

    def __init__(self, name: str, use: str) -> None:
        self._name, self._use = name, use
        self._module: Any = None

    def __getattr__(self, attribute: str) -> Any:
        # import_module() takes 10 microseconds even for a module that is there
        if self._module is None or sys.modules.get(self._name) is not self._module:
            self._module = self._imported()
        return getattr(self._module, attribute)

    def _imported(self) -> Any:
        try:
            return import_module(self._name)
        except ModuleNotFoundError as error:
            if error.name != self._name:
                raise
            raise missing(self._use, self._name) from error


def lazily_imported(name: str, use: str) -> Any:
    """The module `name`, imported when it is first used. use: what needs it, as `a figure`."""
    return _LazyModule(name, use)
