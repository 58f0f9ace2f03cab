# SPDX-License-Identifier: Apache-2.0
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command_line import fails

import inverse_dynamics

PACKAGE_XML = Path(__file__).resolve().parents[3] / "package.xml"


def test_the_version_is_that_of_package_xml():
    assert inverse_dynamics.__version__ == ElementTree.parse(PACKAGE_XML).findtext("version")
    assert "__version__" in dir(inverse_dynamics)


def test_the_command_prints_it(ids):
    code, out, err = ids("--version")
    assert (code, out, err) == (0, f"ids {inverse_dynamics.__version__}\n", "")


def test_modules_that_were_not_installed_have_none_and_say_so(monkeypatch, ids):
    def missing(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", missing)
    with pytest.raises(
        AttributeError, match="installed by pip, colcon or CMake.*got the modules alone"
    ):
        _ = inverse_dynamics.__version__
    fails(ids("--version"), "ids: error: inverse_dynamics.__version__: expected the package")


def test_importing_the_package_does_not_read_it():
    program = "import sys, inverse_dynamics; print('importlib.metadata' in sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert result.stdout == "False\n"
