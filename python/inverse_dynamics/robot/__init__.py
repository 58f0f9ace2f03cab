# SPDX-License-Identifier: Apache-2.0
"""Robots: run configurations, descriptions, and their solvers."""
