# SPDX-License-Identifier: Apache-2.0
"""For every layer: data of packages, files, numbers in text, types of arrays, wording."""
