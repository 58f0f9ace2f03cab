# SPDX-License-Identifier: Apache-2.0
"""What is written for the user and read again: evaluations, comparisons, tables, the demonstration."""
