# SPDX-License-Identifier: Apache-2.0
"""Several evaluations of one recording, side by side."""
