# SPDX-License-Identifier: Apache-2.0
"""Motions to identify a robot from: optimiser, files, verb."""
