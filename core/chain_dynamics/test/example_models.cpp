// SPDX-License-Identifier: Apache-2.0
#include "example_models.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include "chain_dynamics/model_file.hpp"
#include "chain_dynamics/urdf.hpp"

namespace chain_dynamics::test {

std::string robotFile(const std::string& name) {
  return std::string(CHAIN_DYNAMICS_ROBOTS_DIR "/") + name;
}

Chain revolute(const Chain& chain) {
  std::vector<Joint> joints = chain.joints();
  for (Joint& joint : joints) joint.type = JointType::kRevolute;
  return Chain(chain.name(), joints, chain.links(), chain.gravity());
}

Chain rightAngled(Index n, std::uint32_t seed, bool sliding) {
  Random random(seed);
  std::vector<Joint> joints = randomChain(n).joints();
  const auto pick = [&](int count) { return static_cast<int>((random() + 1) * 0.4999 * count); };
  for (Joint& joint : joints) {
    joint.type = sliding && pick(4) == 0 ? JointType::kPrismatic : JointType::kRevolute;
    Matrix3<double> R = Matrix3<double>::Identity();
    for (int turn = pick(4); turn > 0; --turn) {
      Matrix3<double> quarter;
      quarter << 1, 0, 0, 0, 0, -1, 0, 1, 0;
      Matrix3<double> about_z;
      about_z << 0, -1, 0, 1, 0, 0, 0, 0, 1;
      R = (R * (pick(2) == 0 ? quarter : about_z)).eval();
    }
    joint.placement.R = R;
    for (int k = 0; k < 3; ++k) joint.placement.p[k] = pick(2) == 0 ? 0.0 : 0.4 * random();
  }
  const Chain like = randomChain(n);
  return Chain("right_angled", joints, like.links(), {0.3, 0.2, -9.8});
}

Model identified(const Chain& chain, bool rows, bool gravity, std::uint32_t seed) {
  Random random(seed);
  Model model(chain);
  const auto links = [&] {
    std::vector<LinkParameters> set;
    for (Index i = 0; i < chain.jointCount(); ++i) set.push_back(randomIdentifiedLink(random));
    return set;
  };
  for (Index j = 0; rows && j < chain.jointCount(); ++j) model.row_parameters.push_back(links());
  if (gravity) model.gravity_parameters = links();
  for (Index j = 0; j < chain.jointCount(); ++j) {
    const double big = 1 + random();
    const FrictionLaw laws[] = {ViscousCoulombOffset{big, random(), random()},
                                ViscousOffsetSigmoid{big, random(), random(), 300 * random(), 0.1},
                                CenteredSigmoid{random(), 20 * big, 0.02 * random()}};
    model.friction.push_back(laws[j % 3]);
  }
  return model;
}

Model withChangingSteps(Model model, std::uint32_t seed) {
  Random random(seed);
  const auto positive = [&random] { return 1.0001 + random(); };
  model.friction.clear();
  for (Index j = 0; j < model.chain.jointCount(); ++j) {
    const double fv = positive(), fc = positive(), fo = random(), shift = 0.1 * random();
    const FrictionLaw laws[] = {
        SmoothCoulomb{fv, fc, 0.05, shift, fo, 0.2 * positive()},
        SmoothCoulomb{fv, fc, 0.3, shift, fo, 0.1 * positive(), positive(), 0.4},
        SmoothCoulomb{fv, fc, 0.02, shift, fo, 0, positive(), 0.2},
        ViscousOffsetSigmoid{fv, fo, fc, 300 * random(), shift}};
    model.friction.push_back(laws[j % 4]);
  }
  return model;
}

/// With motors that move joints before theirs too; changing steps: joints 2 and 3 have no load friction.
Model withCoupling(Model model) {
  const Index n = model.chain.jointCount();
  model.coupling = Eigen::MatrixXd::Identity(n, n);
  model.coupling(2, 1) = 0.7;
  if (n > 3) model.coupling.row(3).head(4) << 0.3, 0, -1.2, 0.9;
  return model;
}

/// Of coupled motors, and with laws beside those of joints.
Model withFrictionPlaces(Model model, Index places) {
  const Index n = model.chain.jointCount();
  Random random(7);
  Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(n + places, n);
  coupling.topRows(n) = model.coupling;
  for (Index k = 0; k < places; ++k) {
    coupling(n + k, k % n) = 1.0001 + random();
    coupling(n + k, (k + 1) % n) = random();
    model.friction_places.push_back("place " + std::to_string(k));
    model.friction.emplace_back(SmoothCoulomb{1.0001 + random(), 2, 0.1, 0.1 * random(), random()});
  }
  model.coupling = coupling;
  return model;
}

Model withSprings(Model model) {
  const Index n = model.chain.jointCount();
  model.stiffness = Eigen::VectorXd::LinSpaced(n, 3, 11);
  model.rest = Eigen::VectorXd::LinSpaced(n, -0.7, 0.4);
  for (Index j = 0; j < n; ++j) {
    const Joint& joint = model.chain.joints()[static_cast<std::size_t>(j)];
    if (j == 1 || joint.type == JointType::kContinuous) model.stiffness[j] = 0;
  }
  model.levers = Eigen::MatrixXd::Zero(2, n);
  model.levers.row(0).setLinSpaced(n, -3, 5);
  model.levers(1, n - 1) = 2.5;
  return model;
}

std::vector<NamedModel> models() {
  std::vector<NamedModel> all;
  for (const Index n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 30, 64}) {
    const std::string joints = std::to_string(n) + " joints";
    all.push_back({"any axes, " + joints, Model(randomChain(n))});
    all.push_back({"any axes, turning, " + joints, Model(revolute(randomChain(n)))});
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
      all.push_back({"right angles, " + joints, Model(rightAngled(n, seed, seed % 2 == 0))});
    }
  }
  for (const Index n : {1, 3, 6, 7, 11}) {
    const std::string joints = std::to_string(n) + " joints";
    all.push_back({"rows, " + joints, identified(randomChain(n), true, false, 1)});
    all.push_back({"gravity, " + joints, identified(randomChain(n), false, true, 2)});
    all.push_back({"rows and gravity, " + joints, identified(randomChain(n), true, true, 3)});
  }
  for (const Index n : {1, 3, 6, 7, 11}) {
    const std::string joints = std::to_string(n) + " joints, changing steps";
    for (const bool gravity : {false, true}) {
      const Model rows = identified(randomChain(n), true, gravity, 1);
      all.push_back(
          {(gravity ? "rows and gravity, " : "rows, ") + joints, withChangingSteps(rows, 5)});
    }
    const Model gravity = identified(randomChain(n), false, true, 2);
    all.push_back({"gravity, " + joints, withChangingSteps(gravity, 6)});
  }
  for (const Index n : {2, 5, 8, 13, 64}) {
    const std::string name = "any axes, " + std::to_string(n) + " joints";
    const Model changing = withChangingSteps(Model(randomChain(n)), 7);
    all.push_back({name + ", changing steps", changing});
    all.push_back({name + ", springs", withSprings(Model(randomChain(n)))});
    all.push_back({name + ", springs, changing steps", withSprings(changing)});
    if (n > 2) all.push_back({name + ", coupled motors", withCoupling(changing)});
    if (n > 2) {
      all.push_back({name + ", more laws", withFrictionPlaces(withCoupling(changing), n)});
      all.push_back({name + ", springs, more laws",
                     withFrictionPlaces(withSprings(withCoupling(changing)), 2)});
    }
  }
  for (const std::string robot : {"ur10", "panda"}) {
    const std::string urdf = textOf(robotFile("urdf/" + robot + ".urdf"));
    const Model model(chainFromUrdf(urdf));
    all.push_back({robot, model});
    all.push_back({robot + ", changing steps", withChangingSteps(model, 8)});
    all.push_back({robot + ", coupled motors", withCoupling(withChangingSteps(model, 8))});
  }
  for (const std::string name :
       {"ur10_identified", "franka_inria_identified", "franka_gaz2019_feasible"}) {
    all.push_back({name, modelFromFile(robotFile("models/" + name + ".yaml"))});
  }
  return all;
}

}  // namespace chain_dynamics::test
