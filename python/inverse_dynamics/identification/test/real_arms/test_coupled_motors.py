# SPDX-License-Identifier: Apache-2.0
"""A wrist whose last motor turns with the joint before: its friction, simulated by MuJoCo and found again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from identified_arms import arm, identification
from simulation_arms import robots_package

from inverse_dynamics import FastModel, identify, load_robot
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.result import Identification, IdentificationError
from inverse_dynamics.identification.urdf_export import mjcf_text
from inverse_dynamics.simulation import Resolution, Sensors, simulate, write_run

COUPLING = np.eye(6)
COUPLING[5, 4] = -0.8
NOISE = 0.02  # N m


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of the simulated arm."""
    directory = tmp_path_factory.mktemp("coupled")
    hidden = identification(model=replace(arm(), coupling=COUPLING))
    files = write_identification(hidden, directory / "hidden.yaml")
    run = simulate(
        load_robot(files.robot),
        trajectory=robots_package() / "trajectories/ur10.yaml",
        from_model=True,
        rate=125,
        duration=20.0,
        sensors=Sensors(noise=Resolution(1e-6, 1e-5, NOISE)),
    )
    write_run(run, directory / "recording")
    return directory / "recording"


def found_with(recording: Path, coupling: tuple[float, ...]) -> Identification:
    return identify([recording], "ur10_simulated", coupling=coupling)


def test_friction_of_coupled_motors_is_found(recording: Path, tmp_path: Path) -> None:
    found = found_with(recording, tuple(COUPLING.ravel()))
    for law, true in zip(found.model.friction, arm().friction, strict=True):
        assert abs(law["fv"] / true["fv"] - 1) < 0.05
        assert abs(law["fc"] / true["fc"] - 1) < 0.05
    assert found.held_out["identified"][4:].max() < 1.5 * NOISE
    without = found_with(recording, ())
    assert without.held_out["identified"][4:].min() > 3 * NOISE
    assert "that joints share motors" in mjcf_text(found)

    files = write_identification(found, tmp_path / "again.yaml")
    states = np.random.default_rng(0).uniform(-1, 1, (3, 20, 6))
    np.testing.assert_allclose(
        FastModel.from_file(str(files.model)).torques(*states),
        found.solver().torques(*states),
        atol=1e-9,
    )


def test_a_matrix_of_another_size_is_refused(recording: Path) -> None:
    with pytest.raises(IdentificationError, match="expected the 36 numbers of a matrix, got 4"):
        found_with(recording, (1.0, 0.0, 0.5, 1.0))


@pytest.mark.parametrize(
    ("row", "column", "value", "message"),
    [
        (
            2,
            2,
            0.0,
            "row 3, number 3: expected a finite number other than 0 on the diagonal, got 0",
        ),
        (2, 2, np.nan, "row 3, number 3: expected a finite number other than 0 on the diagonal"),
        (4, 5, 0.5, "row 5, number 6: expected 0 above the diagonal, got 0.5; motors may turn"),
        (5, 4, np.inf, "row 6, number 5: expected a finite number, got inf; give 0"),
    ],
)
def test_a_matrix_that_couples_otherwise_is_refused(
    row: int, column: int, value: float, message: str
) -> None:
    matrix = np.eye(6)
    matrix[row, column] = value
    with pytest.raises(IdentificationError, match=f"coupling: {message}"):
        identify(["none"], "ur10_simulated", coupling=tuple(matrix.ravel()))


def test_motors_that_turn_with_later_joints_are_told(recording: Path) -> None:
    """Of gears: those of the recording, 1 all along."""
    gears = tuple((np.eye(6) + np.eye(6, k=1) * 1e-9).ravel())
    found = identify([recording], "ur10_simulated", gears=gears)
    assert any("gears above the diagonal" in note for note in found.notes)
