# SPDX-License-Identifier: Apache-2.0
"""Pages of evaluations that are there already."""
