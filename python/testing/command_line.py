# SPDX-License-Identifier: Apache-2.0
"""How a command ended."""


def fails(result, *expected):
    """The user is told, on stderr, without a traceback; exit code 2."""
    code, out, err = result
    assert code == 2
    assert out == ""
    assert "Traceback" not in err
    for part in expected:
        assert part in err
