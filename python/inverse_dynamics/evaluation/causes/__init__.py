# SPDX-License-Identifier: Apache-2.0
"""Why computed torques don't match the measured ones: mistakes as rivals; compare.py decides."""
