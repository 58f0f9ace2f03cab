# SPDX-License-Identifier: Apache-2.0
"""What every layer uses: packages' data, files, numbers in text, types of arrays, wording."""
