# SPDX-License-Identifier: Apache-2.0
"""What a robot is: run configuration, description, chain, solver."""
