# SPDX-License-Identifier: Apache-2.0
"""Results in files, written and read back: evaluations, comparisons, tables, the demonstration."""
