# SPDX-License-Identifier: Apache-2.0
"""Any bytes as a recording of sqlite3 or MCAP storage; the first byte says which."""

import sqlite3
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris
import harness
import numpy as np

with atheris.instrument_imports(include=["inverse_dynamics"]):
    from inverse_dynamics.data.bags import write_joint_logs
    from inverse_dynamics.data.joint_log import JointLog
    from inverse_dynamics.data.recordings import read_recording
    from inverse_dynamics.errors import BagError

SUFFIXES = {"sqlite3": ".db3", "mcap": ".mcap"}


def seeds() -> list[bytes]:
    """A short motion in each kind of storage."""
    stamps = 10_000_000 * np.arange(1, 4)
    numbers = np.arange(6.0).reshape(3, 2)
    log = JointLog(("a", "b"), stamps, stamps, numbers, numbers, numbers)
    found = []
    with TemporaryDirectory() as directory:
        for number, (storage, suffix) in enumerate(SUFFIXES.items()):
            path = Path(directory) / storage
            write_joint_logs(path, {"/joint_states": log}, storage=storage)
            (file,) = path.glob(f"*{suffix}")
            if storage == "sqlite3":  # seven small pages instead of large ones
                with closing(sqlite3.connect(file)) as database:
                    database.executescript("PRAGMA page_size=1024; VACUUM")
            found.append(bytes([number]) + file.read_bytes())
    return found


def read(data: bytes) -> None:
    """A motion, or an error that names the file."""
    suffix = list(SUFFIXES.values())[data[:1] == b"\1"]
    path = harness.file_of(data[1:], "motion" + suffix)
    try:
        log = read_recording(path)
    except BagError as error:
        harness.check_error(error, path)
        return
    harness.check_log(log)


if __name__ == "__main__":
    harness.run(read, seeds())
