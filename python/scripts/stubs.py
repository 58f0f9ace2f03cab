# SPDX-License-Identifier: Apache-2.0
"""Write _core.pyi, the types of the extension module that was just built, from its signatures and docstrings.

python stubs.py DIRECTORY_OF_THE_MODULE OUT
"""

import sys
from importlib import import_module
from pathlib import Path

from pybind11_stubgen import main

built, out = sys.argv[1:]
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import_module("inverse_dynamics").__path__.append(built)
# Defaults that are objects become `...`; a type that isn't bound, or is bound too late, is an error.
main(["inverse_dynamics._core", "-o", out, "--exit-code", "--ignore-invalid-expressions", "<.*>"])
