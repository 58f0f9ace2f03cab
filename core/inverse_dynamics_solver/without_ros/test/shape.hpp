// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace shapes {

/// The base class of some plugins.
class Shape {
 public:
  virtual ~Shape() = default;
  virtual std::string corners() const = 0;
};

/// That of others.
class Solid {
 public:
  virtual ~Solid() = default;
};

/// To see that a plugin is returned as its base class, which needn't be the first.
class Named {
 public:
  virtual ~Named() = default;
  std::string name;
};

}  // namespace shapes
