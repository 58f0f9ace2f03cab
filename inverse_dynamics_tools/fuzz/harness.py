# SPDX-License-Identifier: Apache-2.0
"""What the fuzz targets of this directory share; ./scripts/fuzz runs them.

    TARGET_fuzz.py --seeds DIRECTORY          write inputs to begin with
    TARGET_fuzz.py [LIBFUZZER_ARGUMENT...]    run

A target is a function of the fuzzed bytes. It returns where they were read or refused as they
should be; any exception that leaves it is a finding.
"""

from __future__ import annotations

import atexit
import sys
from functools import cache
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import TYPE_CHECKING

import atheris
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from inverse_dynamics.data.joint_log import JointLog
    from inverse_dynamics.errors import UserError


def run(target: Callable[[bytes], None], seeds: Iterable[bytes]) -> None:
    """Command line of a target."""
    if sys.argv[1:2] == ["--seeds"]:
        directory = Path(sys.argv[2])
        directory.mkdir(parents=True, exist_ok=True)
        for number, seed in enumerate(seeds):
            (directory / f"seed_{number}").write_bytes(seed)
        return
    atheris.Setup(sys.argv, target)
    atheris.Fuzz()


def file_of(data: bytes, name: str) -> Path:
    """A file with these bytes; the next one takes its place."""
    path = Path(_directory()) / name
    path.write_bytes(data)
    return path


@cache
def _directory() -> str:
    directory = mkdtemp()
    atexit.register(rmtree, directory)
    return directory


def check_error(error: UserError, path: Path) -> None:
    """The text of an error names the file, and is no list of the file's content."""
    text = str(error)
    assert path.name in text, text
    assert len(text) < 10_000, text


def check_log(log: JointLog) -> None:
    """Samples of a recording that was accepted can be evaluated."""
    shape = (len(log), len(log.joint_names))
    for name in ("q", "qd", "effort"):
        numbers = getattr(log, name)
        assert numbers.shape == shape, f"{name}: {numbers.shape}"
        assert np.isfinite(numbers).all(), f"{name}: {numbers}"
    assert log.header_stamps.shape == log.receive_stamps.shape == shape[:1]
    assert len(set(log.joint_names)) == len(log.joint_names), log.joint_names
