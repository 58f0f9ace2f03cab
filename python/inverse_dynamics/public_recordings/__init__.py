# SPDX-License-Identifier: Apache-2.0
"""Recordings of real robots that are fetched."""
