# SPDX-License-Identifier: Apache-2.0
"""From samples to accelerations, computed torques, errors; comparisons of several results."""
