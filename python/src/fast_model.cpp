// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <array>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/friction_laws/smooth_coulomb.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/model_file.hpp>
#include <chain_dynamics/share_states.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "description.hpp"
#include "friction.hpp"
#include "quantities.hpp"
#include "tips.hpp"

INVERSE_DYNAMICS_TOOLS_OBJECT(IdentifiedModel,
                              "inverse_dynamics.identification.result.IdentifiedModel")

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace ids = inverse_dynamics_solver;
using Eigen::Index;

constexpr Index kParameters = 10;

class FastModel {
 public:
  static constexpr const char* kExample =
      "FastModel.from_urdf(load_robot(\"ur10_simulated\").urdf)";

  FastModel(const chain_dynamics::Model& model, std::int64_t threads, const std::string& urdf = "",
            const std::string& root = "", const std::map<std::string, double>& locked_joints = {})
      : model_(model),
        names_(model.chain.jointNames()),
        threads_(threads),
        fast_(model),
        frames_(urdf, {root, names_, locked_joints}) {
    if (threads < 1) {
      throw ids::InvalidParameterValueException(
          ids::errorText("FastModel: argument threads", "", "1 or more", std::to_string(threads)));
    }
  }

  const std::vector<std::string>& joints() const { return names_; }
  Index links() const { return fast_.linkCount(); }
  const chain_dynamics::Model& model() const { return model_; }
  std::int64_t threads() const { return threads_; }
  const chain_dynamics::FastModel& fast() const { return fast_; }
  const Frames& frames() const { return frames_; }

  /// Name and arguments of the function of Python that made it: pickled, it is made again.
  py::tuple origin;

  template <class OfPart>
  void compute(const SolverCall& call, const OfPart& of_part) const {
    call.run([&] {
      chain_dynamics::shareStates(call.count(), threads_, [&](Index first, Index size) {
        of_part(PartOfCall{call, first, size});
      });
    });
  }

 private:
  chain_dynamics::Model model_;
  std::vector<std::string> names_;
  std::int64_t threads_;
  chain_dynamics::FastModel fast_;
  Frames frames_;
};

using Numbers3 = std::array<double, 3>;

/// Links from rows (n, 10).
std::vector<chain_dynamics::LinkParameters> linksOf(const Array& rows, py::ssize_t n) {
  std::vector<chain_dynamics::LinkParameters> links;
  for (py::ssize_t i = 0; i < n; ++i) {
    using Vector10 = Eigen::Matrix<double, kParameters, 1>;
    const Vector10 p = Eigen::Map<const Vector10>(rows.data() + kParameters * i);
    links.push_back(chain_dynamics::LinkParameters::fromVector(p));
  }
  return links;
}

std::unique_ptr<FastModel> fromUrdf(const Description& urdf, const std::string& root,
                                    const Tips& tip, const std::optional<Numbers3>& gravity,
                                    const std::map<std::string, double>& locked_joints,
                                    const ParameterDict& motors, std::int64_t threads) {
  const auto mechanism =
      mechanismFrom(urdf.text, root, tip, gravity, locked_joints, parametersOf(motors));
  auto made = std::make_unique<FastModel>(chain_dynamics::Model(mechanism), threads, urdf.text,
                                          root, locked_joints);
  made->origin = py::make_tuple("from_urdf", urdf.text, root, textOf(tip), gravity, locked_joints,
                                motors, threads);
  return made;
}

std::unique_ptr<FastModel> fromFile(const std::string& path, std::int64_t threads) {
  auto made = std::make_unique<FastModel>(chain_dynamics::modelFromFile(path), threads);
  made->origin = py::make_tuple("from_file", path, threads);
  return made;
}

chain_dynamics::Mechanism mechanismOf(const FastModel& model) {
  const auto& inertia = model.model().motor_inertia;
  return {model.model().chain, model.model().branches, {inertia.begin(), inertia.end()}};
}

/// The robot with the parameters of an IdentifiedModel of identification/result.py.
std::unique_ptr<FastModel> identified(const FastModel& engine, const IdentifiedModel& found) {
  const auto n = static_cast<py::ssize_t>(engine.joints().size());
  const auto links_count = static_cast<py::ssize_t>(engine.fast().linkCount());
  const auto numbers = [&](const char* name, const std::vector<py::ssize_t>& shape) {
    auto array = found.attr(name).cast<Array>();
    requireShape(name, array, shape);
    return array;
  };
  const Array links = numbers("parameters", {links_count, kParameters}),
              rotors = numbers("rotor_inertia", {n}), bands = numbers("torque_deviation", {n}),
              seen = numbers("seen", {3, n, 2});
  std::vector<chain_dynamics::SeenRange> ranges;
  for (py::ssize_t j = 0; j < n; ++j) {
    const auto interval = [&](py::ssize_t of) {
      return chain_dynamics::Interval{seen.at(of, j, 0), seen.at(of, j, 1)};
    };
    ranges.push_back({interval(0), interval(1), interval(2)});
  }
  chain_dynamics::Model model(withLinks(mechanismOf(engine), linksOf(links, links_count),
                                        Eigen::Map<const Eigen::VectorXd>(rotors.data(), n)));
  for (const auto& law :
       found.attr("friction").cast<std::vector<chain_dynamics::SmoothCoulomb>>()) {
    model.friction.emplace_back(law);
  }
  if (const py::object coupling = found.attr("coupling"); !coupling.is_none()) {
    model.coupling = states(coupling.cast<Array>(), "coupling").transpose();
  }
  const py::dict places = found.attr("friction_at");  // in the order of the last rows of coupling
  for (const auto& [place, law] : places) {
    model.friction_places.push_back(place.cast<std::string>());
    model.friction.emplace_back(law.cast<chain_dynamics::SmoothCoulomb>());
  }
  if (const py::object springs = found.attr("springs"); !springs.is_none()) {
    const auto rows = springs.cast<Array>();  // stiffness, lever_sin, lever_cos of each joint
    requireShape("springs", rows, {n, 3});
    const auto columns = states(rows, "springs");
    model.stiffness = columns.row(0).transpose();
    model.rest = Eigen::VectorXd::Zero(n);
    model.levers = columns.bottomRows(2);
  }
  model.torque_deviation = Eigen::Map<const Eigen::VectorXd>(bands.data(), n);
  model.seen = std::move(ranges);
  auto made = std::make_unique<FastModel>(model, engine.threads());
  made->origin = py::make_tuple("identified", py::cast(engine), found);
  return made;
}

std::string fileText(const FastModel& of, const std::string& name, const std::string& source,
                     const std::string& validity) {
  chain_dynamics::Model model = of.model();
  model.name = name;
  model.source = source;
  model.validity = validity;
  return chain_dynamics::modelFileText(model);
}

/// A chain from rows (n, 3, 3), (n, 3) and (n, 10), one per joint.
std::unique_ptr<FastModel> fromJoints(const std::vector<std::string>& names,
                                      const std::vector<bool>& prismatic, const Array& rotations,
                                      const Array& offsets, const Array& links,
                                      const Numbers3& gravity, std::int64_t threads) {
  const auto n = static_cast<py::ssize_t>(names.size());
  if (static_cast<py::ssize_t>(prismatic.size()) != n || rotations.size() != 9 * n ||
      offsets.size() != 3 * n || links.size() != kParameters * n) {
    throw ids::SizeMismatchException(ids::errorText(
        "FastModel.from_joints", "wrong shape",
        "for n names n of prismatic, (n, 3, 3) rotations, (n, 3) offsets and (n, 10) "
        "links",
        "others"));
  }
  std::vector<chain_dynamics::Joint> joints;
  for (py::ssize_t i = 0; i < n; ++i) {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    chain_dynamics::Joint joint;
    joint.name = names[static_cast<std::size_t>(i)];
    joint.type = prismatic[static_cast<std::size_t>(i)] ? chain_dynamics::JointType::kPrismatic
                                                        : chain_dynamics::JointType::kContinuous;
    joint.placement.R = Eigen::Map<const RowMajor>(rotations.data() + 9 * i);
    joint.placement.p = Eigen::Map<const Eigen::Vector3d>(offsets.data() + 3 * i);
    joints.push_back(joint);
  }
  const chain_dynamics::Chain chain("joints", joints, linksOf(links, n),
                                    Eigen::Vector3d(gravity.data()));
  auto made = std::make_unique<FastModel>(chain_dynamics::Model(chain), threads);
  const auto kept = [](const Array& given) { return given.attr("copy")(); };  // it may change
  made->origin = py::make_tuple("from_joints", names, prismatic, kept(rotations), kept(offsets),
                                kept(links), gravity, threads);
  return made;
}

/// What pickle gave back of an origin.
std::unique_ptr<FastModel> restored(const py::tuple& origin) {
  const auto name = origin[0].cast<std::string>();
  if (name == "from_urdf") {
    return fromUrdf(Description{origin[1].cast<std::string>(), ""}, origin[2].cast<std::string>(),
                    origin[3].cast<std::string>(), origin[4].cast<std::optional<Numbers3>>(),
                    origin[5].cast<std::map<std::string, double>>(),
                    origin[6].cast<ParameterDict>(), origin[7].cast<std::int64_t>());
  }
  if (name == "from_file") {
    return fromFile(origin[1].cast<std::string>(), origin[2].cast<std::int64_t>());
  }
  if (name == "identified") {
    return identified(origin[1].cast<const FastModel&>(), origin[2].cast<IdentifiedModel>());
  }
  return fromJoints(origin[1].cast<std::vector<std::string>>(), origin[2].cast<std::vector<bool>>(),
                    origin[3].cast<Array>(), origin[4].cast<Array>(), origin[5].cast<Array>(),
                    origin[6].cast<Numbers3>(), origin[7].cast<std::int64_t>());
}

void bindMaking(py::class_<FastModel>& model) {
  const auto gravity = "gravity"_a, threads = "threads"_a;
  model
      .def_static("from_urdf", &fromUrdf, "urdf"_a, py::kw_only(), "root"_a = "", "tip"_a = "",
                  gravity = py::none(), "locked_joints"_a = std::map<std::string, double>(),
                  "motors"_a = dictOf({}), threads = 1,
                  R"(Of a URDF, without the friction that it states.

Parameters
----------
urdf : str or path
    Text of the description, or path of a .urdf or .xacro file.
root : str, optional
    The link that is held; by default the description's.
tip : str or list of str, optional
    The last link, by default that of the description's chain. Several, also with commas between them, or "*"
    for all leaves: a tree.
gravity : sequence of 3 floats, optional
    m/s^2, in the axes of the root link.
locked_joints : dict, optional
    Positions (rad, m) of joints that are held, by name: of the chain, which lacks them, or beside it.
motors : dict, optional
    Parameters `motors` and `motor_names` of a solver: the joints of the model are then the motors.
threads : int, optional
    Among how many a large batch is shared.

Returns
-------
FastModel)")
      .def_static("from_file", &fromFile, "path"_a, py::kw_only(), threads = 1,
                  R"(Of a model file, with its friction.

Parameters
----------
path : str
    The file.
threads : int, optional
    Among how many a large batch is shared.

Returns
-------
FastModel)")
      .def_static("from_joints", &fromJoints, "names"_a, "prismatic"_a, "rotations"_a, "offsets"_a,
                  "links"_a, py::kw_only(), gravity, threads = 1,
                  R"(Of joints about or along z of their links' frames.

Parameters
----------
names, prismatic : sequences of n
rotations, offsets : array_like, (n, 3, 3) and (n, 3)
    Of each frame in the one before; m.
links : array_like, (n, 10)
    m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz of each link, in its frame, about its origin.
gravity : sequence of 3 floats
    m/s^2.
threads : int, optional
    Among how many a large batch is shared.

Returns
-------
FastModel)");
}

void bindQuantities(py::class_<FastModel>& model) {
  using M = const FastModel&;
  using Part = const PartOfCall&;
  Quantities<FastModel>(model)
      .add(kTorques,
           [](M m, Part p) { m.fast().torquesBatch(p.in(0), p.in(1), p.in(2), p.states(0)); })
      .add(kInertiaMatrix, [](M m, Part p) { m.fast().inertiaMatrixBatch(p.in(0), p.matrices(0)); })
      .add(kCoriolisVector,
           [](M m, Part p) { m.fast().coriolisVectorBatch(p.in(0), p.in(1), p.states(0)); })
      .add(kGravityVector, [](M m, Part p) { m.fast().gravityVectorBatch(p.in(0), p.states(0)); })
      .add(kAccelerations,
           [](M m, Part p) {
             m.fast().forwardDynamicsBatch(p.in(0), p.in(1), p.in(2), p.states(0));
           })
      .add(kTorqueDerivatives,
           [](M m, Part p) {
             m.fast().torqueDerivativesBatch(p.in(0), p.in(1), p.in(2), p.matrices(0),
                                             p.matrices(1), p.matrices(2));
           })
      .add(kCoriolisMatrix,
           [](M m, Part p) { m.fast().coriolisMatrixBatch(p.in(0), p.in(1), p.matrices(0)); })
      .add(kTipPose,
           [](M m, Part p) { m.fast().tipPoseBatch(p.in(0), p.matrices(0), p.states(1)); })
      .add(
          kTipJacobianDerivative,
          [](M m, Part p) { m.fast().tipJacobianDerivativeBatch(p.in(0), p.in(1), p.matrices(0)); })
      .add(kRegressor,
           [](M m, Part p) { m.fast().regressorBatch(p.in(0), p.in(1), p.in(2), p.matrices(0)); })
      .addJacobian([](M m, Part p) { m.fast().tipJacobianBatch(p.in(0), p.matrices(0)); })
      .addPose([](M m, Part p) { m.fast().tipPoseBatch(p.in(0), p.matrices(0), p.states(1)); });
}

}  // namespace

void bindFastModel(py::module_& module) {
  py::class_<FastModel> model(
      module, "FastModel",
      R"(The engine without a plugin, made by from_urdf(), from_file() or from_joints().

Arrays are (n,), one state, or (N, n), one row per state; (n,) among (N, n) is one state for all. Threads: safe;
the GIL is released. Pickled, it is made again.

Examples
--------
>>> from inverse_dynamics import FastModel, load_robot
>>> arm = FastModel.from_urdf(load_robot("ur10_simulated").urdf, threads=2)
>>> arm.torques([0.5] * 6, [0] * 6, [0] * 6).shape
(6,))");
  bindMaking(model);
  bindQuantities(model);
  model
      .def("identified", &identified, "found"_a,
           R"(The same chain with links, rotors and friction that were identified.

Parameters
----------
found : IdentifiedModel
    `model` of an Identification.

Returns
-------
FastModel)")
      .def("file_text", &fileText, py::kw_only(), "name"_a, "source"_a, "validity"_a,
           R"(The text of a model file, of which from_file() makes this model.

Parameters
----------
name, source, validity : str
    What the file says about the model.

Returns
-------
str)")
      .def("__repr__",
           [](const FastModel& m) {
             return "<FastModel: " + std::to_string(m.joints().size()) + " joints, " +
                    m.joints().front() + " to " + m.joints().back() + ">";
           })
      .def(py::pickle([](const FastModel& m) { return m.origin; }, &restored))
      .def_property_readonly(
          "joint_names", [](const FastModel& m) { return tupleOf(m.joints()); },
          "Names of the joints, from root to tip: the order of all arrays.")
      .def_property_readonly(
          "parameters",
          [](const FastModel& m) {
            const auto links = chain_dynamics::linksOf(mechanismOf(m));
            Eigen::VectorXd all(kParameters * static_cast<Index>(links.size()));
            for (std::size_t i = 0; i < links.size(); ++i) {
              all.segment<kParameters>(kParameters * static_cast<Index>(i)) = links[i].toVector();
            }
            return arrayOf(all);
          },
          "(10 l,) of the rigid bodies: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz of each\n"
          "of l links, in its frame and about its origin.")
      .def_property_readonly(
          "link_joints", [](const FastModel& m) { return tupleOf(linkJoints(mechanismOf(m))); },
          "Names of the joints that move these links; of a chain joint_names.");
}

}  // namespace inverse_dynamics_tools
