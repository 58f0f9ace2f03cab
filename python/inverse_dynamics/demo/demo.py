# SPDX-License-Identifier: Apache-2.0
"""The demonstration: simulated and real robots, the same steps for each, and one page that shows them.

result = run_demo(Path("demo"), recordings=find_recordings())
print(result.page)

DIR also holds the recordings of the simulated robots, ROBOT_bag. Without MuJoCo the shorter ones that come
with the package are evaluated. `ids demo --help` lists the other files.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.comparison.comparison import Comparison, compare
from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation.evaluation import Evaluation, evaluate
from inverse_dynamics.installation.ament import DATA_PACKAGE, package_share
from inverse_dynamics.installation.extras import how_to_install, is_installed
from inverse_dynamics.outputs.files import Contents, write_text, written_whole
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.progress import no_progress
from inverse_dynamics.public_recordings.public_recordings import data_directory
from inverse_dynamics.robots.robots import RIGID_BODY, load_robot

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from inverse_dynamics.progress import Progress

MARK = "demo.json"
SIMULATED = ("ur10_simulated", "panda_simulated")
REAL = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}

TITLES = {  # in the order of the page
    "ur10_real": "UR10, real",
    "panda_real": "Panda, real",
    "ur10_simulated": "UR10, simulated",
    "panda_simulated": "Panda, simulated",
}
HOW_TO_GET_RECORDINGS = (
    "`ids data` fetches the recordings of the real robots, a few MB, from "
    "github.com/unisa-acg/inverse-dynamics-solver (`ids data --help`: also without network), and "
    "`ids demo` then finds them; where they are elsewhere, name the directory that holds "
    "ur10_exciting_trajectory and panda_exciting_trajectory with --recordings, or in IDS_DATA_DIR the "
    "one above it, where they lie in bags/"
)

_QUICK_SECONDS = 4.0  # of simulated motion


@dataclass(frozen=True)
class Demo:
    """A finished demonstration. Keys are names of robots."""

    directory: Path
    evaluations: dict[str, Evaluation]
    comparison: Comparison | None  # None: without a recording of the real UR10
    notes: tuple[str, ...]  # what is missing, and why, in words

    @property
    def page(self) -> Path:
        """The page that shows it all."""
        return self.directory / "report.html"


def find_recordings() -> Path | None:
    """Directory of recordings: in IDS_DATA_DIR, else where `ids data` puts them, if it has.

    Raises UserError: IDS_DATA_DIR is set, but they aren't there.
    """
    directory = data_directory() / "bags"
    if directory.is_dir() and any(directory.iterdir()):  # empty where the network failed
        return directory
    if not os.environ.get("IDS_DATA_DIR"):
        return None
    raise UserError(
        f"IDS_DATA_DIR: expected a directory with recordings at {directory}, which isn't there; "
        "correct or unset it, or let `ids data` put them there"
    )


def stored_recording(name: str) -> Path:
    """The short recording of one of SIMULATED that comes with the package."""
    return package_share(DATA_PACKAGE) / "recordings" / name


def run_demo(
    out: Path,
    *,
    recordings: Path | None = None,
    overwrite: bool = False,
    quick: bool = False,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = no_progress,
) -> Demo:
    """Simulate, evaluate, compare, show; writes everything or nothing.

    recordings: directory with those of REAL; None: simulated robots only.
    overwrite: replace an older demonstration. quick: a few seconds of simulated motion.
    say: called with a sentence before each step. Raises UserError.
    """
    real = _recordings_in(recordings)
    figures = ("png",) if is_installed("matplotlib") else ()
    evaluations, notes = {}, []
    with written_whole(
        Path(out), overwrite=overwrite, contents=_contents(), inputs=real.values()
    ) as target:
        for name, title in TITLES.items():
            if name in SIMULATED and is_installed("mujoco"):
                say(f"simulating {title.partition(',')[0]}, computing its torques")
                evaluation = _simulated(name, target, Path(out), quick, progress)
            elif name in SIMULATED:
                say(f"computing the torques of {title}")
                evaluation = _stored(name)
            elif name in real:
                say(f"computing the torques of {title}")
                evaluation = evaluate(real[name], name, progress=progress)
            else:
                continue
            evaluation.save(target / name, figures=figures, progress=progress)
            evaluations[name] = evaluation
        if absent := {TITLES[name]: file for name, file in REAL.items() if name not in real}:
            notes.append(
                f"{' and '.join(absent)}: left out, there is no recording "
                f"{' or '.join(absent.values())}: {HOW_TO_GET_RECORDINGS}"
            )
        comparison = None
        if "ur10_real" in real:
            say("comparing the URDF's rigid bodies with the identified model on the real UR10")
            rigid = evaluate(real["ur10_real"], "ur10_real", plugin=RIGID_BODY, progress=progress)
            # The figure of the comparison shows its torques.
            rigid.save(target / "ur10_real_urdf", figures=(), progress=progress)
            labels = ("identified, with friction", "rigid bodies of the URDF")
            comparison = compare([evaluations["ur10_real"], rigid], labels)
            (target / "comparison").mkdir()
            comparison.write(target / "comparison", figures, page=False)
        say("writing the page")
        _write_page(target, evaluations, comparison, notes)
    return Demo(Path(out), evaluations, comparison, tuple(notes))


def summary(evaluations: Mapping[str, Evaluation], notes: Sequence[str]) -> dict[str, Any]:
    """Mean errors of each robot, for JSON."""
    return {
        "schema": 1,
        "robots": {
            name: {"mean_rmse": e.mean_rmse, "unit": e.units[0], "samples": len(e.log)}
            for name, e in evaluations.items()
        },
        "notes": notes,
    }


def _contents() -> Contents:
    """All files of a demonstration."""
    from inverse_dynamics.simulation import run

    parts = {"comparison": Comparison.contents, "ur10_real_urdf": Evaluation.contents}
    parts |= dict.fromkeys(TITLES, Evaluation.contents)
    parts |= {f"{name}_bag": run.CONTENTS for name in SIMULATED}
    files = (
        f"{directory}/{file.replace('{name}', directory)}"
        for directory, contents in parts.items()
        for file in (*contents.files, *contents.added)
    )
    return Contents(MARK, (MARK, "report.html", *files))


def _recordings_in(directory: Path | None) -> dict[str, Path]:
    """Recordings by robot. Raises UserError where a directory was named and holds none."""
    if directory is None:
        return {}
    found = {name: directory / bag for name, bag in REAL.items() if (directory / bag).is_dir()}
    if not found:
        raise UserError(
            f"{directory}: holds no recording {' or '.join(REAL.values())}; {HOW_TO_GET_RECORDINGS}"
        )
    return found


def _simulated(name: str, target: Path, final: Path, quick: bool, progress: Progress) -> Evaluation:
    """Evaluate a simulated motion and keep its recording. final: where `target` will be."""
    from inverse_dynamics.simulation import simulate, write_run

    robot, bag = load_robot(name), f"{name}_bag"
    run = simulate(robot, duration=_QUICK_SECONDS if quick else None, seed=0, progress=progress)
    write_run(run, target / bag, progress=progress)
    evaluation = evaluate(target / bag, name, progress=progress)
    solver = evaluation.arm.solver
    note = (
        "with the simulator's own accelerations, computed and measured torques differ by "
        f"{float(run.differences_from(solver).max()):.1g} N m at most: the errors shown are those "
        "of estimated accelerations"
    )
    return replace(evaluation, bag=final / bag, notes=(*evaluation.notes, note))


def _stored(name: str) -> Evaluation:
    """Evaluate the simulated recording that comes with the package."""
    evaluation = evaluate(stored_recording(name), name)
    note = (
        "a recording that comes with this package: with MuJoCo the demo simulates the robots: "
        f"{how_to_install('mujoco')}"
    )
    return replace(evaluation, notes=(*evaluation.notes, note))


def _write_page(
    target: Path,
    evaluations: Mapping[str, Evaluation],
    comparison: Comparison | None,
    notes: Sequence[str],
) -> None:
    from inverse_dynamics.evaluation.page import report_run
    from inverse_dynamics.show.page import write_page

    runs = {name: report_run(e, TITLES[name]) for name, e in evaluations.items()}
    if comparison is not None:
        name = "ur10_real"
        runs[name] = comparison.report_run(TITLES[name], shown=False)
    title = f"{_COUNTS[len(runs)]} robots: measured and computed torques"
    write_page(target / "report.html", title, list(runs.values()), notes)
    write_text(target / MARK, json_text(summary(evaluations, notes)))


_COUNTS = {2: "Two", 3: "Three", 4: "Four"}
