# SPDX-License-Identifier: Apache-2.0
"""Tests of count_tests.py, on result files as GoogleTest, pytest and CTest write them."""

from pathlib import Path

import pytest

from count_tests import count_tests, main

GTEST = """<?xml version="1.0" encoding="UTF-8"?>
<testsuites tests="4" failures="1" disabled="1" name="AllTests"><testsuite name="Rnea">
  <testcase name="Passes" status="run" result="completed" classname="engine.Rnea" />
  <testcase name="Fails" status="run" result="completed" classname="engine.Rnea">
    <failure message="1 != 2" type=""/></testcase>
  <testcase name="Skips" status="run" result="skipped" classname="engine.Rnea">
    <skipped message="rnea_test.cpp:7&#x0A;no recordings"/></testcase>
  <testcase name="DISABLED_Sleeps" status="notrun" result="suppressed" classname="engine.Rnea" />
</testsuite></testsuites>"""

PYTEST = """<?xml version="1.0" encoding="utf-8"?>
<testsuites><testsuite name="pytest" errors="1" failures="0" skipped="1" tests="3">
  <testcase classname="test_bag" name="test_passes" />
  <testcase classname="test_bag" name="test_fixture"><error message="no fixture">...</error></testcase>
  <testcase classname="test_bag" name="test_skips">
    <skipped type="pytest.skip" message="no recordings">...</skipped></testcase>
</testsuite></testsuites>"""

ALL_PASS = """<testsuites><testsuite>
  <testcase name="Passes" status="run" result="completed" classname="engine.Abba" />
</testsuite></testsuites>"""


def write_results(build: Path, package: str, cases: dict[str, str]) -> None:
    """Lays out the results of one package: xunit text per program."""
    results = build / package / "test_results" / package
    results.mkdir(parents=True)
    for name, text in cases.items():
        (results / f"{name}.gtest.xml").write_text(text)


def write_programs(build: Path, **programs: str) -> None:
    """Writes CTest's status of each program."""
    tests = "".join(
        f'<testcase name="{name}" status="{status}"/>' for name, status in programs.items()
    )
    (build / "test_programs.xml").write_text(f"<testsuite>{tests}</testsuite>")


def test_cases_of_all_packages_are_summed(tmp_path: Path) -> None:
    write_results(tmp_path, "engine", {"rnea_test": GTEST})
    write_results(tmp_path, "tools", {"bag": PYTEST})
    write_programs(tmp_path, rnea_test="fail", bag="fail")
    count = count_tests(tmp_path)
    assert count.failed == ["engine.Rnea.Fails", "test_bag.test_fixture"]
    assert count.skipped == {"no recordings": 2, "disabled in the source": 1}
    assert str(count) == "2 passed, 2 failed, 3 skipped"


@pytest.mark.parametrize("status", ["fail", "notrun"])
def test_program_that_fails_without_a_failed_case_is_a_failure(tmp_path: Path, status: str) -> None:
    write_results(tmp_path, "engine", {"aba_test": ALL_PASS})
    write_programs(tmp_path, aba_test=status)
    count = count_tests(tmp_path)
    assert count.passed == 1
    assert len(count.failed) == 1
    assert "aba_test" in count.failed[0]


def test_program_without_cases_counts_once(tmp_path: Path) -> None:
    write_programs(tmp_path, example="run", broken="fail")
    assert str(count_tests(tmp_path)) == "1 passed, 1 failed, 0 skipped"


def test_unreadable_result_is_a_failure(tmp_path: Path) -> None:
    write_results(tmp_path, "engine", {"cut_off": GTEST[:300]})
    write_programs(tmp_path, cut_off="fail")
    assert len(count_tests(tmp_path).failed) == 1


def test_exit_status_tells_success_failure_and_no_tests(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path)]) == 1  # none at all
    write_results(tmp_path, "good", {"aba_test": ALL_PASS})
    assert main([str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "1 passed, 0 failed, 0 skipped"
    write_results(tmp_path, "bad", {"rnea_test": GTEST})
    assert main([str(tmp_path)]) == 1
