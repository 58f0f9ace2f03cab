// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/changeable_robot.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <set>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/spatial.hpp"
#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// All robots that may change. A fork takes their locks, so that the child gets no change half done.
class Forks {
 public:
  static Forks& all() {
    static auto* const kAll = new Forks;  // solvers may outlive static objects
    return *kAll;
  }
  void add(ChangingConditions* one) {
    const std::lock_guard<std::mutex> lock(busy_);
    living_.insert(one);
  }
  void remove(ChangingConditions* one) {
    const std::lock_guard<std::mutex> lock(busy_);
    living_.erase(one);
  }

 private:
  Forks() { pthread_atfork(&before, &inParent, &inChild); }

  static void before() {
    all().busy_.lock();
    for (ChangingConditions* const one : all().living_) {
      one->changes_.lock();
      one->entrance_.lock();
    }
  }
  static void inParent() {
    for (ChangingConditions* const one : all().living_) {
      one->entrance_.unlock();
      one->changes_.unlock();
    }
    all().busy_.unlock();
  }
  static void inChild() {
    // Threads that hold it for a batch aren't there to give it back.
    for (ChangingConditions* const one : all().living_) new (&one->batches_) std::shared_mutex;
    inParent();
  }

  std::mutex busy_;
  std::set<ChangingConditions*> living_;
};

ChangingConditions::ChangingConditions() { Forks::all().add(this); }

ChangingConditions::~ChangingConditions() { Forks::all().remove(this); }

namespace {

/// Index of the tip that carries a body.
std::size_t tipOf(const chain_dynamics::Model& model, const std::string& name,
                  const RigidBody& body) {
  if (body.tip.empty()) return 0;
  const std::vector<std::string> tips = tipNames(model);
  const auto found = std::find(tips.begin(), tips.end(), body.tip);
  if (found != tips.end()) return static_cast<std::size_t>(found - tips.begin());
  throw chain_dynamics::ModelError("payload '" + name + "'", "tip",
                                   tips.front().empty() ? "none, as the one tip has no name"
                                                        : "one of " + chain_dynamics::joined(tips),
                                   "'" + body.tip + "'", "the parameter 'tip' names the tips");
}

}  // namespace

chain_dynamics::SpatialInertia<double> ChangingConditions::Conditions::payload() const {
  auto sum = chain_dynamics::SpatialInertia<double>::zero();
  for (const auto& [name, body] : payloads) sum += inTipFrame(body);
  return sum;
}

chain_dynamics::Model ChangingConditions::Conditions::appliedTo(
    const chain_dynamics::Model& bare) const {
  // Without bodies, the numbers are those of the bare robot, bit by bit.
  std::map<std::size_t, chain_dynamics::SpatialInertia<double>> carried;  // by tip
  for (const auto& [name, body] : payloads) {
    const auto sum =
        carried.emplace(tipOf(bare, name, body), chain_dynamics::SpatialInertia<double>::zero());
    sum.first->second += inTipFrame(body);
  }
  chain_dynamics::Model model = bare;
  for (const auto& [tip, body] : carried) model = withBodyAtTip(model, body, tip);
  return withGravity(model, base.apparentGravity());
}

auto ChangingConditions::readConditions(const Configuration& configuration,
                                        const Eigen::Vector3d& gravity)
    -> std::shared_ptr<const Conditions> {
  auto conditions = std::make_shared<Conditions>();
  conditions->payloads = readPayloads(configuration);
  conditions->base.gravity = gravity;
  return conditions;
}

void ChangingConditions::beginUnder(std::shared_ptr<const Conditions> conditions) noexcept {
  initial_ = conditions;
  current_ = std::move(conditions);
}

bool ChangingConditions::isAsInitialized(const Conditions& conditions) const {
  return conditions.payloads == initial_->payloads &&
         conditions.base.gravity == initial_->base.gravity &&
         conditions.base.acceleration == initial_->base.acceleration;
}

void ChangingConditions::whileUnchanged(const std::function<void()>& compute) const {
  std::unique_lock<std::mutex> entrance(entrance_);
  const std::shared_lock<std::shared_mutex> batch(batches_);
  entrance.unlock();
  compute();
}

void ChangingConditions::publishAlone(const std::function<void()>& publish) {
  const std::lock_guard<std::mutex> entrance(entrance_);
  const std::lock_guard<std::shared_mutex> no_batch(batches_);
  publish();
}

void ChangingConditions::apply(const std::function<void(Conditions&)>& change) {
  const std::lock_guard<std::mutex> lock(changes_);
  const auto next = std::make_shared<Conditions>(*current_);
  change(*next);
  try {
    changeTo(*next);
  } catch (const chain_dynamics::ModelError& e) {
    throw InvalidParameterValueException(e.what());
  }
  current_ = next;
}

void ChangingConditions::changePayloads(const std::function<void(Payloads&)>& change) {
  apply([&](Conditions& conditions) { change(conditions.payloads); });
}

Payloads ChangingConditions::currentPayloads() const {
  const std::lock_guard<std::mutex> lock(changes_);
  return current_->payloads;
}

void ChangingConditions::changeBaseMotion(const std::function<void(BaseMotion&)>& change) {
  apply([&](Conditions& conditions) { change(conditions.base); });
}

auto ChangingConditions::currentBaseMotion() const -> BaseMotion {
  const std::lock_guard<std::mutex> lock(changes_);
  return current_->base;
}

}  // namespace v2
}  // namespace inverse_dynamics_solver
