# SPDX-License-Identifier: Apache-2.0
"""Models of robots that are recorded in public, for docs/robots.md: all of them, or those that are named.

The first argument is a directory of clones of the repositories that public_arms.py names; NAME... follow. In the
project, models, run configurations, plots and sections of the page are replaced by what one command makes of each
robot: `ids identify ... --gallery project`. It runs in a directory with links to the clones, to the recordings of
`ids data` and to the project.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from public_arms import ARMS, Arm, Source
from studies import DOCS, recording_of

from inverse_dynamics import cli, load_robot
from inverse_dynamics.robots.robot_files import robot_text
from inverse_dynamics.robots.robots import robot_of_description

UNISA = "unisa-acg/inverse-dynamics-solver"


@dataclass(frozen=True)
class Entry:
    """A robot of the gallery."""

    source: Source
    fitted: tuple[str, ...]  # labels of recordings
    description: str
    dates: str  # commit of the repository, and what is known of the day
    note: str = ""  # on what the numbers rest
    held_out: tuple[str, ...] = ()


def of_the_project(name: str, robot: str) -> Source:
    """A robot whose recording `ids data` fetches, and whose description the project has."""

    def read(_: Path, out: Path) -> Arm:
        recording = recording_of(robot)
        link(out / recording.name, recording)
        described = load_robot(robot).urdf
        assert described is not None
        file = out / f"{name}.yaml"
        arm = replace(robot_of_description(described), effort="torque")
        file.write_text(robot_text(arm, file), encoding="utf-8")
        return Arm(file, {"excitation": out / recording.name})

    return Source(UNISA, "BSD-3-Clause", read)


GALLERY = {
    "ur10_salerno": Entry(
        of_the_project("ur10_salerno", "ur10_real"),
        ("excitation",),
        "Universal Robots UR10 (CB series) of the University of Salerno",
        "41e196d, published in 2025",
    ),
    "panda_salerno": Entry(
        of_the_project("panda_salerno", "panda_real"),
        ("excitation",),
        "Franka Emika Panda without hand, of the University of Salerno",
        "41e196d, published in 2025",
    ),
    "panda_rome": Entry(
        ARMS["Panda, another"],
        ("trajectory 1",),
        "Franka Emika Panda without hand, of Sapienza University of Rome",
        "24d85ce, published in July 2019",
    ),
    "ur10e": Entry(
        ARMS["UR10e"],
        ("12 Feb", "19 Feb"),
        "Universal Robots UR10e",
        "11af40e, recorded on 12 and 19 February 2020, recording 3 on 17 January, from point to point",
        "Efforts are currents by the controller's drive gains",
        held_out=("17 Jan, point to point",),
    ),
    "med7": Entry(
        ARMS["KUKA LBR Med 7"],
        ("excitation",),
        "KUKA LBR Med 7 R800",
        "58b4d88, published in June 2024",
        "The recording has no time: 100 Hz is a guess, which inertia and viscous friction depend on",
    ),
    "kr300": Entry(
        ARMS["KUKA KR300"],
        ("A", "B"),
        "KUKA KR300, axes 1 to 3",
        "9e403c0, recorded on 21 October 2020",
        "Efforts are the motors' torques by the gears; the counterbalance is not modelled",
        held_out=("C",),
    ),
    "ar5": Entry(
        ARMS["Rokae AR5"],
        ("excitation",),
        "Rokae AR5-5_07R-W4C4A2 on a wall",
        "758dc8d, published in March 2026",
    ),
    "xmate": Entry(
        ARMS["Rokae xMate"],
        ("excitation",),
        "Rokae xMate3 Pro",
        "f044daf, published in 2025",
    ),
    "master_arm": Entry(
        ARMS["da Vinci master"],
        ("one",),
        "Master tool manipulator of a da Vinci Research Kit",
        "7697d3a, published in 2018",
        "Velocities of the last joints aren't the slopes of positions, so their viscous friction is unsure",
        held_out=("two",),
    ),
}


def link(place: Path, target: Path) -> None:
    """Make a symbolic link, unless it is there."""
    if not place.is_symlink():
        place.symlink_to(target.resolve())


def identify(name: str, entry: Entry, arm: Arm) -> None:
    """Make the files of a robot. The working directory has the links."""
    repository, licence = entry.source.repository, entry.source.licence
    licence = "no licence stated" if licence == "none stated" else f"licence {licence}"
    robot = replace(
        load_robot(arm.robot),
        name=name,
        description=entry.description,
        source=f"https://github.com/{repository} at commit {entry.dates}; {licence}. {entry.note}",
    )
    file = Path(f"{name}.yaml")
    keys = ("parameters", "friction_at", "fit_springs")  # which robot_text() leaves out
    more = [f"{key}: {json.dumps(getattr(robot, key))}\n" for key in keys if getattr(robot, key)]
    file.write_text("".join([robot_text(robot, file), *more]), encoding="utf-8")
    tests = [x for label in entry.held_out for x in ("--hold-out", arm.recordings[label])]
    accepted = [x for kind in arm.accept for x in ("--accept", kind)]
    recordings = [arm.recordings[label] for label in entry.fitted]
    where = ("--out", f"{name}_identified.yaml", "--gallery", "project", "--overwrite")
    command = ["identify", *recordings, "--robot", file, *tests, *accepted, *where]
    if cli.main(list(map(str, command))):
        sys.exit(1)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    clones = Path(sys.argv[1]).resolve()
    with TemporaryDirectory() as directory:
        link(Path(directory) / "project", DOCS.parent)
        for clone in clones.iterdir():
            link(Path(directory) / clone.name, clone)
        os.chdir(directory)
        chosen = {name: GALLERY[name] for name in sys.argv[2:] or GALLERY}
        arms = {name: entry.source.read(Path(), Path()) for name, entry in chosen.items()}
        for name, entry in chosen.items():
            identify(name, entry, arms[name])
