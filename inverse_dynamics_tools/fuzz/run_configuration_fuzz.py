# SPDX-License-Identifier: Apache-2.0
"""Any bytes as a run configuration."""

import atheris
import harness

with atheris.instrument_imports(include=["inverse_dynamics", "yaml"]):
    from inverse_dynamics.base.ament import DATA_PACKAGE, package_share
    from inverse_dynamics.errors import RobotError
    from inverse_dynamics.robot.robots import load_robot


def seeds() -> list[bytes]:
    """The project's own run configurations."""
    directory = package_share(DATA_PACKAGE) / "robots"
    return [file.read_bytes() for file in sorted(directory.glob("*.yaml"))]


def read(data: bytes) -> None:
    """A robot, or an error that names the file."""
    path = harness.file_of(data, "robot.yaml")
    try:
        load_robot(path)
    except RobotError as error:
        harness.check_error(error, path)


if __name__ == "__main__":
    harness.run(read, seeds())
