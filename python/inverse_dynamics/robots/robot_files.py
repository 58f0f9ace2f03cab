# SPDX-License-Identifier: Apache-2.0
"""A robot as the file of a run configuration (docs/add_a_robot.md), with a comment on each key.

write_robot(robot_of_description("arm.urdf"), Path("arm.yaml"))
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import OutputError, PackageNotFoundError
from inverse_dynamics.installation.ament import package_share
from inverse_dynamics.outputs.files import check_output_file, write_text_whole
from inverse_dynamics.outputs.yaml_text import yaml_list, yaml_number, yaml_text

if TYPE_CHECKING:
    from inverse_dynamics.robots.robots import Robot


def write_robot(robot: Robot, file: Path, *, overwrite: bool = False) -> None:
    """Write the run configuration, whole or not at all. Raises OutputError."""
    if file.suffix not in (".yaml", ".yml"):
        raise OutputError(f"{file}: expected a name ending in .yaml, as --robot takes it")
    check_output_file(file, overwrite=overwrite, option="--new", inputs=robot.files)
    write_text_whole(file, robot_text(robot, file))


def robot_text(robot: Robot, file: Path) -> str:
    """The text of the file, with paths relative to it. What isn't stated is a comment."""
    names = f"[{', '.join(map(yaml_text, robot.joints))}]"
    gravity, gains = robot.gravity or (0.0, 0.0, -9.81), robot.drive_gains or (1.0,)
    lines = [
        "# SPDX-License-Identifier: Apache-2.0",
        "#",
        "# Run configuration. All keys: docs/add_a_robot.md.",
        "#",
        f"#     ids evaluate RECORDING --robot {file.name}",
        "",
        "schema: 1",
        f"name: {yaml_text(robot.name)}",
        f"description: {yaml_text(robot.description)}",
        f"plugin: {robot.plugin}  # `ids robots --plugins` lists the others",
        *_path("urdf", robot.urdf, file),
        *_path("model", robot.model, file),
        _key("root", robot.root, yaml_text(robot.root), "first link of the chain"),
        _key("tip", robot.tip, yaml_text(robot.tip), "last link of the chain; several, with commas: those of a tree"),
        _key("gravity", robot.gravity, yaml_list(gravity), "m/s^2, in the frame of the root"),
        _key("topic", robot.topic, yaml_text(robot.topic or "/joint_states"), "of recordings"),
        _key("joints", robot.joints, names, "names in the recording, in the order of the chain"),
        _key("friction", True, str(robot.friction).lower(), "whether the solver's friction counts"),
        _key("effort", True, robot.effort, "torque, current, torque_without_gravity, or auto: found from the data"),
        _key("drive_gains", robot.drive_gains, yaml_list(gains), "N m/A of each joint, where efforts are currents"),
        *_held(robot),
        *_table(robot),
        "accelerations:",
        f"  method: {robot.accelerations}",
        _key("  cutoff", robot.cutoff, yaml_number(robot.cutoff or 10.0), "Hz; else chosen from the data"),
    ]  # fmt: skip
    if robot.source:
        lines.append(f"source: {yaml_text(robot.source)}")
    return "\n".join(lines) + "\n"


def _key(key: str, stated: object, value: str, meaning: str) -> str:
    """A line; a comment where nothing is stated."""
    return f"{'' if stated else '# '}{key}: {value}  # {meaning}"


def _path(key: str, path: Path | None, file: Path) -> list[str]:
    if path is None:
        return []
    return [f"{key}: {yaml_text(reference(path, file.parent))}"]


def reference(path: Path, directory: Path) -> str:
    """A file as a run configuration in a directory names it: by its package, else by a relative path."""
    place = path.resolve()
    for share in place.parents:
        with suppress(PackageNotFoundError):
            if share.parent.name == "share" and package_share(share.name).resolve() == share:
                return f"package://{place.relative_to(share.parent)}"
    return os.path.relpath(place, directory.resolve())


def _held(robot: Robot) -> list[str]:
    """Parameters that hold joints, which a model may lack."""
    held = {key: at for key, at in robot.parameters.items() if key.startswith("locked_joints.")}
    rows = [f"  {yaml_text(key)}: {yaml_number(float(at))}  # rad, m" for key, at in held.items()]
    return ["parameters:", *rows] if rows else []


def _table(robot: Robot) -> list[str]:
    """How tables are read: docs/tables.md."""
    scale = f"[{', '.join(map(yaml_text, robot.scale))}]"
    rows = [
        _key("  columns", robot.columns, yaml_text(robot.columns), "which is what"),
        _key("  scale", robot.scale, scale, "factors to SI units"),
        _key("  sign", robot.sign, yaml_list(robot.sign), "1 or -1 for each joint"),
        _key("  rate", robot.rate, yaml_number(robot.rate or 0.0), "Hz, without a time"),
        _key("  gears", robot.gears, yaml_list(robot.gears), "of recorded motors"),
    ]
    used = [row for row in rows if not row.startswith("# ")]
    return ["table:", *used] if used else []
