# SPDX-License-Identifier: Apache-2.0
"""Any bytes as a table of a recorded motion."""

import atheris
import harness

with atheris.instrument_imports(include=["inverse_dynamics"]):
    from inverse_dynamics.data.recordings import read_recording
    from inverse_dynamics.errors import BagError

SEEDS = (
    b"time,position.a,velocity.a,effort.a\n0,1,2,3\n0.01,1,2,3\n0.02,1.5,2e-3,-3\n",
    b"\xef\xbb\xbftime;position.a [rad];velocity.a [rad/s];current.a [A];acceleration.a\n"
    b"0;1;2;3;4\n0.01;1;2;3;4\n",
    b'"time"\t"position.a"\t"velocity.a"\t"effort.a"\n\n0\t1\t2\t3\n1e-2\t1\t2\t3\n',
    b"timestamp actual_q_0 actual_qd_0 actual_current_0 target_q_0\r\n0 1 2 3 4\r\n0.008 1 2 3 4\r\n",
)


def read(data: bytes) -> None:
    """A motion, or an error that names the file."""
    path = harness.file_of(data, "motion.csv")
    try:
        log = read_recording(path)
    except BagError as error:
        harness.check_error(error, path)
        return
    harness.check_log(log)


if __name__ == "__main__":
    harness.run(read, SEEDS)
