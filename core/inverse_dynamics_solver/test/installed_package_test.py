# SPDX-License-Identifier: Apache-2.0
"""The example package builds against the installed interface, as a stranger's package would."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLE = PACKAGE / "examples" / "pendulum_inverse_dynamics_solver"


def is_installed() -> bool:
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    config = "share/inverse_dynamics_solver/cmake/inverse_dynamics_solverConfig.cmake"
    return any((Path(prefix) / config).is_file() for prefix in prefixes if prefix)


def run(*command: str) -> str:
    """Output of a command that succeeds; otherwise the test fails and shows it."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.mark.skipif(
    not is_installed(), reason="inverse_dynamics_solver isn't installed in AMENT_PREFIX_PATH"
)
def test_example_builds_and_passes_its_tests() -> None:
    build = Path(os.environ["EXAMPLE_BUILD_DIRECTORY"])
    install = build / "install"
    shutil.rmtree(install, ignore_errors=True)  # what an earlier run installed proves nothing
    run(
        "cmake",
        "-S",
        str(EXAMPLE),
        "-B",
        str(build),
        "-DBUILD_TESTING=ON",
        f"-DCMAKE_INSTALL_PREFIX={install}",
    )
    run("cmake", "--build", str(build))
    assert "100% tests passed" in run("ctest", "--test-dir", str(build), "--output-on-failure")

    # What users of the solver need is installed.
    run("cmake", "--install", str(build))
    name = "pendulum_inverse_dynamics_solver"
    assert (install / "include" / name / name / f"{name}.hpp").is_file()
    assert (install / "share" / name / "cmake" / f"{name}Config.cmake").is_file()
    index = install / "share/ament_index/resource_index/inverse_dynamics_solver__pluginlib__plugin"
    assert (index / name).read_text().strip() == f"share/{name}/{name}.xml"
