// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "shape.hpp"

namespace shapes {

class Square : public Named, public Shape {
 public:
  std::string corners() const override { return "four"; }
};

class Cube : public Solid {};

}  // namespace shapes

PLUGINLIB_EXPORT_CLASS(shapes::Square, shapes::Shape)
PLUGINLIB_EXPORT_CLASS(shapes::Cube, shapes::Solid)
