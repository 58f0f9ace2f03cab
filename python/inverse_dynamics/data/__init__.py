# SPDX-License-Identifier: Apache-2.0
"""Recordings: rosbag2, CSV, trajectories, and the public ones."""
