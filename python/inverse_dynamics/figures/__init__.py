# SPDX-License-Identifier: Apache-2.0
"""Pictures: plots, and the robot's shape."""
