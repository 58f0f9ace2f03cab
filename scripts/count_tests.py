# SPDX-License-Identifier: Apache-2.0
"""Counts the test cases that were run, over all packages, frameworks and programs.

Usage: python3 count_tests.py BUILD_DIRECTORY

Reads `PACKAGE/test_results/**/*.xml` (GoogleTest and pytest, one entry a case) and, where it is,
`test_programs.xml` (CTest, one entry a program). A program that CTest calls failed though none of
its cases is (it crashed on leaving, ran too long, or is missing) is one failure.

Prints failed cases, reasons for skipping, and `N passed, N failed, N skipped` as the last line.
The exit status is 1 if a test failed or none passed.
"""

import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Count:
    """How many cases passed; names of those that failed; how often each reason made one skip."""

    passed: int = 0
    failed: list[str] = field(default_factory=list)
    skipped: Counter[str] = field(default_factory=Counter)

    def __str__(self) -> str:
        skipped = sum(self.skipped.values())
        return f"{self.passed} passed, {len(self.failed)} failed, {skipped} skipped"


def count_tests(build: Path) -> Count:
    """Counts the test cases of every package below `build`."""
    count = Count()
    for package in sorted(path for path in build.iterdir() if path.is_dir()):
        for file in sorted(package.glob("test_results/**/*.xml")):
            _count_cases(file, count)
    _count_programs(build, count)
    return count


def _count_cases(file: Path, count: Count) -> None:
    """Adds the cases of one xunit file; an unreadable file is one failure."""
    try:
        cases = list(ElementTree.parse(file).iter("testcase"))
    except ElementTree.ParseError as error:
        count.failed.append(f"{file}: not readable: {error}")
        return
    for case in cases:
        name = f"{case.get('classname')}.{case.get('name')}"
        skip = case.find("skipped")
        if case.find("failure") is not None or case.find("error") is not None:
            count.failed.append(name)
        elif skip is not None:
            count.skipped[_reason(skip)] += 1
        elif case.get("status") == "notrun":  # GoogleTest's DISABLED_ cases
            count.skipped["disabled in the source"] += 1
        else:
            count.passed += 1


def _reason(skip: ElementTree.Element) -> str:
    """Why a case was skipped: the last line of its message (GoogleTest's begins with file:line)."""
    lines = (skip.get("message") or skip.text or "no reason given").strip().splitlines()
    return lines[-1].strip()


def _count_programs(build: Path, count: Count) -> None:
    """Adds what CTest knows about programs beyond the cases they reported."""
    report = build / "test_programs.xml"
    if not report.is_file():
        return
    for program in ElementTree.parse(report).iter("testcase"):
        name = program.get("name")
        results = list(build.glob(f"*/test_results/**/{name}.*.xml"))
        own = Count()
        for file in results:
            _count_cases(file, own)
        if program.get("status") != "run":
            if not own.failed:
                count.failed.append(f"{name} (the program itself: crash, time-out or missing)")
        elif not results:  # a plain program without cases
            count.passed += 1


def main(arguments: list[str]) -> int:
    """Command line; gives the exit status."""
    if len(arguments) != 1 or not Path(arguments[0]).is_dir():
        print(__doc__, file=sys.stderr)
        return 2
    count = count_tests(Path(arguments[0]))
    for name in count.failed:
        print(f"failed: {name}")
    for reason, times in count.skipped.most_common():
        print(f"skipped ({times}): {reason}")
    if count.passed == 0:
        print("no test passed: is everything built and tested?")
    print(count)
    return 1 if count.failed or count.passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
