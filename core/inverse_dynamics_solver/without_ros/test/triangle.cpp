// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "shape.hpp"

namespace shapes {

class Triangle : public Shape {
 public:
  std::string corners() const override { return "three"; }
};

}  // namespace shapes

PLUGINLIB_EXPORT_CLASS(shapes::Triangle, shapes::Shape)
