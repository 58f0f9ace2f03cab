# SPDX-License-Identifier: Apache-2.0
"""Tests marked `nightly` are skipped unless IDS_NIGHTLY_TESTS is set, as by ./scripts/test --nightly."""

import os

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Names the marker."""
    config.addinivalue_line("markers", "nightly: long, and run by ./scripts/test --nightly only")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skips what only the nightly workflow runs."""
    if os.environ.get("IDS_NIGHTLY_TESTS"):
        return
    skip = pytest.mark.skip(reason="runs each night: ./scripts/test --nightly")
    for item in items:
        if item.get_closest_marker("nightly"):
            item.add_marker(skip)
