# SPDX-License-Identifier: Apache-2.0
"""The version of the installed package."""

from __future__ import annotations

from pathlib import Path

from inverse_dynamics.errors import UserError


class _NoVersionError(UserError, AttributeError):
    """The package isn't installed."""


def version() -> str:
    """As pip, colcon and CMake have noted it beside the modules, from package.xml. Raises UserError."""
    from importlib import metadata

    try:
        return metadata.version("inverse_dynamics")
    except metadata.PackageNotFoundError:
        raise _NoVersionError(
            "inverse_dynamics.__version__: expected the package to be installed by pip, colcon or "
            f"CMake, which note its version, got the modules alone, in {Path(__file__).parents[1]}; install it"
        ) from None
