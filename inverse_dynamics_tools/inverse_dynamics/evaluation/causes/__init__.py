# SPDX-License-Identifier: Apache-2.0
"""Why computed torques don't match the measured ones: one file per kind of mistake, compare.py decides."""
