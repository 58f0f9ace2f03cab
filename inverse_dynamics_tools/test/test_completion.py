# SPDX-License-Identifier: Apache-2.0
"""Completion, as bash and zsh do it."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

from inverse_dynamics import cli, robot_names
from inverse_dynamics.verbs.completion import FILES, candidates

# Completes the words given, as bash does where the cursor is behind the last one; prints each reply on a line.
BASH = """
source <(ids completion bash)
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_ids
printf '%s\\n' "${COMPREPLY[@]}"
"""

# The same in zsh, whose functions for completion work inside of a line editor alone: replaced by what they are given.
ZSH = """
compdef() { : }
compset() { PREFIX=${PREFIX#*=} }
compadd() { print -l -- "${(M)found[@]:#$PREFIX*}" }
_files() { print -l -- $PREFIX*(N) }
source <(ids completion zsh)
words=("$@")
CURRENT=$#
PREFIX=$words[CURRENT]
_ids
"""


@pytest.fixture
def completed(tmp_path, monkeypatch):
    """What the shell proposes for words; in a directory with a recording and a robot."""
    (tmp_path / "recording.csv").touch()
    (tmp_path / "my robot.yaml").touch()
    monkeypatch.chdir(tmp_path)

    def run(shell, *words):
        program = {"bash": [BASH, "bash"], "zsh": [ZSH, "zsh"]}[shell]
        command = [shell, *(["-f"] if shell == "zsh" else ["--norc"]), "-c", *program, *words]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert done.stderr == ""
        return sorted(filter(None, done.stdout.splitlines()))

    return run


def shells():
    if shutil.which("zsh") is None:
        return ["bash", pytest.param("zsh", marks=pytest.mark.skip(reason="zsh is not installed"))]
    return ["bash", "zsh"]


def test_nothing_is_completed_with_nothing(capsys):
    assert cli.main(["completion", "bash", "ids", "evaluate", "--nosuch"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("shell", shells())
def test_verbs_options_values_robots_and_files_are_completed(completed, shell):
    assert completed(shell, "ids", "ev") == ["evaluate"]
    assert set(cli.VERBS) <= set(completed(shell, "ids", ""))
    assert completed(shell, "ids", "--ver") == ["--version"]
    assert completed(shell, "ids", "evaluate", "--ac") == ["--accelerations"]
    assert completed(shell, "ids", "evaluate", "--accelerations", "lo") == ["low-pass"]
    assert completed(shell, "ids", "evaluate", "--robot", "ur10_r") == ["ur10_real"]
    assert completed(shell, "ids", "robots", "my") == ["my robot.yaml"]
    assert completed(shell, "ids", "evaluate", "rec") == ["recording.csv"]
    assert completed(shell, "ids", "evaluate", "x", "--robot", "y", "--out", "re") == [
        "recording.csv"
    ]
    assert completed(shell, "ids", "evaluate", "--cutoff", "") == []
    assert completed(shell, "ids", "evaluate", "--cutoff", "5", "rec") == ["recording.csv"]
    assert completed(shell, "ids", "nonsense", "--x", "--h") == ["--help"]


def test_an_equals_sign_is_a_word_of_its_own_in_bash(completed):
    assert completed("bash", "ids", "evaluate", "--robot", "=", "panda_s") == ["panda_simulated"]
    assert "ur10_real" in completed("bash", "ids", "evaluate", "--robot", "=")


def test_options_are_proposed_where_no_argument_is_left():
    program = cli.make_parser()
    assert "--overwrite" in candidates(program, ["simulate", ""])
    assert candidates(program, ["excite", "--given", "a", "b", ""]) == [FILES]
    assert candidates(program, ["evaluate", "--verbose", "a", ""]) == [FILES]
    assert candidates(program, []) == [
        *cli.VERBS,
        *(["bench"] if "bench" in candidates(program, [""]) else []),
    ]
    assert "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL" in candidates(
        program, ["evaluate", "--plugin", "kdl"]
    )


def test_the_names_of_robots_are_those_of_the_library():
    names = candidates(cli.make_parser(), ["robots", ""])
    assert names == [*robot_names(), FILES]


def test_numpy_is_not_imported(tmp_path):
    program = (
        "import sys; from inverse_dynamics.cli import main; "
        "main(['completion', 'bash', 'ids', 'evaluate', '--robot', 'ur']); "
        "print({'numpy', 'rich', 'inverse_dynamics._core'} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "ur10_real\nur10_simulated\n:files\nset()\n"
