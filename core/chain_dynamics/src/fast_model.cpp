// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/fast_model.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "fast/regroup.hpp"
#include "fast/robot.hpp"
#include "fast_branches.hpp"
#include "fast_model_check.hpp"
#include "springs.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using fast::Body;
using fast::Kernels;
using fast::ManyKernels;
using fast::Robot;

static_assert(FastModel::kMaxJoints == fast::kMaxJoints);
static_assert(kMostFrictionLaws == fast::kMaxLaws);

/// Shift [rad/s] of a step without any: velocities of 1e-100 rad/s would make the kernels' powers of
/// the exponent denormal. It is nothing beside one.
constexpr double kNoDenormals = 1e-40;

/// Rows and joints of arrays that are read a pack at a time.
constexpr std::size_t kPack = 8;
std::size_t padded(std::size_t joints) { return (joints + kPack - 1) / kPack * kPack; }

/// The tables of one instruction set.
struct KernelSet {
  const Kernels* one;
  const ManyKernels* many;
};

/// Those that run on this processor, for so many joints, the best last.
std::vector<KernelSet> usableKernels(int joints) {
  std::vector<KernelSet> usable = {{&fast::kernelsPortable(), &fast::manyKernelsPortable(joints)}};
#ifdef CHAIN_DYNAMICS_KERNELS_V3
  __builtin_cpu_init();
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  if (v3) usable.push_back({&fast::kernelsV3(), &fast::manyKernelsV3(joints)});
#endif
#ifdef CHAIN_DYNAMICS_KERNELS_V4
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd");
  if (v4) usable.push_back({&fast::kernelsV4(), &fast::manyKernelsV4(joints)});
#endif
  return usable;
}

/// Of how many branches the kernels compute a model: of none, if it is a chain without springs.
std::size_t branchCount(const Model& model) {
  return model.branches.empty() && springCount(model) > 0 ? 1 : model.branches.size();
}

/// The model itself, or a chain as a mechanism whose one branch it is.
Model withBranches(const Model& model) {
  Model result = model;
  if (!model.branches.empty()) return result;
  Branch branch{"", model.chain, {}, {}, {}};
  for (Eigen::Index j = 0; j < model.chain.jointCount(); ++j) {
    branch.S.push_back({j, j, 1});
    branch.s.push_back(0);
    branch.link.push_back(j);
  }
  result.branches.push_back(std::move(branch));
  return result;
}

KernelSet kernelsNamed(const std::string& name, int joints) {
  for (const KernelSet& kernels : usableKernels(joints)) {
    if (name == kernels.one->name) return kernels;
  }
  throw ModelError("fast model", "instruction set", joined(FastModel::instructionSets()), name,
                   "leave it empty for the best");
}

}  // namespace

/// What the arrays of the robot are in.
struct FastModel::Data {
  explicit Data(const Model& model)
      : chain(model.chain),
        frames(fast::framesOf(chain)),
        bodies(fast::regrouped(frames, model.chain.links())) {
    stride = padded(bodies.size());
    frames.quarter_turns.resize(stride, 0.0);
    if (!model.gravity_parameters.empty()) {
      gravity_bodies = fast::regrouped(frames, model.gravity_parameters);
    }
    for (const auto& links : model.row_parameters) rows.push_back(fast::regrouped(frames, links));
    fillRowLanes();
    fillFriction(model);
    own = fast::ownPlacements(frames, chain);
    fillRobot();
  }

  /// Of a mechanism, whose branches `made` makes.
  template <class Made>
  Data(const Model& of, const Made& made) : Data(Model(of.chain)) {
    const Model& model = *(robot.model = std::make_unique<const Model>(withBranches(of)));
    std::set<Eigen::Index> links;
    for (const Branch& branch : robot.model->branches) {
      robot.branches.emplace_back(branch, made(Model(branch.chain)));
      for (std::size_t i = 0; i < branch.link.size(); ++i) {
        if (links.insert(branch.link[i]).second) {
          robot.branches.back().own.push_back(static_cast<int>(i));
        }
      }
    }
    robot.links = static_cast<int>(links.size());
    fillMoved();
    robot.load_friction = chain_dynamics::frictionDependsOnLoad(model);
    if (!model.friction.empty() && !robot.load_friction) {
      Model friction_alone(model.chain);
      friction_alone.friction = model.friction;
      friction_alone.friction_places = model.friction_places;
      friction_alone.coupling = model.coupling;
      robot.friction_alone = std::make_unique<const FastModel>(
          friction_alone, robot.branches.front().fast->instructionSet());
    }
    kernels = branchKernels(robot.branches.front().fast->kernels_->name);
    many = manyBranchKernels();
    if (!of.branches.empty()) return;
    // springs aren't among the parameters of links: the regressor is the chain's, whose numbers stand here
    kernels.regressor = robot.branches.front().fast->kernels_->regressor;
    many.regressor = robot.branches.front().fast->many_->regressor;
    many.gram = robot.branches.front().fast->many_->gram;
  }

  /// A coordinate moves the links of the joints that follow it and of those after them.
  void fillMoved() {
    std::vector<std::set<int>> moved(static_cast<std::size_t>(robot.joints));
    for (const FastBranch& of : robot.branches) {
      for (const Follow& entry : of.branch.S) {
        for (const int i : of.own) {
          if (i < entry.joint) continue;
          const Eigen::Index link = of.branch.link[static_cast<std::size_t>(i)];
          moved[static_cast<std::size_t>(entry.coordinate)].insert(static_cast<int>(link));
        }
      }
    }
    for (const std::set<int>& links : moved) robot.moved.emplace_back(links.begin(), links.end());
  }

  void fillRowLanes() {
    if (rows.empty()) return;
    row_lanes.resize(rows.size() * fast::kBodyNumbers * stride, 0.0);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double* numbers = &rows[row].front().mcx;
      for (std::size_t k = 0; k < rows.size() * fast::kBodyNumbers; ++k) {
        row_lanes[k * stride + row] = numbers[k];
      }
      row_pointers.push_back(rows[row].data());
    }
  }

  void fillFriction(const Model& model) {
    const std::vector<FrictionLaw>& laws = model.friction;
    if (laws.empty()) return;
    coupling = model.coupling.transpose();
    robot.changing_steps = coupling.size() > 0;
    const std::size_t law_stride = padded(laws.size());
    robot.laws = static_cast<int>(laws.size());
    robot.law_stride = static_cast<int>(law_stride);
    friction.resize(fast::kFrictionNumbers * law_stride, 0.0);
    for (std::size_t j = 0; j < laws.size(); ++j) {
      FrictionForm form = formOf(laws[j]);
      if (form.alpha != 0 && form.shift == 0) form.shift = kNoDenormals;
      const double* const numbers = &form.fv;
      for (std::size_t k = 0; k < fast::kFrictionNumbers; ++k)
        friction[k * law_stride + j] = numbers[k];
      robot.load_friction = robot.load_friction || form.fl != 0;
      robot.changing_steps = robot.changing_steps || form.fl != 0 || form.fs != 0;
    }
  }

  void fillRobot() {
    robot.joints = static_cast<int>(bodies.size());
    robot.links = robot.joints;
    robot.general_offsets = frames.general_offsets;
    robot.mixed = std::any_of(frames.placements.begin(), frames.placements.end(),
                              [](const fast::Placement& X) { return X.prismatic; });
    std::copy_n(frames.root.data(), 3, robot.root);
    robot.placements = frames.placements.data();
    robot.own = own.data();
    robot.quarter_turns = frames.quarter_turns.data();
    robot.bodies = bodies.data();
    robot.gravity_bodies = gravity_bodies.empty() ? nullptr : gravity_bodies.data();
    robot.rows = rows.empty() ? nullptr : row_pointers.data();
    robot.row_lanes = rows.empty() ? nullptr : row_lanes.data();
    robot.friction = friction.empty() ? nullptr : friction.data();
    robot.coupling = coupling.size() == 0 ? nullptr : coupling.data();
    robot.stride = static_cast<int>(stride);
    robot.base = fast::baseOf(frames, chain);
    robot.tip = fast::tipOf(frames, chain);
  }

  Chain chain;
  fast::Frames frames;
  std::vector<fast::OwnPlacement> own;
  std::vector<Body> bodies;
  std::size_t stride = 0;
  std::vector<Body> gravity_bodies;
  std::vector<std::vector<Body>> rows;
  std::vector<const Body*> row_pointers;
  std::vector<double> row_lanes;
  std::vector<double> friction;
  OwnedMatrix coupling;  // [law][joint]
  FastBranches robot{};
  Kernels kernels{};  // of a mechanism
  ManyKernels many{};
};

std::vector<std::string> FastModel::instructionSets() {
  std::vector<std::string> names;
  for (const KernelSet& kernels : usableKernels(0)) names.emplace_back(kernels.one->name);
  return names;
}

FastModel::FastModel(const Model& model, const std::string& instruction_set) {
  checkModel(model);
  const Eigen::Index n = model.chain.jointCount();
  if (n > kMaxJoints) {
    throw ModelError("fast model of " + model.name, "joints",
                     "at most " + std::to_string(kMaxJoints), std::to_string(n),
                     "use the functions of model.hpp");
  }
  if (branchCount(model) > 0) {
    data_ = std::make_unique<const Data>(model, [&](const Model& branch) {
      auto fast = std::make_unique<const FastModel>(branch, instruction_set);
      warnings_.insert(warnings_.end(), fast->warnings().begin(), fast->warnings().end());
      return fast;
    });
    use(data_->kernels, data_->many);
    return;
  }
  data_ = std::make_unique<const Data>(model);
  if (instruction_set.empty()) {
    useBest(model);
  } else {
    const KernelSet kernels = kernelsNamed(instruction_set, robot().joints);
    use(*kernels.one, *kernels.many);
  }
}

FastModel::FastModel(const Model& changed, const FastModel& original) {
  checkModel(changed);
  const Eigen::Index n = changed.chain.jointCount();
  if (n != original.robot().joints) {
    throw ModelError("fast model of " + changed.name, "joints",
                     std::to_string(original.robot().joints) + ", as the original has",
                     std::to_string(n), "make the model without an original");
  }
  const std::vector<FastBranch>& branches = original.data_->robot.branches;
  if (branchCount(changed) != branches.size()) {
    throw ModelError("fast model of " + changed.name, "branches", std::to_string(branches.size()),
                     std::to_string(branchCount(changed)), "make the model without an original");
  }
  if (!branches.empty()) {
    auto next = branches.begin();
    data_ = std::make_unique<const Data>(changed, [&next](const Model& branch) {
      return std::make_unique<const FastModel>(branch, *(next++)->fast);
    });
    use(data_->kernels, data_->many);
    return;
  }
  data_ = std::make_unique<const Data>(changed);
  use(*original.kernels_, *original.many_);
}

void FastModel::useBest(const Model& model) {
  const std::vector<KernelSet> kernels = usableKernels(robot().joints);
  const auto equals = [&](std::size_t k) {
    use(*kernels[k].one, *kernels[k].many);
    return equalsPlain(*this, model);
  };
  warnings_ = bestEqual(model.name, instructionSets(), equals).warnings;
}

void FastModel::use(const Kernels& kernels, const ManyKernels& many) {
  kernels_ = &kernels;
  many_ = &many;
  structure_ = kernels.structure_of(robot());
}

std::string FastModel::instructionSet() const { return kernels_->name; }

FastModel::~FastModel() = default;

// For fast_model_batches.cpp. Here it would be a call through the table of exported symbols, each time.
const fast::Robot& FastModel::robot() const { return data_->robot; }

void FastModel::torques(const double* q, const double* qd, const double* qdd, double* tau) const {
  kernels_->torques(data_->robot, structure_, q, qd, qdd, tau);
}

void FastModel::inertiaMatrix(const double* q, double* H, std::ptrdiff_t outer_step) const {
  kernels_->inertia(data_->robot, structure_, q, {H, 1, outer_step, 0});
}

void FastModel::coriolisVector(const double* q, const double* qd, double* c) const {
  kernels_->coriolis(data_->robot, structure_, q, qd, c);
}

void FastModel::gravityVector(const double* q, double* g) const {
  kernels_->gravity(data_->robot, structure_, q, g);
}

Eigen::Index FastModel::linkCount() const { return data_->robot.links; }

RegressorGram FastModel::emptyGram(Eigen::Index own_columns) const {
  const FastBranches& robot = data_->robot;
  if (robot.moved.empty()) return RegressorGram(robot.joints, own_columns);
  return {robot.moved, robot.links, own_columns};
}

bool FastModel::frictionDependsOnLoad() const { return data_->robot.load_friction; }

void FastModel::frictionVector(const double* q, const double* qd, double* f) const {
  kernels_->friction(data_->robot, structure_, q, qd, f);
}

void FastModel::dynamicComponents(const double* q, const double* qd, double* H,
                                  std::ptrdiff_t outer_step, double* c, double* g) const {
  kernels_->components(data_->robot, structure_, q, qd, {H, 1, outer_step, 0}, c, g);
}

void FastModel::forwardDynamics(const double* q, const double* qd, const double* tau,
                                double* qdd) const {
  kernels_->forward_dynamics(data_->robot, structure_, q, qd, tau, qdd);
}

void FastModel::regressor(const double* q, const double* qd, const double* qdd, double* Y,
                          std::ptrdiff_t outer_step) const {
  kernels_->regressor(data_->robot, q, qd, qdd, Y, outer_step);
}

void FastModel::torqueDerivatives(const double* q, const double* qd, const double* qdd,
                                  double* dtau_dq, double* dtau_dqd, double* dtau_dqdd,
                                  std::ptrdiff_t outer_step) const {
  kernels_->torque_derivatives(data_->robot, structure_, q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd,
                               outer_step);
}

void FastModel::coriolisMatrix(const double* q, const double* qd, double* C,
                               std::ptrdiff_t outer_step) const {
  kernels_->coriolis_matrix(data_->robot, structure_, q, qd, C, outer_step);
}

void FastModel::tipPose(const double* q, double* R, double* p) const {
  kernels_->tip_pose(data_->robot, structure_, q, R, p);
}

void FastModel::tipJacobian(const double* q, double* J, std::ptrdiff_t outer_step) const {
  kernels_->tip_jacobian(data_->robot, structure_, q, J, outer_step);
}

void FastModel::tipJacobianDerivative(const double* q, const double* qd, double* dJ,
                                      std::ptrdiff_t outer_step) const {
  kernels_->tip_jacobian_derivative(data_->robot, structure_, q, qd, dJ, outer_step);
}

}  // namespace v2
}  // namespace chain_dynamics
