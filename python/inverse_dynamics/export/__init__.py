# SPDX-License-Identifier: Apache-2.0
"""The series of an evaluation as a table."""
