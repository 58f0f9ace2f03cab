# SPDX-License-Identifier: Apache-2.0
"""The demonstration: simulated and real robots, the same steps for each, and one page that shows them.

result = run_demo(Path("demo"), recordings=find_recordings())
print(result.page)

DIR/report.html             all robots on one page; comparison of two models of the real UR10
DIR/demo.json               mean errors of each robot; marks the directory
DIR/ur10_simulated_bag, DIR/panda_simulated_bag   recordings of the simulated robots; without MuJoCo the
                            shorter ones that come with the package are evaluated, and not written
DIR/ROBOT                   an evaluation of each robot: figures, errors, bag (see evaluations.py)
DIR/ur10_real_urdf          the real UR10 computed from its URDF alone
DIR/comparison              that against the identified model
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.ament import DATA_PACKAGE, package_share
from inverse_dynamics.base.extras import how_to_install, is_installed
from inverse_dynamics.base.files import Contents, write_text, written_whole
from inverse_dynamics.base.plain import json_text
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.data.public_recordings import data_directory
from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation.comparison import compare
from inverse_dynamics.evaluation.evaluation import evaluate
from inverse_dynamics.robot.descriptions import read_description
from inverse_dynamics.robot.robots import RIGID_BODY, load_robot
from inverse_dynamics.robot.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.evaluation.comparison import Comparison
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.simulation.run import SimulatedRun

MARK = "demo.json"
SIMULATED = ("ur10_simulated", "panda_simulated")
REAL = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}

TITLES = {
    "ur10_simulated": "UR10, simulated",
    "panda_simulated": "Panda, simulated",
    "ur10_real": "UR10, real",
    "panda_real": "Panda, real",
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
    """What a demonstration has made. Keys are names of robots."""

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
    if directory.is_dir():
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
    out = Path(out)
    real = _recordings_in(recordings)
    with written_whole(
        out, overwrite=overwrite, contents=_contents(), inputs=real.values()
    ) as target:
        work = _Work(target, out, say, progress)
        for name in SIMULATED:
            if is_installed("mujoco"):
                say(f"simulating {TITLES[name].partition(',')[0]}, computing its torques")
                work.simulate(name, _QUICK_SECONDS if quick else None)
            else:
                say(f"computing the torques of {TITLES[name]}")
                work.evaluate_stored(name)
        for name, bag in real.items():
            say(f"computing the torques of {TITLES[name]}")
            work.evaluate(name, bag)
        absent = {TITLES[name]: file for name, file in REAL.items() if name not in real}
        if absent:
            work.notes.append(
                f"{' and '.join(absent)}: left out, there is no recording "
                f"{' or '.join(absent.values())}: {HOW_TO_GET_RECORDINGS}"
            )
        comparison = None
        if "ur10_real" in real:
            say("comparing the URDF's rigid bodies with the identified model on the real UR10")
            comparison = work.compare(real["ur10_real"])
        say("writing the page")
        work.write_page(comparison)
    return Demo(out, work.evaluations, comparison, tuple(work.notes))


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
    """What a demonstration may have written."""
    from inverse_dynamics.results import comparisons as comparison_results
    from inverse_dynamics.results import evaluations as results
    from inverse_dynamics.simulation import writer

    parts = {"comparison": comparison_results.CONTENTS, "ur10_real_urdf": results.CONTENTS}
    parts |= dict.fromkeys((*SIMULATED, *REAL), results.CONTENTS)
    parts |= {f"{name}_bag": writer.CONTENTS for name in SIMULATED}
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


class _Work:
    """The demonstration while it is made, in a directory that isn't yet where it will be."""

    def __init__(
        self, target: Path, final: Path, say: Callable[[str], None], progress: Progress
    ) -> None:
        self.target, self.final, self.say, self.progress = target, final, say, progress
        self.evaluations: dict[str, Evaluation] = {}
        self.notes: list[str] = []

    def simulate(self, name: str, duration: float | None) -> None:
        from inverse_dynamics.simulation import simulate, write_run

        bag = f"{name}_bag"
        run = simulate(load_robot(name), duration=duration, seed=0, progress=self.progress)
        write_run(run, self.target / bag, progress=self.progress)
        evaluation = evaluate(self.target / bag, name, progress=self.progress)
        notes = (*evaluation.notes, _match(run, evaluation))
        self._keep(name, replace(evaluation, bag=self.final / bag, notes=notes))

    def evaluate_stored(self, name: str) -> None:
        """The simulated recording that comes with the package."""
        evaluation = evaluate(stored_recording(name), name)
        note = (
            "a recording that comes with this package: with MuJoCo the demo simulates the robots: "
            f"{how_to_install('mujoco')}"
        )
        self._keep(name, replace(evaluation, notes=(*evaluation.notes, note)))

    def evaluate(self, name: str, bag: Path) -> None:
        self._keep(name, evaluate(bag, name, progress=self.progress))

    def _keep(self, name: str, evaluation: Evaluation) -> None:
        from inverse_dynamics.results.evaluations import write_evaluation

        write_evaluation(evaluation, self.target / name, figures=_figures(), progress=self.progress)
        self.evaluations[name] = evaluation

    def compare(self, bag: Path) -> Comparison:
        """Rigid bodies of the URDF, without friction, against the identified model."""
        from inverse_dynamics.results.comparisons import write_comparison
        from inverse_dynamics.results.evaluations import write_evaluation

        rigid = evaluate(bag, "ur10_real", plugin=RIGID_BODY, progress=self.progress)
        write_evaluation(  # the figure of the comparison shows its torques
            rigid, self.target / "ur10_real_urdf", figures=(), progress=self.progress
        )
        comparison = compare(
            [rigid, self.evaluations["ur10_real"]],
            ("rigid bodies of the URDF", "identified, with friction"),
        )
        write_comparison(  # report.html shows it
            comparison, self.target / "comparison", figures=_figures(), page=False
        )
        return comparison

    def write_page(self, comparison: Comparison | None) -> None:
        from inverse_dynamics.report import report_comparison, report_run, write_page

        comparisons = []
        if comparison is not None:
            comparisons.append(
                report_comparison(
                    comparison,
                    "Gain by identification",
                    "The same recording of the real UR10, computed from the masses and inertia that its "
                    "URDF states, and from the model identified on the robot, with friction.",
                )
            )
        runs = [report_run(e, TITLES[name]) for name, e in self.evaluations.items()]
        title = f"{_COUNTS[len(runs)]} robots: measured and computed torques"
        write_page(self.target / "report.html", title, runs, comparisons, self.notes)
        write_text(self.target / MARK, json_text(summary(self.evaluations, self.notes)))


def _figures() -> tuple[str, ...]:
    """Formats of the figures that can be made here."""
    return ("png",) if is_installed("matplotlib") else ()


def _match(run: SimulatedRun, evaluation: Evaluation) -> str:
    """What is left of the error where accelerations aren't estimated, in words."""
    from inverse_dynamics.simulation.match import greatest_differences

    robot = evaluation.robot
    description = "" if robot.urdf is None else read_description(robot.urdf)
    most = float(greatest_differences(run, open_solver(robot, description)).max())
    return (
        f"with the simulator's own accelerations, computed and measured torques differ by {most:.1g} "
        "N m at most: the errors shown are those of estimated accelerations"
    )


_COUNTS = {2: "Two", 3: "Three", 4: "Four"}
