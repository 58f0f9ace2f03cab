# SPDX-License-Identifier: Apache-2.0
"""The tool xacro, which finds packages as meshes are found: without ROS, in the directories above too.

    python xacro_tool.py arm.urdf.xacro   # prints the URDF

A process of its own, as xacro keeps its state in globals.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType


def _use_instead_of_ament(directory: Path) -> None:
    """Have `$(find PACKAGE)`, which xacro looks up by ament_index_python, found from a directory."""
    from inverse_dynamics.installation.ament import PackageNotFoundError, package_roots

    def share_directory(package: str) -> str:
        for root in package_roots(package, directory):
            if root.is_dir():
                return str(root)
        raise PackageNotFoundError(
            f"package {package}: not found: expected an installed package, or a directory beside one "
            f"above {directory}; source its workspace, or put its files there"
        )

    packages = ModuleType("ament_index_python.packages")
    vars(packages).update(
        get_package_share_directory=share_directory, PackageNotFoundError=PackageNotFoundError
    )
    sys.modules["ament_index_python"] = ModuleType("ament_index_python")
    sys.modules[packages.__name__] = packages


if __name__ == "__main__":
    del sys.path[0]  # this directory, whose modules aren't top-level ones
    _use_instead_of_ament(Path(sys.argv[1]).absolute().parent)
    import xacro

    xacro.main()
