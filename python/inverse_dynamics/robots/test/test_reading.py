# SPDX-License-Identifier: Apache-2.0
"""Files of others have a limit."""

import pytest

from inverse_dynamics.errors import RobotError
from inverse_dynamics.robots import reading


def test_a_file_up_to_the_limit_is_read_and_a_larger_one_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "_MOST_BYTES", 2**20)
    file = tmp_path / "arm.urdf"
    file.write_bytes(b"x" * 2**20)
    assert reading.read_bytes(file, "a URDF", RobotError) == b"x" * 2**20
    file.write_bytes(b"x" * (2**20 + 1))
    with pytest.raises(RobotError, match=r"arm\.urdf: expected a URDF of at most 1 MiB, got more"):
        reading.read_bytes(file, "a URDF", RobotError)


def test_a_file_that_cant_be_read_is_named(tmp_path):
    with pytest.raises(RobotError, match=r"gone\.stl: can't be read \(No such file"):
        reading.read_bytes(tmp_path / "gone.stl", "a mesh", RobotError)
