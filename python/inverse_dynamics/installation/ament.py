# SPDX-License-Identifier: Apache-2.0
"""Where packages keep their files: the installed ones by the ament index, as ROS 2 tools find them."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from inverse_dynamics._core import package_share
from inverse_dynamics._core import resolved_path as resolve
from inverse_dynamics.errors import PackageNotFoundError

__all__ = ["DATA_PACKAGE", "PackageNotFoundError", "package_roots", "package_share", "resolve"]

DATA_PACKAGE = "inverse_dynamics_robots"  # run configurations, and where recordings are


def package_roots(package: str, directory: Path) -> list[Path]:
    """Where the files of a package may be that a file in a directory names, the likeliest first.

    The installed package, then in ROS_PACKAGE_PATH, and in each directory above that has the package's
    name or holds a directory of that name. They need not exist.
    """
    roots = []
    with suppress(PackageNotFoundError):
        roots.append(package_share(package))
    listed = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    start = directory.absolute()
    for place in (*(Path(path) for path in listed if path), start, *start.parents):
        roots += [place, place / package] if place.name == package else [place / package]
    return roots
