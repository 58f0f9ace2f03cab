// SPDX-License-Identifier: Apache-2.0
#include "mujoco_arm.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <string>
#include <vector>

#if __has_include(<urdf/model.hpp>)  // newer than jazzy
#include <urdf/model.hpp>
#else
#include <urdf/model.h>
#endif

namespace inverse_dynamics_simulation {
namespace {

using inverse_dynamics_solver::InvalidRobotDescriptionException;

constexpr double kLongestStep = 1e-3;  // s

[[noreturn]] void refuse(const std::string& what) {
  throw InvalidRobotDescriptionException("robot description", "MuJoCo refuses it", "", what,
                                         "simple shapes instead of meshes are understood");
}

void attach(const Payload& payload, mjSpec& spec) {
  if (payload.mass == 0) return;
  mjsBody* const link = mjs_findBody(&spec, payload.link.c_str());
  if (link == nullptr) refuse("no link '" + payload.link + "' that could carry the payload");
  mjsBody* const body = mjs_addBody(link, nullptr);
  body->mass = payload.mass;
  body->explicitinertial = true;
}

mjModel* compiled(const std::string& urdf, const Payload& payload) {
  std::array<char, 1000> error{};
  const std::unique_ptr<mjSpec, void (*)(mjSpec*)> spec(
      mj_parseXMLString(urdf.c_str(), nullptr, error.data(), static_cast<int>(error.size())),
      mj_deleteSpec);
  if (spec == nullptr) refuse(error.data());
  attach(payload, *spec);
  spec->compiler.fusestatic = false;  // each link stays a body, so that its inertia can be written
  spec->compiler.balanceinertia = true;
  spec->compiler.inertiafromgeom = mjINERTIAFROMGEOM_FALSE;
  mjModel* const model = mj_compile(spec.get(), nullptr);
  if (model == nullptr) refuse(mjs_getError(spec.get()));
  return model;
}

Eigen::Quaterniond rotationOf(const urdf::Pose& pose) {
  return {pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z};
}

// Mass, center of mass, moments about the principal axes, and these axes.
void writeInertia(const urdf::Inertial& inertial, std::ptrdiff_t body, mjModel& model) {
  Eigen::Matrix3d tensor;
  tensor << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
      inertial.ixz, inertial.iyz, inertial.izz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(tensor);
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
  const Eigen::Quaterniond rotation = rotationOf(inertial.origin) * Eigen::Quaterniond(axes);

  const urdf::Vector3& center = inertial.origin.position;
  model.body_mass[body] = inertial.mass;
  Eigen::Map<Eigen::Vector3d>(model.body_ipos + 3 * body) << center.x, center.y, center.z;
  Eigen::Map<Eigen::Vector3d>(model.body_inertia + 3 * body) = principal.eigenvalues();
  Eigen::Map<Eigen::Vector4d>(model.body_iquat + 4 * body) << rotation.w(), rotation.x(),
      rotation.y(), rotation.z();
}

void writeTrueInertia(const std::string& urdf, mjModel& model) {
  urdf::Model description;
  if (!description.initString(urdf)) refuse("not a URDF");
  for (const auto& [name, link] : description.links_) {
    const int body = mj_name2id(&model, mjOBJ_BODY, name.c_str());
    if (body > 0 && link->inertial != nullptr) writeInertia(*link->inertial, body, model);
  }
}

Eigen::VectorXd numbersAt(const std::vector<int>& addresses, const mjtNum* all) {
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(addresses.size()));
  for (std::size_t j = 0; j < addresses.size(); ++j) {
    numbers[static_cast<Eigen::Index>(j)] = all[addresses[j]];
  }
  return numbers;
}

}  // namespace

MujocoArm::MujocoArm(const std::string& urdf, const std::vector<std::string>& joints,
                     const Payload& payload)
    : model_(compiled(urdf, payload)) {
  writeTrueInertia(urdf, *model_);
  mju_zero(model_->dof_damping, static_cast<int>(model_->nv));
  mju_zero(model_->dof_frictionloss, static_cast<int>(model_->nv));
  model_->opt.integrator = mjINT_RK4;
  model_->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT;
  data_.reset(mj_makeData(model_.get()));
  mj_setConst(model_.get(), data_.get());
  for (const std::string& joint : joints) {
    const int id = mj_name2id(model_.get(), mjOBJ_JOINT, joint.c_str());
    if (id < 0) refuse("no movable joint '" + joint + "'");
    positions_.push_back(model_->jnt_qposadr[id]);
    velocities_.push_back(model_->jnt_dofadr[id]);
  }
}

void MujocoArm::setPosition(const Eigen::VectorXd& q) {
  mj_resetData(model_.get(), data_.get());
  for (std::size_t j = 0; j < positions_.size(); ++j) {
    data_->qpos[positions_[j]] = q[static_cast<Eigen::Index>(j)];
  }
  mj_forward(model_.get(), data_.get());
}

void MujocoArm::step(const Eigen::VectorXd& tau, double period) {
  if (!(period > 0)) return;
  for (std::size_t j = 0; j < velocities_.size(); ++j) {
    data_->qfrc_applied[velocities_[j]] = tau[static_cast<Eigen::Index>(j)];
  }
  const int steps = static_cast<int>(std::ceil(period / kLongestStep - 1e-9));
  model_->opt.timestep = period / steps;
  for (int k = 0; k < steps; ++k) mj_step(model_.get(), data_.get());
}

Eigen::VectorXd MujocoArm::q() const { return numbersAt(positions_, data_->qpos); }
Eigen::VectorXd MujocoArm::qd() const { return numbersAt(velocities_, data_->qvel); }
Eigen::VectorXd MujocoArm::qdd() const { return numbersAt(velocities_, data_->qacc); }

}  // namespace inverse_dynamics_simulation
