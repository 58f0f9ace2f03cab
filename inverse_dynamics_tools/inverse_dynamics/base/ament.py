# SPDX-License-Identifier: Apache-2.0
"""Where installed packages keep their files, by the ament index, as ROS 2 tools find them."""

from __future__ import annotations

import os
from pathlib import Path

from inverse_dynamics.errors import UserError

DATA_PACKAGE = "inverse_dynamics_robots"  # run configurations, and where recordings are

_SOURCE_IT = "run `source install/local_setup.bash` in the workspace first"


class PackageNotFoundError(UserError):
    """A package that no sourced workspace has."""


def package_share(package: str) -> Path:
    """Directory `share/PACKAGE` of an installed package."""
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    for prefix in prefixes:
        if (Path(prefix) / "share/ament_index/resource_index/packages" / package).is_file():
            return Path(prefix) / "share" / package
    if not prefixes:
        raise PackageNotFoundError(f"package {package}: no workspace is sourced; {_SOURCE_IT}")
    raise PackageNotFoundError(
        f"package {package}: not in any of the sourced workspaces ({', '.join(prefixes)}); build "
        f"it, then {_SOURCE_IT}"
    )


def resolve(path: str, base: Path) -> Path:
    """File that a path in a configuration names.

    `package://PACKAGE/FILE`: below the share directory of an installed package; absolute; else
    relative to the directory `base` of the configuration.
    """
    if path.startswith("package://"):
        package, _, file = path.removeprefix("package://").partition("/")
        return package_share(package) / file
    return base / Path(path).expanduser()
