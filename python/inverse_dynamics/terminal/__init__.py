# SPDX-License-Identifier: Apache-2.0
"""The command line: options, values, screen, help."""
