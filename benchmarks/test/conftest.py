# SPDX-License-Identifier: Apache-2.0
"""The command `ids` in tests."""

import pytest

from inverse_dynamics import cli


@pytest.fixture
def ids(tmp_path, monkeypatch, capsys):
    """Run `ids` in an empty directory; gives exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")

    def run(*arguments):
        try:
            code = cli.main([str(a) for a in arguments])
        except SystemExit as exit_:  # argparse
            code = exit_.code
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run
