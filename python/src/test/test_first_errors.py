# SPDX-License-Identifier: Apache-2.0
"""Each error of each plugin as the first thing that a process asks of it: reported, not a crash.

Nothing else keeps the plugin's library open while its exception is on the way to Python.
"""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from example_robots import FRANKA, KDL, PINOCCHIO, RIGID_BODY, UR10

from inverse_dynamics import available_solvers
from inverse_dynamics.installation.ament import package_share

ROBOTS = package_share("inverse_dynamics_robots")
URDF = (ROBOTS / "urdf" / "ur10.urdf").read_text()
MODEL = (ROBOTS / "models" / "franka_gaz2019_feasible.yaml").read_text()

OF_ALL = {
    "an unknown parameter": ({"parameters": {"gravty": 1.0}}, "did you mean 'gravity'"),
    "gravity of the wrong size": (
        {"parameters": {"gravity": [1.0, 2.0]}},
        "'gravity': wrong value",
    ),
    "a parameter of the wrong type": ({"parameters": {"root": 1.0}}, "'root': wrong type"),
    "a value that there isn't": ({"attached": "glued"}, "'attached': wrong value"),
}
OF_DESCRIPTIONS = {
    "no description": ({"urdf": ""}, "robot description: missing"),
    "not XML": ({"urdf": "<robot"}, "robot description"),
    "not a robot": ({"urdf": "<robot name='x'/>"}, "robot description"),
    "a negative mass": ({"urdf": URDF.replace('<mass value="', '<mass value="-')}, "mass"),
    "an unknown tip": ({"tip": "tool9"}, "tool9"),
    "an unknown root": ({"root": "world9"}, "world9"),
}
OF_POOLS = {"no thread": ({"parameters": {"max_threads": 0}}, "'max_threads': wrong value")}
OF_MODELS = {
    "an unknown model": ({"model": "ur100"}, "ur100"),
    "no file": ({"model": "no_such.yaml"}, "no_such.yaml"),
}
MODEL_FILES = {
    "not YAML": "a: [",
    "another schema": MODEL.replace("schema: 1", "schema: 99"),
    "an unknown key": MODEL.replace("\nunits: SI", "\nunites: SI\nunits: SI"),
    "an unknown law": MODEL.replace("law: centered_sigmoid", "law: stiction", 1),
    "other check rows": MODEL.replace("gravity: [0, 0, -9.81]", "gravity: [0, 0, -9.82]"),
}


def cases():
    for plugin in (KDL, PINOCCHIO, RIGID_BODY):
        own = OF_POOLS if plugin != RIGID_BODY else OF_MODELS
        for name, (changed, text) in {**OF_ALL, **OF_DESCRIPTIONS, **own}.items():
            yield plugin, name, {"urdf": URDF, **changed}, text
    for plugin in (UR10, FRANKA):
        for name, (changed, text) in OF_ALL.items():
            yield plugin, name, changed, text
        yield plugin, "a model", {"model": "ur10_identified"}, "parameter 'model'"
    yield "no_such/Solver", "an unknown plugin", {}, "not found"


# Each line of arguments in a process of its own: its exit status, and what it prints. It is forked from one that has
# imported the package, which takes most of the time, and asked nothing of it.
PROGRAM = """
import json, os, signal, sys
from inverse_dynamics import Solver, UserError

for line in sys.stdin:
    read, written = os.pipe()
    child = os.fork()
    if child == 0:
        os.dup2(written, 1)
        os.dup2(written, 2)
        signal.alarm(120)
        try:
            Solver(**json.loads(line))
        except UserError as error:
            print(json.dumps(f"{type(error).__name__} {error}"))
        sys.exit()
    os.close(written)
    with os.fdopen(read) as output:
        printed = output.read()
    print(json.dumps([os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), printed]), flush=True)
"""


@pytest.fixture(scope="module")
def first_error():
    """Class and text of the error that the arguments of a Solver raise in a process of its own."""
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:

        def error_of(arguments):
            print(json.dumps(arguments), file=process.stdin, flush=True)
            status, printed = json.loads(process.stdout.readline())
            assert status == 0, printed
            return json.loads(printed)  # and nothing on stderr

        yield error_of


@pytest.mark.parametrize(
    ("plugin", "arguments", "text"),
    [pytest.param(p, a, t, id=f"{p.split('/')[0]}: {name}") for p, name, a, t in cases()],
)
def test_first_error_is_reported(first_error, plugin, arguments, text):
    if plugin == PINOCCHIO and plugin not in available_solvers():
        pytest.skip("Pinocchio isn't installed")
    error = first_error({"plugin": plugin, **arguments})
    assert error.split(" ", 1)[0].endswith("Error")
    assert text in error


@pytest.mark.parametrize("fault", MODEL_FILES)
def test_first_error_in_a_model_file_is_reported(first_error, fault, tmp_path):
    file = tmp_path / "model.yaml"
    file.write_text(MODEL_FILES[fault])
    assert MODEL_FILES[fault] != MODEL
    error = first_error({"plugin": RIGID_BODY, "model": str(file)})
    assert error.startswith(f"InvalidParameterError parameter 'model': {file}")
