# SPDX-License-Identifier: Apache-2.0
import pytest

from inverse_dynamics.wording import counted


@pytest.mark.parametrize(("count", "expected"), [(0, "0 joints"), (1, "1 joint"), (2, "2 joints")])
def test_one_thing_is_not_many(count, expected):
    assert counted(count, "joint") == expected
