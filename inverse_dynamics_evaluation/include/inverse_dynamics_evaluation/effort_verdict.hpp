// SPDX-License-Identifier: Apache-2.0

/// @file
/// Which meaning of the recorded efforts fits the data, and how sure that is.
///
///     EffortSums sums(count, 6, drive_gains);
///     for (const auto& [computed, gravity, effort] : blocks) sums.add(computed, gravity, effort);
///     EffortVerdict verdict = sums.verdict();
///     if (verdict.sure) std::cout << verdict.best() << ": " << verdict.summary() << "\n";
///
/// Each meaning predicts the recorded efforts from computed torques `tau`, gravity `g`, drive gains
/// `k`:
///
///     torque                    tau
///     current                   tau / k
///     torque_without_gravity    tau - g
///
/// Predictions are compared with what was recorded, in its own unit, so no meaning gains by being
/// small. Samples follow each other too closely to count one by one: the recording is cut into 20
/// stretches. In each, the error of a meaning is the geometric mean over the joints of its root mean
/// square errors: a ratio of two such errors doesn't depend on units, and joints that can't tell
/// leave it as it is.
///
/// The best meaning is sure if, against every rival, it is better in 17 stretches of 20 (by chance:
/// 1 in 750), its error is smaller by a tenth, and it fits: on the joints that tell, the error is
/// less than prediction and recording differ by if they have nothing to do with each other.
///
/// A base that is mounted in another way than the model says makes `tau - g` better than `tau`, too,
/// up to twice. So gravity is only taken off if that is three times better. Other mistakes of a
/// recording aren't looked at here.
///
/// Currents are only looked at where drive gains are known. Gains fitted to the data would give that
/// meaning a free number per joint, and it would always win.

#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What recorded efforts can mean.
inline constexpr const char* kTorque = "torque";
inline constexpr const char* kCurrent = "current";
inline constexpr const char* kTorqueWithoutGravity = "torque_without_gravity";

/// A meaning, and how far it is from the recorded efforts.
struct EffortCandidate {
  std::string meaning;
  double error = 0;           ///< RMSE as a share of the recorded range, mean over the joints
  double margin = 1;          ///< its error over that of the best meaning: 1 for the best
  Eigen::Index worse_in = 0;  ///< stretches in which the best meaning has a smaller error
};

/// Candidates, the best first, and whether it is sure.
struct EffortVerdict {
  std::vector<EffortCandidate> candidates;  ///< at least one
  bool sure = false;
  Eigen::Index stretches = 0;
  std::string reason;  ///< why it isn't sure, in words

  /// The meaning with the smallest error.
  const std::string& best() const { return candidates.front().meaning; }

  /// Meanings that aren't clearly worse than the best.
  std::vector<std::string> rivals() const;

  /// In words: errors, and in how many stretches the best is better.
  std::string summary() const;
};

/// What a verdict needs to know of samples, gathered in one pass.
class EffortSums {
 public:
  /// @param count        N, how many samples will be added.
  /// @param joints       n.
  /// @param drive_gains  n; N m/A (prismatic N/A); none: currents aren't looked at.
  EffortSums(Eigen::Index count, Eigen::Index joints, std::vector<double> drive_gains);

  /// The next samples, n x any number: computed torques and gravity [N m], efforts as recorded.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& computed,
           const Eigen::Ref<const Eigen::MatrixXd>& gravity,
           const Eigen::Ref<const Eigen::MatrixXd>& effort);

  EffortVerdict verdict() const;

 private:
  using Matrix = chain_dynamics::Owned<Eigen::ArrayXXd>;
  using Vector = chain_dynamics::Owned<Eigen::ArrayXd>;
  struct Meaning {
    std::string name;
    Matrix squares;  // n x stretches; of the error
    Vector size;     // n; sum of the prediction squared
    Vector product;  // n; sum of prediction times effort
  };

  Vector rms(const Vector& squares) const;
  std::vector<Matrix> errors() const;
  std::vector<EffortCandidate> ranked(const std::vector<Matrix>& errors) const;
  std::string doubt(const EffortVerdict& verdict, const std::vector<Matrix>& errors) const;

  Eigen::Index count_;
  std::vector<double> drive_gains_;
  std::vector<Eigen::Index> starts_;  // first sample of each stretch
  std::vector<Meaning> meanings_;
  Eigen::Index added_ = 0;
  Vector effort_, gravity_;  // n; sums of squares
  Vector least_, greatest_;  // n; of the efforts
};

/// The verdict on samples in memory.
///
/// @param computed,gravity  n x N; N m (prismatic N).
/// @param effort            n x N; as recorded.
/// @param drive_gains       n, or none.
/// @param mask              N; valid samples. Those that aren't finite are left out, too.
/// @throws EvaluationError: sizes differ.
EffortVerdict compareMeanings(const Eigen::Ref<const Eigen::MatrixXd>& computed,
                              const Eigen::Ref<const Eigen::MatrixXd>& gravity,
                              const Eigen::Ref<const Eigen::MatrixXd>& effort,
                              const std::vector<double>& drive_gains, const Mask& mask);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
