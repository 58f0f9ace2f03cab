# SPDX-License-Identifier: Apache-2.0
"""Solver plugins and data that other Python packages bring.

Where this package was installed by pip, plugins, robots and models are looked for

1. in this package,
2. in the sourced workspaces (AMENT_PREFIX_PATH), the last sourced first,
3. in INVERSE_DYNAMICS_PREFIX_PATH, to which the packages are added that declare

       [project.entry-points."inverse_dynamics.prefix"]
       my_solver = "my_solver"

   in pyproject.toml: the directory of their module `my_solver` holds lib/ and share/ as an installation does.

The first that has a package is the one it is taken from. C++ looks in the same places.
"""

from __future__ import annotations

import os
from importlib import metadata
from importlib.util import find_spec

from inverse_dynamics.installation.extras import installed_by_pip

GROUP = "inverse_dynamics.prefix"
VARIABLE = "INVERSE_DYNAMICS_PREFIX_PATH"


def find_other_wheels() -> None:
    """Add the packages that declare a prefix to INVERSE_DYNAMICS_PREFIX_PATH. Called once, by _core.

    A package of a workspace does nothing: there, pluginlib looks in AMENT_PREFIX_PATH alone.
    """
    if not installed_by_pip():
        return
    known = [prefix for prefix in os.environ.get(VARIABLE, "").split(":") if prefix]
    found = [prefix for prefix in declared_prefixes() if prefix not in known]
    if found:
        os.environ[VARIABLE] = ":".join([*known, *found])


def declared_prefixes() -> list[str]:
    """Directories of the modules that entry points name, in the order of these names."""
    entries = sorted(
        metadata.entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value)
    )
    return [directory for entry in entries for directory in _directories_of(entry.module)]


def _directories_of(module: str) -> list[str]:
    """Directories of a module, found without importing it; none if its package is gone."""
    package, *inner = module.split(".")
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):  # ValueError: of a module that doesn't say where it is
        return []
    places = [] if spec is None else spec.submodule_search_locations or []
    directories = [os.path.join(place, *inner) for place in places]
    return [directory for directory in directories if os.path.isdir(directory)]
