# SPDX-License-Identifier: Apache-2.0
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation.workers import Failure, cores, in_processes

# What workers call: they import this module by its name.


def square(number):
    return number * number


def process_of(_):
    time.sleep(0.05)
    return os.getpid()


def fail_at_two(number):
    if number == 2:
        raise UserError("file two: expected a number\nremove it")
    return number


def stumble_at_two(number):
    if number == 2:
        raise ZeroDivisionError("an accident")
    return number


def die_at_two(number):
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def crash_at_two(number):
    if number == 2:
        os.kill(os.getpid(), signal.SIGSEGV)
    return number


def sleep_after_the_first(file):
    if file is not None:
        Path(file).write_text(str(os.getpid()))
        time.sleep(600)


def outcomes(function, arguments, jobs=2):
    found = {}
    in_processes(function, arguments, jobs=jobs, done=lambda k, outcome: found.update({k: outcome}))
    return [found[k] for k in range(len(arguments))]


def test_every_argument_gets_its_result():
    assert outcomes(square, range(9), jobs=3) == [k * k for k in range(9)]
    assert outcomes(square, [], jobs=3) == []


def test_no_more_processes_than_asked_for_do_the_work():
    processes = set(outcomes(process_of, range(6), jobs=2))
    assert len(processes) == 2
    assert os.getpid() not in processes


def test_a_users_mistake_is_a_failure_in_one_line_and_the_others_are_done():
    assert outcomes(fail_at_two, range(4)) == [
        0,
        1,
        Failure("file two: expected a number remove it"),
        3,
    ]


def test_an_unexpected_error_is_a_failure_with_a_report_that_stays():
    failure = outcomes(stumble_at_two, [2])[0]
    assert "unexpected ZeroDivisionError: an accident; this is a bug in ids" in failure.text
    report = Path(failure.text.rpartition("with ")[2])
    assert "stumble_at_two" in report.read_text()
    report.unlink()


@pytest.mark.parametrize(
    ("function", "text"),
    [
        (die_at_two, "its process was killed (SIGKILL); most likely memory ran out: let fewer run"),
        (crash_at_two, "its process was ended by SIGSEGV"),
    ],
)
def test_a_process_that_dies_is_a_failure_of_its_argument_alone(function, text):
    found = outcomes(function, [0, 1, 2, 3, 2, 5], jobs=2)
    assert [k for k in found if not isinstance(k, Failure)] == [0, 1, 3, 5]
    assert found[2].text.startswith(text)
    assert found[4].text.startswith(text)


def is_running(process):
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_workers_end_with_the_process_that_started_them(tmp_path):
    file = tmp_path / "process"
    script = (
        "import sys; sys.path.insert(0, sys.argv[2])\n"
        "from inverse_dynamics.evaluation.workers import in_processes\n"
        "from test_workers import sleep_after_the_first\n"
        "in_processes(sleep_after_the_first, [sys.argv[1]], jobs=1, done=print)\n"
    )
    command = [sys.executable, "-c", script, str(file), str(Path(__file__).parent)]
    with subprocess.Popen(command) as parent:
        while not file.exists() or not file.read_text():
            assert parent.poll() is None
            time.sleep(0.01)
        parent.kill()
    deadline = time.monotonic() + 60
    while is_running(int(file.read_text())):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_cores_are_those_that_this_process_may_use():
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert cores() == 1
    finally:
        os.sched_setaffinity(0, allowed)
    assert cores() == len(allowed)
