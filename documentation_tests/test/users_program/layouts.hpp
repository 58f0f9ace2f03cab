// SPDX-License-Identifier: Apache-2.0
/// @file
/// Size and alignment of what crosses a library, as the flags of a source file make them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

struct Layout {
  std::string type;
  std::size_t size, alignment;
};

/// With the flags of the packages, and with those of the user's program.
std::vector<Layout> packagesLayouts();
std::vector<Layout> usersLayouts();
