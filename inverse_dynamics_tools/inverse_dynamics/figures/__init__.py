# SPDX-License-Identifier: Apache-2.0
"""Pictures: plots, layouts for PlotJuggler, the robot's shape."""
