# SPDX-License-Identifier: Apache-2.0
"""Counts the test cases that were run, over all packages, frameworks and programs.

Usage: python3 count_tests.py BUILD_DIRECTORY...

Reads, of each directory that is there, `PACKAGE/test_results/**/*.xml` (GoogleTest and pytest, one entry a case) and
`test_programs.xml` (CTest, one entry a program). A program that CTest calls failed though none of its cases is (it
crashed on leaving, ran too long, or is missing) is one failure.

Prints failed cases, reasons for skipping, and `N passed, N failed, N skipped` as the last line.
The exit status is 1 if a test failed or none passed.
"""

import sys
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree


def outcome(case: ElementTree.Element) -> str:
    """`passed`, `failed`, or why a case was skipped."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    if case.get("status") == "notrun":
        return "disabled in the source"  # GoogleTest's DISABLED_ cases
    skip = case.find("skipped")
    if skip is None:
        return "passed"
    # GoogleTest's message begins with file:line.
    return (skip.get("message") or skip.text or "no reason given").strip().splitlines()[-1].strip()


def main(builds: list[Path]) -> int:
    """Gives the exit status."""
    outcomes: Counter[str] = Counter()
    failed = []
    for build in builds:
        programs_with_failures = set()
        for file in sorted(build.glob("*/test_results/**/*.xml")):
            try:
                cases = ElementTree.parse(file).iter("testcase")
            except ElementTree.ParseError as error:  # killed while writing it
                failed.append(f"{file}: not readable: {error}")
                continue
            for case in cases:
                outcomes[outcome(case)] += 1
                if outcome(case) == "failed":
                    failed.append(f"{case.get('classname')}.{case.get('name')}")
                    programs_with_failures.add(file.name.partition(".")[0])
        for report in build.glob("test_programs.xml"):
            for program in ElementTree.parse(report).iter("testcase"):
                name = program.get("name")
                if program.get("status") != "run" and name not in programs_with_failures:
                    failed.append(f"{name} (the program itself: crash, time-out or missing)")
    passed = outcomes.pop("passed", 0)
    outcomes.pop("failed", None)
    for name in failed:
        print(f"failed: {name}")
    for reason, times in outcomes.most_common():
        print(f"skipped ({times}): {reason}")
    if passed == 0:
        print("no test passed: is everything built and tested?")
    print(f"{passed} passed, {len(failed)} failed, {outcomes.total()} skipped")
    return 1 if failed or passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main([Path(directory) for directory in sys.argv[1:]]))
