# SPDX-License-Identifier: Apache-2.0
"""What a robot carries: estimate, files, page, figure, verb."""
