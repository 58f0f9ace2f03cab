# SPDX-License-Identifier: Apache-2.0
"""Completion, as bash and zsh ask for it."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from inverse_dynamics import cli

# The reply to a line with the cursor at its end.
BASH = """
source <(ids completion bash)
COMP_LINE=$1 COMP_POINT=${#1} COMP_TYPE=9 COMP_WORDBREAKS=$' \\t\\n"\\'><=;|&(:'
_python_argcomplete ids
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture
def completed(tmp_path, monkeypatch):
    """What bash proposes for a line; in a directory with a recording and a robot."""
    (tmp_path / "recording.csv").touch()
    (tmp_path / "my_robot.yaml").touch()
    monkeypatch.chdir(tmp_path)

    def run(line):
        command = ["bash", "--norc", "-c", BASH, "bash", line]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert done.stderr == ""
        return sorted(word.strip() for word in done.stdout.splitlines() if word.strip())

    return run


def test_verbs_options_values_robots_and_files_are_completed(completed):
    assert set(cli.verb_modules()) <= set(completed("ids "))
    assert completed("ids ev") == ["evaluate"]
    assert completed("ids evaluate --ac") == ["--accelerations"]
    assert completed("ids evaluate --accelerations lo") == ["low-pass"]
    assert completed("ids evaluate --robot ur10_r") == ["ur10_real"]
    assert completed("ids evaluate --robot=panda_si") == ["panda_simulated"]
    assert completed("ids evaluate --robot my") == ["my_robot.yaml"]
    assert completed("ids evaluate rec") == ["recording.csv"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_can_read_its_script(shell):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    script = subprocess.run(["ids", "completion", shell], capture_output=True, check=True).stdout
    subprocess.run([shell, "-n", "/dev/stdin"], input=script, check=True)
