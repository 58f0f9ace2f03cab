# SPDX-License-Identifier: Apache-2.0
"""Results as files: written whole or not at all, plain values, texts of YAML."""
