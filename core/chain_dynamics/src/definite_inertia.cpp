// SPDX-License-Identifier: Apache-2.0

#include "definite_inertia.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;

// Of the greatest terms: what rounding leaves of a zero, when frames are changed and terms added.
constexpr double kRounding = 1e-11;
// Boxes whose angles are this well known aren't halved any more: margin of the least eigenvalue.
constexpr double kLeastMargin = 1e-10;
constexpr Index kMostJoints = 6;
constexpr int kMostBoxes = 200000;

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostJoints, kMostJoints>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostJoints, 1>;

// V' I V isn't negative for any V: mass >= 0, and no principal moment about the center of mass is
// negative. (A body that breaks the triangle inequality can't exist, but fulfils this.)
bool energyIsNotNegative(const LinkParameters& link) {
  if (link.mass < 0) return false;
  if (link.mass == 0 && !link.first_moment.isZero(0)) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix3<double>> solver(inertiaAboutCenter(link),
                                                              Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] >= -kRounding * link.inertia.cwiseAbs().maxCoeff();
}

/// A matrix of some joints of a group: twice the energy of its links when the others are at rest.
class Block {
 public:
  /// @param whole  the group with all that the links are made of: rounding is relative to that.
  Block(Chain chain, std::vector<Index> rows, const Chain& whole)
      : chain_(std::move(chain)), rows_(std::move(rows)) {
    scale_.resize(size());
    for (Index r = 0; r < size(); ++r) scale_[r] = 1 / std::sqrt(mostInertia(whole, row(r)));
    for (Index j = 1; j < chain_.jointCount(); ++j) {
      if (!isPrismatic(internal::joint(chain_, j))) angles_.push_back(j);
    }
  }

  /// Whether it is definite for all angles. Each box that is looked at counts down `boxes`.
  bool isDefinite(int& boxes) const {
    const auto k = static_cast<Index>(angles_.size());
    std::vector<Box> open = {{Vector::Zero(k), Vector::Constant(k, M_PI)}};
    while (!open.empty()) {
      Box box = std::move(open.back());
      open.pop_back();
      const double margin =
          static_cast<double>(size()) * box.half_widths.sum() * box.half_widths.sum();
      if (isAbove(margin + kRounding, box.center)) continue;
      if (margin < kLeastMargin || --boxes <= 0) return false;

      Index widest = 0;
      const double half = box.half_widths.maxCoeff(&widest) / 2;
      box.half_widths[widest] = half;
      box.center[widest] -= half;
      open.push_back(box);
      box.center[widest] += 2 * half;
      open.push_back(box);
    }
    return true;
  }

 private:
  struct Box {
    Vector center, half_widths;
  };

  Index size() const { return static_cast<Index>(rows_.size()); }
  Index row(Index r) const { return rows_[static_cast<std::size_t>(r)]; }

  // Whether the least eigenvalue of the scaled matrix is greater than `least`; not if it is NaN.
  bool isAbove(double least, const Vector& angles) const {
    Vector q = Vector::Zero(chain_.jointCount());
    for (Index a = 0; a < angles.size(); ++a) q[angles_[static_cast<std::size_t>(a)]] = angles[a];
    Matrix H(q.size(), q.size());
    inertiaMatrix(chain_, q, H);
    Matrix G = scale_.asDiagonal() * H(rows_, rows_) * scale_.asDiagonal();
    G.diagonal().array() -= least;
    return G.allFinite() && Eigen::LLT<Matrix>(G).info() == Eigen::Success;
  }

  // An upper bound of H_jj: no link is farther away than when the chain is stretched out.
  static double mostInertia(const Chain& chain, Index j) {
    const Joint& joint = internal::joint(chain, j);
    double most = joint.rotor_inertia;
    double reach = 0;
    for (Index i = j; i < chain.jointCount(); ++i) {
      const auto link = internal::link<double>(chain.links(), i);
      if (i > j) reach += internal::joint(chain, i).placement.p.norm();
      if (isPrismatic(joint)) {
        most += link.mass;
      } else {
        const double distance = reach + (link.mass > 0 ? link.first_moment.norm() / link.mass : 0);
        most += inertiaAboutCenter(link).norm() + link.mass * distance * distance;
      }
    }
    return most;
  }

  Chain chain_;
  std::vector<Index> rows_;
  Vector scale_;
  std::vector<Index> angles_;  // joints whose position matters
};

/// Joints first .. last with their links, on a root of their own.
Chain groupOf(const Chain& chain, std::size_t first, std::size_t last) {
  const auto begin = static_cast<std::ptrdiff_t>(first);
  const auto end = static_cast<std::ptrdiff_t>(last) + 1;
  std::vector<Joint> joints(chain.joints().begin() + begin, chain.joints().begin() + end);
  joints.front().placement = Transform<double>::identity();
  return {chain.name(), std::move(joints),
          std::vector<LinkParameters>(chain.links().begin() + begin, chain.links().begin() + end),
          Eigen::Vector3d::Zero()};
}

/// The same joints; the links' moments about their centers of mass only.
Chain turningOnly(const Chain& chain) {
  std::vector<LinkParameters> links;
  for (const LinkParameters& link : chain.links()) {
    links.push_back({0, Eigen::Vector3d::Zero(), inertiaAboutCenter(link)});
  }
  return {chain.name(), chain.joints(), std::move(links), chain.gravity()};
}

bool slidesBehindATurn(const Chain& chain) {
  const std::vector<Joint>& joints = chain.joints();
  const auto turn = std::find_if_not(joints.begin(), joints.end(), isPrismatic);
  return std::any_of(turn, joints.end(), isPrismatic);
}

bool groupIsDefinite(const Chain& group, int& boxes) {
  std::vector<Index> all, turns, slides;
  for (Index j = 0; j < group.jointCount(); ++j) {
    all.push_back(j);
    (isPrismatic(internal::joint(group, j)) ? slides : turns).push_back(j);
  }
  if (!slidesBehindATurn(group)) return Block(group, all, group).isDefinite(boxes);
  return Block(turningOnly(group), turns, group).isDefinite(boxes) &&
         Block(group, slides, group).isDefinite(boxes);
}

}  // namespace

bool inertiaIsDefinite(const Chain& chain) {
  const std::vector<LinkParameters>& links = chain.links();
  if (!std::all_of(links.begin(), links.end(), energyIsNotNegative)) return false;
  int boxes = kMostBoxes;
  for (std::size_t first = 0; first < links.size();) {
    std::size_t last = first;
    while (!groupIsDefinite(groupOf(chain, first, last), boxes)) {
      ++last;
      if (last == links.size() || last == first + kMostJoints || boxes <= 0) return false;
    }
    first = last + 1;
  }
  return true;
}

bool inertiaIsDefinite(const std::vector<Branch>& branches) {
  std::set<std::string> at_rest;  // joints, where there is no energy
  for (const Branch& branch : branches) {
    const std::vector<LinkParameters>& links = branch.chain.links();
    if (!std::all_of(links.begin(), links.end(), energyIsNotNegative)) return false;
    const std::vector<Joint>& joints = branch.chain.joints();
    const auto moving = std::find_if(joints.begin(), joints.end(), [&](const Joint& joint) {
      return at_rest.count(joint.name) == 0;
    });
    if (moving == joints.end()) continue;
    const auto first = static_cast<std::size_t>(moving - joints.begin());
    if (!inertiaIsDefinite(groupOf(branch.chain, first, joints.size() - 1))) return false;
    for (const Joint& joint : joints) at_rest.insert(joint.name);
  }
  return true;
}

bool Model::inertiaIsPhysical() const {
  if (!branches.empty()) return inertiaIsDefinite(branches);
  return row_parameters.empty() && inertiaIsDefinite(chain);
}

}  // namespace v2
}  // namespace chain_dynamics
