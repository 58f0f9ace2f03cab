# SPDX-License-Identifier: Apache-2.0
"""`ids identify` on a real recording."""

from __future__ import annotations

from dataclasses import replace

from inverse_dynamics import evaluate, load_robot, read_joint_log, write_joint_logs


def test_the_panda_is_identified_by_the_command(identified, recordings, tmp_path, ids, monkeypatch):
    """The whole way on a real recording: table, files, page, and the robot that evaluates."""
    bag = recordings / "panda_exciting_trajectory"

    def the_same(paths, robot, *, progress, **options):
        """What `identified` asks for, once for all tests."""
        assert (paths, robot) == ([bag], load_robot("panda_real"))
        assert not any(options.values())
        return identified("panda")

    monkeypatch.setattr("inverse_dynamics.identification.identify.identify", the_same)
    outputs = ("--out", "arm.yaml", "--urdf-out", "arm.urdf", "--mjcf-out", "arm.xml")
    code, out, err = ids("identify", bag, "--robot", "panda_real", *outputs)
    assert (code, err) == (0, "")
    assert "present" in out
    mean = next(line for line in out.splitlines() if line.strip().startswith("mean")).split()
    urdf, present, refitted, fitted = map(float, mean[3:7])
    assert fitted < min(0.285, refitted) < present < urdf
    names = {"arm.yaml", "arm_model.yaml", "arm_model.json", "arm.json", "arm.html", "arm.npz"}
    names |= {"arm.urdf", "arm.xml"}
    assert {path.name for path in tmp_path.iterdir()} == names
    result = evaluate(bag, tmp_path / "arm.yaml")
    assert sum(error.rmse for error in result.errors_of_kept) / 7 < 0.285
    assert not [
        note for note in result.notes if "likely cause" in note or "leaves the range" in note
    ]
    log = read_joint_log(bag)
    fast = replace(log, qd=2 * log.qd, q=2 * log.q)
    write_joint_logs(tmp_path / "fast", {log.topic: fast})
    notes = evaluate(tmp_path / "fast", tmp_path / "arm.yaml").notes
    assert any("leaves the range" in note for note in notes)
