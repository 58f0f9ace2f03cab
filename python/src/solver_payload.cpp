// SPDX-License-Identifier: Apache-2.0
#include "solver_payload.hpp"

#include <chain_dynamics/spatial.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;

namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

[[noreturn]] void refuse(const std::string& where, const std::string& expected,
                         const std::string& got) {
  throw ids::InvalidParameterValueException(ids::errorText(where, "", expected, got));
}

/// Numbers of one of these shapes.
Array numbersOf(const std::string& where, const py::object& object, const std::string& expected,
                const std::vector<std::vector<py::ssize_t>>& shapes) {
  const py::array given = py::array::ensure(object);
  if (!given || !hasNumbers(given)) {
    PyErr_Clear();
    refuse(where, expected, py::str(py::type::handle_of(object).attr("__name__")));
  }
  Array array = Array::ensure(given);
  const std::vector<py::ssize_t> shape(array.shape(), array.shape() + array.ndim());
  for (const auto& allowed : shapes) {
    if (shape == allowed) return array;
  }
  refuse(where, expected, "an array of shape " + std::string(py::str(given.attr("shape"))));
}

Eigen::Matrix3d inertiaOf(const py::object& object) {
  const Array numbers =
      numbersOf("set_payload: argument inertia", object,
                "an array (3, 3), or 6 numbers ixx ixy ixz iyy iyz izz", {{3, 3}, {6}});
  const double* const I = numbers.data();
  if (numbers.ndim() == 2) return Eigen::Map<const RowMajor3>(I);
  Eigen::Matrix3d inertia;
  inertia << I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5];
  return inertia;
}

chain_dynamics::Transform<double> frameOf(const py::object& object) {
  const std::string where = "set_payload: argument frame";
  const Array numbers =
      numbersOf(where, object, "an array (4, 4), a pose in the tip frame", {{4, 4}});
  const Eigen::Map<const RowMajor4> X(numbers.data());
  if (X.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    refuse(where, "a last row of 0, 0, 0, 1", "another");
  }
  return {X.topLeftCorner<3, 3>(), X.topRightCorner<3, 1>()};
}

}  // namespace

Eigen::Vector3d vectorOf(const std::string& where, const py::object& numbers) {
  return Eigen::Map<const Eigen::Vector3d>(numbersOf(where, numbers, "3 numbers", {{3}}).data());
}

ids::RigidBody bodyOf(double mass, const py::object& center_of_mass, const py::object& inertia,
                      const py::object& frame) {
  ids::RigidBody body{mass};
  if (!center_of_mass.is_none()) {
    body.center_of_mass = vectorOf("set_payload: argument center_of_mass", center_of_mass);
  }
  if (!inertia.is_none()) body.inertia = inertiaOf(inertia);
  if (!frame.is_none()) body.frame = frameOf(frame);
  return body;
}

py::dict dictionaryOf(const ids::RigidBody& body) {
  Eigen::Matrix4d frame = Eigen::Matrix4d::Identity();
  frame.topLeftCorner<3, 3>() = body.frame.R;
  frame.topRightCorner<3, 1>() = body.frame.p;
  py::dict found;
  found["mass"] = body.mass;
  found["center_of_mass"] = arrayOf(body.center_of_mass);
  found["inertia"] = body.inertia;
  found["frame"] = frame;
  if (!body.tip.empty()) found["tip"] = body.tip;
  return found;
}

}  // namespace inverse_dynamics_tools
