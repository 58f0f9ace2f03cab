// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/time_window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

// Rows `from` to `to` of a field.
void copyRows(const JointStateNumbers& field, std::size_t from, std::size_t to,
              JointStateNumbers& into) {
  into.columns = field.columns;
  into.values.assign(field.row(from), field.row(to));
}

// Messages `from` to `to` of a block; moved if these are all.
void takeMessages(JointStateBlock& block, std::size_t from, std::size_t to, JointStateBlock& into) {
  if (from == 0 && to == block.size()) {
    std::swap(block, into);
    return;
  }
  const auto begin = static_cast<std::ptrdiff_t>(from), end = static_cast<std::ptrdiff_t>(to);
  into.first = block.first + begin;
  into.joint_names = block.joint_names;
  into.frame_id = block.frame_id;
  into.header_stamps.assign(block.header_stamps.begin() + begin, block.header_stamps.begin() + end);
  into.receive_stamps.assign(block.receive_stamps.begin() + begin,
                             block.receive_stamps.begin() + end);
  copyRows(block.position, from, to, into.position);
  copyRows(block.velocity, from, to, into.velocity);
  copyRows(block.effort, from, to, into.effort);
}

}  // namespace

TimeWindow::TimeWindow(std::unique_ptr<JointStateSource> source, TimeSpan window,
                       std::vector<std::string> joints, Clock clock)
    : source_(std::move(source)), window_(window), joints_(std::move(joints)), clock_(clock) {}

bool TimeWindow::next(JointStateBlock& block) {
  if (!looked_) findStart();
  while (true) {
    if (at_ == read_.size()) {
      at_ = 0;
      if (!source_->next(read_)) {
        read_ = {};
        if (!found_ && start_) refuse();
        return false;
      }
    }
    while (at_ < read_.size() && !holds(at_)) ++at_;
    const std::size_t from = at_;
    while (at_ < read_.size() && holds(at_)) ++at_;
    if (from == at_) continue;
    found_ = true;
    const std::size_t all = read_.size();
    takeMessages(read_, from, at_, block);
    if (from == 0 && at_ == all) {
      read_.receive_stamps.clear();
      at_ = 0;
    }
    return true;
  }
}

void TimeWindow::rewind() {
  source_->rewind();
  read_ = {};
  at_ = 0;
  found_ = false;
}

// The clock, and the stamp of the first sample: a recording without headers is read to its end.
void TimeWindow::findStart() {
  std::optional<std::int64_t> header, receive;
  bool stamped = false;
  while (!(header && (stamped || clock_ != Clock::kAuto)) && source_->next(read_)) {
    if (!isSample(read_)) continue;
    if (!header) {
      header = read_.header_stamps.front();
      receive = read_.receive_stamps.front();
    }
    stamped = stamped || std::any_of(read_.header_stamps.begin(), read_.header_stamps.end(),
                                     [](std::int64_t stamp) { return stamp != 0; });
  }
  if (clock_ == Clock::kAuto) clock_ = stamped ? Clock::kHeader : Clock::kReceive;
  start_ = clock_ == Clock::kHeader ? header : receive;
  looked_ = true;
  rewind();
}

bool TimeWindow::isSample(const JointStateBlock& block) {
  return joints_.joints().empty() ||
         joints_.match(block.joint_names) != JointMatching::Found::kNone;
}

// Whether message i of the last block lies in the window; any does if there is no first sample.
bool TimeWindow::holds(std::size_t i) {
  if (!start_) return true;
  const auto& stamps = clock_ == Clock::kReceive ? read_.receive_stamps : read_.header_stamps;
  const double time = nanosecondsBetween(*start_, stamps[i]);
  least_ = std::min(least_, time);
  greatest_ = std::max(greatest_, time);
  return std::round(1e9 * window_.from) <= time && time <= std::round(1e9 * window_.to);
}

void TimeWindow::refuse() const {
  const auto seconds = [](double time) { return formatted("%.9g", time) + " s"; };
  std::string asked;
  if (window_.from > -std::numeric_limits<double>::infinity()) {
    asked += " from " + seconds(window_.from);
  }
  if (window_.to < std::numeric_limits<double>::infinity()) asked += " to " + seconds(window_.to);
  throw RecordingError(where() + ": expected samples" + asked +
                       " after the first one, got none: those of the recording go from " +
                       seconds(1e-9 * least_) + " to " + seconds(1e-9 * greatest_) +
                       "; choose --from and --to in between");
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation
