# SPDX-License-Identifier: Apache-2.0
"""Where installed packages keep their files, by the ament index, as ROS 2 tools find them."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from inverse_dynamics import _core
from inverse_dynamics.errors import PackageNotFoundError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["DATA_PACKAGE", "PackageNotFoundError", "package_share", "path_bytes", "resolve"]

DATA_PACKAGE = "inverse_dynamics_robots"  # run configurations, and where recordings are


def package_share(package: str) -> Path:
    """Directory `share/PACKAGE` of an installed package. Raises PackageNotFoundError."""
    return _core.package_share(package)


def resolve(path: str, base: Path) -> Path:
    """File that a path in a configuration names.

    `package://PACKAGE/FILE`: below the share directory of an installed package; absolute; else
    relative to the directory `base` of the configuration. Raises PackageNotFoundError, RobotError.
    """
    return _core.resolved_path(path, base)


def path_bytes(path: Path | str) -> bytes:
    """A path as C++ takes it: os.fsencode(), but for what no path can be."""
    try:
        return os.fsencode(path)
    except UnicodeEncodeError:
        return str(path).encode("utf-8", "backslashreplace")
