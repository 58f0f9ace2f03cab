// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <string>

#include "peers.hpp"
#include "states.hpp"
#include "timing.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

struct Delete {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

// Null if MuJoCo refuses it: for an inertia that no body can have, unless it may be balanced.
std::unique_ptr<mjModel, Delete> compiled(const std::string& urdf, bool balanced) {
  std::array<char, 1000> error{};
  const std::unique_ptr<mjSpec, Delete> spec(
      mj_parseXMLString(urdf.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (spec == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
  spec->compiler.inertiafromgeom = mjINERTIAFROMGEOM_FALSE;
  spec->compiler.balanceinertia = static_cast<mjtByte>(balanced);
  return std::unique_ptr<mjModel, Delete>(mj_compile(spec.get(), nullptr));
}

struct MujocoPeer {
  explicit MujocoPeer(const std::string& urdf)
      : model(compiled(urdf, false)), as_described(model != nullptr) {
    if (!as_described) model = compiled(urdf, true);  // other numbers, the same work
    if (model == nullptr) throw std::runtime_error("MuJoCo refuses the robot description");
    data.reset(mj_makeData(model.get()));
    states = std::make_unique<States>(model->nv);
    tau.resize(model->nv);
  }

  void position(Eigen::Index k) {
    mju_copy(data->qpos, states->q.col(k).data(), static_cast<int>(model->nv));
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
  }
  void torques(Eigen::Index k, bool accelerated) {
    position(k);
    mju_copy(data->qvel, states->qd.col(k).data(), static_cast<int>(model->nv));
    mj_comVel(model.get(), data.get());
    if (accelerated) {
      mju_copy(data->qacc, states->qdd.col(k).data(), static_cast<int>(model->nv));
    }
    mj_rne(model.get(), data.get(), accelerated ? 1 : 0, tau.data());
  }
  void inertia(Eigen::Index k) {
    position(k);
    mj_makeM(model.get(), data.get());  // its sparse form
  }

  std::unique_ptr<mjModel, Delete> model;
  bool as_described;
  std::unique_ptr<mjData, Delete> data;
  std::unique_ptr<States> states;
  Eigen::VectorXd tau;
};

}  // namespace

void registerMujoco(const PeerRobot& robot) {
  const auto peer = std::make_shared<MujocoPeer>(robot.urdf);
  peer->torques(0, true);
  if (peer->as_described) requireSameTorques(robot, "MuJoCo", peer->tau);
  const auto add = [&](const char* quantity, auto call) {
    registerOverStates(robot.name + "/" + quantity + "/mujoco", [peer, call](Eigen::Index k) {
      call(*peer, k);
      benchmark::ClobberMemory();
    });
  };
  add("torques", [](MujocoPeer& p, Eigen::Index k) { p.torques(k, true); });
  add("coriolis", [](MujocoPeer& p, Eigen::Index k) { p.torques(k, false); });
  add("inertia", [](MujocoPeer& p, Eigen::Index k) { p.inertia(k); });
}

std::string mujocoVersion() { return mj_versionString(); }

}  // namespace inverse_dynamics_benchmarks
