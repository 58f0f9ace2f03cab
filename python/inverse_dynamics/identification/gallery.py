# SPDX-License-Identifier: Apache-2.0
"""An identified robot as the gallery of docs/robots.md has it, in a checkout of the project or any other directory.

core/inverse_dynamics_robots/models/NAME.yaml   the model
core/inverse_dynamics_robots/robots/NAME.yaml   the run configuration, which needs no description
docs/pictures/NAME.png                          torques of a held-out block
docs/robots.md                                  the robot's section, in place of an older one
NAME.md                                         beside the identification: text of a pull request
"""

from __future__ import annotations

import itertools
import re
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from inverse_dynamics.errors import OutputError, RobotError
from inverse_dynamics.identification.files import model_file_text
from inverse_dynamics.identification.result import urdf_of
from inverse_dynamics.outputs.files import check_output_file, files_written_whole, write_text
from inverse_dynamics.robots.robot_files import reference, robot_text
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.show import palette
from inverse_dynamics.show.plots import COMPUTED, MEASURED, check_formats, save_figure, write_title
from inverse_dynamics.wording import shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import HeldOutBlock, Identification
    from inverse_dynamics.robots.robots import Robot

_PACKAGE = "inverse_dynamics_robots"
_LONGEST = 10.0  # s of a block in the figure
_COLORS = 16  # of the figure, so that it is small
_WIDTH = 110  # of lines of a command


class GalleryFiles(NamedTuple):
    """The files of a robot."""

    model: Path
    robot: Path
    picture: Path
    page: Path
    request: Path

    @classmethod
    def of(cls, out: Path, gallery: Path) -> GalleryFiles:
        """Those beside an identification's NAME.yaml, and in the directory."""
        name, data = out.stem, gallery / "core" / _PACKAGE
        return cls(
            model=data / f"models/{name}.yaml",
            robot=data / f"robots/{name}.yaml",
            picture=gallery / f"docs/pictures/{name}.png",
            page=gallery / "docs/robots.md",
            request=out.with_suffix(".md"),
        )


def check_gallery(robot: Robot, out: Path, gallery: Path, *, overwrite: bool = False) -> None:
    """Raise OutputError unless write_gallery() may write there, RobotError for a robot without a source.

    And MissingPackageError without matplotlib.
    """
    if not re.fullmatch(r"[a-z]\w*_identified", out.stem, re.ASCII):
        raise OutputError(
            f"{out}: expected a name such as ur10e_identified.yaml, which the robot has in the gallery: small "
            "letters, digits, _ and identified at the end; name another file with --out"
        )
    if not re.search(r"\b(19|20)\d\d\b", robot.source):
        raise RobotError(
            f"robot {robot.name}: source: expected where the recordings are published, when they were made, and their "
            f"licence, got {shown(robot.source) if robot.source else 'none'}; state `source:` in the run configuration"
        )
    check_formats(("png",))
    files = GalleryFiles.of(out, gallery)
    for file in {*files} - {files.page}:
        check_output_file(file, overwrite=overwrite, inputs=robot.files)


def write_gallery(found: Identification, out: Path, gallery: Path, command: str) -> GalleryFiles:
    """Write the files of a robot, or none of them, in place of older ones. command: what made it. Raises UserError."""
    files = GalleryFiles.of(out, gallery)
    origin = f"{_told(found.robot)} `{command}`"
    section = _section(found, out.stem, command)
    page = files.page.read_text(encoding="utf-8") if files.page.exists() else "# Robots\n"
    texts = {
        files.model: model_file_text(found, out.stem, origin),
        files.robot: _robot_text(found, files),
        files.page: _with_section(page, out.stem, section),
        files.request: _request(out.stem, section),
    }
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
    with files_written_whole(files) as places:
        fresh = dict(zip(files, places, strict=True))
        for file, text in texts.items():
            write_text(fresh[file], text)
        save_figure(lambda: held_out_figure(found), fresh[files.picture])
        _with_few_colors(fresh[files.picture])
    return files


def _robot_text(found: Identification, files: GalleryFiles) -> str:
    """The run configuration: geometry and gravity are the model's; a description that all have is drawn."""
    robot, gains = found.robot, found.model.drive_gains
    installed = reference(urdf_of(found), files.robot.parent).startswith(f"package://{_PACKAGE}/")
    identified = replace(
        robot,
        name=files.robot.stem,
        description=f"{robot.description}, identified",
        plugin=RIGID_BODY,
        urdf=robot.urdf if installed else None,
        model=files.model,
        root=robot.root if installed else "",
        tip=robot.tip if installed else "",
        gravity=None,
        friction=True,
        parameters={},
        drive_gains=robot.drive_gains if gains is None else tuple(gains.tolist()),
        columns="",
        scale=(),
        sign=(),
        rate=None,
    )
    return robot_text(identified, files.robot)


def _told(robot: Robot) -> str:
    """What it is, and where its recordings are from."""
    return " ".join(
        f"{text.rstrip('.')}." for text in (robot.description or robot.name, robot.source)
    )


def _section(found: Identification, name: str, command: str) -> str:
    """Of docs/robots.md: half a page."""
    robot = found.robot
    q, qd, _ = found.model.seen
    errors = {"held-out error": found.held_out["identified"]}
    errors |= {
        f"recording {number}": test.rmse["identified"]
        for number, test in enumerate(found.hold_out, len(found.recordings) + 1)
    }
    errors["95 % band"] = found.model.torque_deviation
    rows = [("joint", "q seen", "qd seen", *errors), ("---",) * (3 + len(errors))]
    rows += [
        (
            f"{joint} [{unit}]",
            _range(q[j]),
            _range(qd[j]),
            *(_digits(e[j]) for e in errors.values()),
        )
        for j, (joint, unit) in enumerate(zip(found.joints, found.units, strict=True))
    ]
    table = [f"| {' | '.join(row)} |" for row in rows]
    inside = 100 * float(np.mean(found.coverage))
    facts = (
        f"Friction law `{found.law}`, {found.samples} samples in {found.duration:.0f} s; {inside:.0f} % of held-out "
        "samples are in the band."
    )
    parts = [
        f"## {name}",
        re.sub(r"https?://[^\s,;]*[^\s,;.]", r"<\g<0>>", _told(robot)),
        f"![Measured and computed torques of {name}](pictures/{name}.png)",
        "\n".join(table),
        facts,
        "\n".join(f"- {finding.text}" for finding in found.findings),
        f"```bash\n{_broken(command)}\n```",
    ]
    return "\n\n".join(filter(None, parts)) + "\n"


def _range(limits: Floats) -> str:
    return " to ".join(f"{round(x, 2) + 0.0:.2f}" for x in limits)


def _digits(error: float) -> str:
    return f"{error:#.3g}".rstrip(".")


def _broken(command: str) -> str:
    """The command in several lines."""
    words = list(map(shlex.quote, shlex.split(command)))
    lines = [words[0]]
    for before, word in itertools.pairwise(words):
        if len(lines[-1]) + len(word) > _WIDTH and not before.startswith("--"):
            lines.append("   ")
        lines[-1] += f" {word}"
    return " \\\n".join(lines)


def _with_section(page: str, name: str, section: str) -> str:
    """The page with a section, in its old place or at the end."""
    older = re.compile(rf"^## {name}\n.*?(?=^## |\Z)", re.MULTILINE | re.DOTALL)
    text, found = older.subn(lambda _: f"{section}\n", page)
    if not found:
        text = f"{page.rstrip()}\n\n{section}"
    return f"{text.rstrip()}\n"


def _request(name: str, section: str) -> str:
    """Text of a pull request; its first line is the title."""
    body = re.sub(r"^(## .*|!\[.*)\n\n", "", section, flags=re.MULTILINE)
    return (
        f"inverse_dynamics_robots: add {name}\n\n{body}\n"
        "- [ ] I may publish these numbers, and the seconds of the recording that the plot shows.\n"
    )


def held_out_figure(found: Identification) -> Figure:
    """Measured torques, computed ones and their band: seconds of the block whose error is the median."""
    from matplotlib.figure import Figure

    block = _median_block(found)
    rows = -(-len(found.joints) // 2)
    figure = Figure(figsize=(5.6, 0.95 * rows + 0.3), layout="constrained")
    axes = figure.subplots(rows, 2, sharex=True, squeeze=False).ravel()
    middle = np.abs(block.time - block.time[[0, -1]].mean()) <= _LONGEST / 2
    time, measured, computed, band = (
        x[middle] for x in (block.time, block.measured, block.computed["identified"], block.band)
    )
    for j, (joint, unit) in enumerate(zip(found.joints, found.units, strict=True)):
        low, high = computed[:, j] - band[:, j], computed[:, j] + band[:, j]
        axes[j].fill_between(time, low, high, color=palette.COMPUTED, alpha=0.2, linewidth=0)
        axes[j].plot(time, measured[:, j], **MEASURED)
        axes[j].plot(time, computed[:, j], **COMPUTED)
        write_title(axes[j], f"{joint} [{unit}]")
    for unused in axes[len(found.joints) :]:  # below the last of the right column
        unused.set_axis_off()
        axes[len(found.joints) - 2].tick_params(labelbottom=True)
    axes[0].set_xlim(time[0], time[-1])
    figure.supxlabel("time [s]", fontsize=8.5)
    return figure


def _median_block(found: Identification) -> HeldOutBlock:
    """By the mean over joints of its error, in units of each joint's noise."""
    blocks = [block for block in found.blocks if block.counts.any()]
    sizes = [
        float((np.sqrt((block.errors["identified"] ** 2).mean(axis=0)) / found.noise).mean())
        for block in blocks
    ]
    return blocks[int(np.argsort(sizes)[(len(sizes) - 1) // 2])]


def _with_few_colors(picture: Path) -> None:
    from PIL import Image

    with Image.open(picture) as image:
        small = image.convert("RGB").quantize(_COLORS)
    small.save(picture, format="PNG", optimize=True)
