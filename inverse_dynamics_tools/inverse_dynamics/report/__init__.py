# SPDX-License-Identifier: Apache-2.0
"""The report: evaluations as one page of HTML, with the robot in motion beside its torques."""
