# SPDX-License-Identifier: Apache-2.0
"""Runs the sweep: see scripts/sweep."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from outcome import judged
from process import run_apart

if TYPE_CHECKING:
    from collections.abc import Iterator

    from outcome import Case, Verdict

GROUPS = ("urdf", "model", "robot", "parameter")
LONGEST_LINE = 220


def verdicts(group: str, every: int, names: str = "") -> Iterator[tuple[Case, Verdict]]:
    """What becomes of every so many cases of a group; names: a part of those to run."""
    with tempfile.TemporaryDirectory(prefix="sweep.") as directory:
        for number, case in enumerate(import_module(f"{group}_cases").cases(Path(directory))):
            if number % every == 0 and names in case.name:
                yield case, judged(run_apart(case.act), case.expected)


def main() -> int:
    """Run the groups; 1 if a case is wrong."""
    parser = argparse.ArgumentParser(prog="scripts/sweep", description=__doc__)
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=f"of {', '.join(GROUPS)}")
    parser.add_argument("--every", type=int, default=1, help="run one case of so many")
    parser.add_argument("--only", default="", metavar="TEXT", help="cases whose name has this part")
    parser.add_argument("--wrong", action="store_true", help="show only what is wrong")
    given = parser.parse_args()
    unknown = set(given.groups) - set(GROUPS)
    if unknown:
        parser.error(f"no such group: {', '.join(sorted(unknown))}; groups: {', '.join(GROUPS)}")

    wrong = 0
    for group in given.groups or GROUPS:
        begin, counts = time.monotonic(), Counter[str]()
        for case, verdict in verdicts(group, given.every, given.only):
            counts[verdict.kind] += 1
            if verdict.kind == "WRONG" or not given.wrong:
                line = f"{verdict.kind:8} {group}: {case.name}: {verdict.why!r}"
                print(line if len(line) < LONGEST_LINE else line[:LONGEST_LINE] + " ...")
        wrong += counts["WRONG"]
        summary = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
        print(f"{group}: {summary or 'no cases'} ({time.monotonic() - begin:.0f} s)", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
