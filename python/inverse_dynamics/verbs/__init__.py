# SPDX-License-Identifier: Apache-2.0
"""The verbs of the command `ids`, a module each: see cli.py."""
