# SPDX-License-Identifier: Apache-2.0
"""What is installed: data, extras, plugins of wheels, the version."""
