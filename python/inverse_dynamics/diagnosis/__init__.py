# SPDX-License-Identifier: Apache-2.0
"""Why computed and measured torques differ: causes as rivals."""
