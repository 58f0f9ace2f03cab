// SPDX-License-Identifier: Apache-2.0

// The fast kernels of one instruction set. Compiled once for each, with CHAIN_DYNAMICS_KERNELS the
// name of the function that gives the table. Everything else has internal linkage, and no header
// but robot.hpp and math.h is used: the linker must not mix functions of different sets.

#include "elementary.hpp"
#include "recursion.hpp"

namespace chain_dynamics::fast {
namespace {

// ---------------------------------------------------------------- structures

/// Joints 2, 3, 4 (the first is 1) are parallel, and right angles elsewhere: Universal Robots.
/// Their description's right angles have nine digits.
using ParallelWrist = Known<6, 0x020022, 0x001100, 0x010010>;

/// Six joints, 2 and 3 parallel, right angles elsewhere: most industrial robots.
using SphericalWrist = Known<6, 0x010111, 0x011100, 0x010110>;

/// Seven joints at right angles: Panda, FR3, iiwa, Gen3.
using RightAngles = Known<7, 0x0111111, 0x0001101, 0x0111110>;

template <typename V>
struct Recursions {
  void (*torques)(const Robot&, const State<V>&, const double* root, V* tau);
  void (*gravity)(const Robot&, const State<V>&, V* g);
  void (*inertia)(const Robot&, const State<V>&, const MatrixLanes<V>& H);
};

template <typename V>
constexpr Recursions<V> kRecursions[] = {
    {torques<AnyStructure, V>, gravity<AnyStructure, V>, inertia<AnyStructure, V>},
    {torques<ParallelWrist, V>, gravity<ParallelWrist, V>, inertia<ParallelWrist, V>},
    {torques<SphericalWrist, V>, gravity<SphericalWrist, V>, inertia<SphericalWrist, V>},
    {torques<RightAngles, V>, gravity<RightAngles, V>, inertia<RightAngles, V>},
};

// Identified models with parameters for each row.
template <typename V>
constexpr Recursions<V> kRecursionsByRow[] = {
    {torquesByRow<AnyStructure, V>, gravityByRow<AnyStructure, V>, inertiaByRow<AnyStructure, V>},
    {torquesByRow<ParallelWrist, V>, gravityByRow<ParallelWrist, V>,
     inertiaByRow<ParallelWrist, V>},
};

int structureOf(const Robot& robot) {
  if (ParallelWrist::covers(robot)) return 1;
  if (robot.rows != nullptr) return 0;
  return SphericalWrist::covers(robot) ? 2 : RightAngles::covers(robot) ? 3 : 0;
}

template <typename V>
FAST_INLINE const Recursions<V>& recursionsOf(const Robot& robot, int structure) {
  return robot.rows != nullptr ? kRecursionsByRow<V>[structure] : kRecursions<V>[structure];
}

// ---------------------------------------------------------------- angles

template <typename V>
FAST_INLINE void addOffset(const V& offset_cos, const V& offset_sin, V& s, V& c) {
  const V sum = s * offset_cos + c * offset_sin;
  c = c * offset_cos - s * offset_sin;
  s = sum;
}

/// Memory for one number per joint, with room for a pack at the end.
struct JointNumbers {
  double values[kMaxJoints + kShortWidth];
};

// Cosine and sine of all joints of one state, several joints at a time.
void turnsOfState(const Robot& robot, const double* q, double* c, double* s) {
  const int n = robot.joints;
  double padded[kShortWidth] = {};
  if (n < kShortWidth) {
    for (int i = 0; i < n; ++i) padded[i] = q[i];
    q = padded;
  }
  ShortBits beyond{};
  for (int i = 0; i < n; i += kShortWidth) {
    // the last pack overlaps the one before
    const int first = n < kShortWidth || i + kShortWidth <= n ? i : n - kShortWidth;
    Short sine;
    Short cosine;
    beyond |=
        sineCosine(load<Short>(q + first), load<Short>(robot.quarter_turns + first), sine, cosine);
    store(sine, s + first);
    store(cosine, c + first);
  }
  if (any<Short>(beyond)) {
    for (int i = 0; i < n; ++i) sineCosineOfAny(q[i], robot.quarter_turns[i], s[i], c[i]);
  }
  if (robot.general_offsets) {
    for (int i = 0; i < n; ++i) {
      addOffset(robot.placements[i].offset_cos, robot.placements[i].offset_sin, s[i], c[i]);
    }
  }
  if (robot.mixed) {
    for (int i = 0; i < n; ++i) {
      if (!robot.placements[i].prismatic) continue;
      c[i] = robot.placements[i].offset_cos;
      s[i] = robot.placements[i].offset_sin;
    }
  }
}

// Cosine and sine of all joints, a state in each lane.
void turnsOfPack(const Robot& robot, const Pack* q, Pack* c, Pack* s) {
  for (int i = 0; i < robot.joints; ++i) {
    const Placement& X = robot.placements[i];
    if (X.prismatic) {
      c[i] = all<Pack>(X.offset_cos);
      s[i] = all<Pack>(X.offset_sin);
      continue;
    }
    const double quarter_turns = robot.quarter_turns[i];
    if (any<Pack>(sineCosine(q[i], all<Pack>(quarter_turns), s[i], c[i]))) {
      for (int lane = 0; lane < kWidth; ++lane) {
        double sine;
        double cosine;
        sineCosineOfAny(q[i][lane], quarter_turns, sine, cosine);
        s[i][lane] = sine;
        c[i][lane] = cosine;
      }
    }
    if (robot.general_offsets) {
      addOffset(all<Pack>(X.offset_cos), all<Pack>(X.offset_sin), s[i], c[i]);
    }
  }
}

// ---------------------------------------------------------------- friction

// number(k) is the k-th of kFrictionNumbers.
template <typename V, typename Number>
FAST_INLINE V frictionOf(const V& qd, const Number& number) {
  const V zero{};
  const V one = all<V>(1.0);
  const V sign = (qd > 0.0 ? one : zero) - (qd < 0.0 ? one : zero);
  return number(0) * qd + (number(1) * sign + number(2)) +
         number(3) * (sigmoid<V>(number(4) * (qd + number(5))) - number(6));
}

void frictionOfState(const Robot& robot, const double* qd, double* f) {
  const int n = robot.joints;
  if (robot.friction == nullptr) {
    for (int i = 0; i < n; ++i) f[i] = 0.0 * qd[i];  // keeps a NaN
    return;
  }
  JointNumbers in;
  JointNumbers out;
  __builtin_memcpy(in.values, qd, static_cast<unsigned>(n) * sizeof(double));
  for (int i = 0; i < n; i += kShortWidth) {
    const auto number = [&](int k) { return load<Short>(robot.friction + k * robot.stride + i); };
    store(frictionOf(load<Short>(in.values + i), number), out.values + i);
  }
  __builtin_memcpy(f, out.values, static_cast<unsigned>(n) * sizeof(double));
}

FAST_INLINE Pack frictionOfPack(const Robot& robot, int i, const Pack& qd) {
  if (robot.friction == nullptr) return 0.0 * qd;
  return frictionOf(qd, [&](int k) { return all<Pack>(robot.friction[k * robot.stride + i]); });
}

// ---------------------------------------------------------------- one state, or a pack of states

constexpr double kAtRest[kMaxJoints] = {};
constexpr double kNoGravity[3] = {};

template <typename V>
FAST_INLINE void gravityOf(const Robot& robot, int structure, const State<V>& state, V* g) {
  // parameters of gravity's own are those of all rows
  const bool by_row = robot.rows != nullptr && robot.gravity_bodies == nullptr;
  (by_row ? kRecursionsByRow<V> : kRecursions<V>)[structure].gravity(robot, state, g);
}

template <typename V>
FAST_INLINE void torquesOf(const Robot& robot, int structure, const State<V>& state, V* tau) {
  const Recursions<V>& recursions = recursionsOf<V>(robot, structure);
  if (robot.gravity_bodies == nullptr) {
    recursions.torques(robot, state, robot.root, tau);
    return;
  }
  V g[kMaxJoints];
  recursions.torques(robot, state, kNoGravity, tau);
  gravityOf(robot, structure, state, g);
  for (int i = 0; i < robot.joints; ++i) tau[i] += g[i];
}

template <typename V>
FAST_INLINE void coriolisOf(const Robot& robot, int structure, const State<V>& state, V* c) {
  recursionsOf<V>(robot, structure).torques(robot, state, kNoGravity, c);
}

// ---------------------------------------------------------------- one state

void torquesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                    const double* qdd, double* tau) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  torquesOf(robot, structure, State<double>{c.values, s.values, q, qd, qdd}, tau);
  if (robot.friction == nullptr) return;
  double f[kMaxJoints];
  frictionOfState(robot, qd, f);
  for (int i = 0; i < robot.joints; ++i) tau[i] += f[i];
}

void coriolisOfState(const Robot& robot, int structure, const double* q, const double* qd,
                     double* coriolis) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  coriolisOf(robot, structure, state, coriolis);
}

void gravityOfState(const Robot& robot, int structure, const double* q, double* g) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  gravityOf(robot, structure, State<double>{c.values, s.values, q, nullptr, nullptr}, g);
}

void inertiaOfState(const Robot& robot, int structure, const double* q, Matrices H) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, nullptr, nullptr};
  recursionsOf<double>(robot, structure).inertia(robot, state, MatrixLanes<double>{H, 1});
}

void componentsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                       Matrices H, double* coriolis, double* g) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  recursionsOf<double>(robot, structure).inertia(robot, state, MatrixLanes<double>{H, 1});
  coriolisOf(robot, structure, state, coriolis);
  gravityOf(robot, structure, state, g);
}

// ---------------------------------------------------------------- many states

/// The states of one pack: lanes beyond the last state repeat it.
struct Lanes {
  std::ptrdiff_t first;
  int count;

  std::ptrdiff_t operator[](int lane) const { return first + (lane < count ? lane : count - 1); }
};

// one(lanes) for packs of states from the first to the last.
template <typename One>
FAST_INLINE void forEachPack(std::ptrdiff_t states, const One& one) {
  for (std::ptrdiff_t k = 0; k < states; k += kWidth) {
    const std::ptrdiff_t left = states - k;
    one(Lanes{k, left < kWidth ? static_cast<int>(left) : kWidth});
  }
}

FAST_INLINE void gather(const Robot& robot, const Samples& from, const Lanes& lanes, Pack* to) {
  for (int i = 0; i < robot.joints; ++i) {
    const double* const row = from.data + i * from.joint_step;
    if (from.state_step == 1 && lanes.count == kWidth) {
      to[i] = load<Pack>(row + lanes.first);
    } else {
      for (int lane = 0; lane < kWidth; ++lane) to[i][lane] = row[lanes[lane] * from.state_step];
    }
  }
}

FAST_INLINE void scatter(const Robot& robot, const Pack* from, const Lanes& lanes,
                         const Samples& to) {
  for (int i = 0; i < robot.joints; ++i) {
    double* const row = to.data + i * to.joint_step;
    if (to.state_step == 1 && lanes.count == kWidth) {
      store(from[i], row + lanes.first);
    } else {
      for (int lane = 0; lane < kWidth; ++lane) row[lanes[lane] * to.state_step] = from[i][lane];
    }
  }
}

/// Memory of one pack of states.
struct PackOfStates {
  Pack q[kMaxJoints], c[kMaxJoints], s[kMaxJoints], qd[kMaxJoints], qdd[kMaxJoints];
  State<Pack> state() const { return {c, s, q, qd, qdd}; }

  void readPositions(const Robot& robot, const Samples& from, const Lanes& lanes) {
    gather(robot, from, lanes, q);
    turnsOfPack(robot, q, c, s);
  }
};

MatrixLanes<Pack> matricesAt(const Matrices& H, const Lanes& lanes) {
  return {{H.data + lanes.first * H.state_step, H.row_step, H.column_step, H.state_step},
          lanes.count};
}

void torquesBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                  Samples qdd, Samples tau) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    gather(robot, qd, lanes, x.qd);
    gather(robot, qdd, lanes, x.qdd);
    x.readPositions(robot, q, lanes);
    torquesOf(robot, structure, x.state(), result);
    if (robot.friction != nullptr) {
      for (int i = 0; i < robot.joints; ++i) result[i] += frictionOfPack(robot, i, x.qd[i]);
    }
    scatter(robot, result, lanes, tau);
  });
}

void coriolisBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples c) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    gather(robot, qd, lanes, x.qd);
    for (int i = 0; i < robot.joints; ++i) x.qdd[i] = Pack{};
    x.readPositions(robot, q, lanes);
    coriolisOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, c);
  });
}

void gravityBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Samples g) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    x.readPositions(robot, q, lanes);
    gravityOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, g);
  });
}

void inertiaBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q, Matrices H) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    x.readPositions(robot, q, lanes);
    recursionsOf<Pack>(robot, structure).inertia(robot, x.state(), matricesAt(H, lanes));
  });
}

void componentsBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                     Samples qd, Matrices H, Samples c, Samples g) {
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates x;
    Pack result[kMaxJoints];
    gather(robot, qd, lanes, x.qd);
    for (int i = 0; i < robot.joints; ++i) x.qdd[i] = Pack{};
    x.readPositions(robot, q, lanes);
    recursionsOf<Pack>(robot, structure).inertia(robot, x.state(), matricesAt(H, lanes));
    coriolisOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, c);
    gravityOf(robot, structure, x.state(), result);
    scatter(robot, result, lanes, g);
  });
}

void frictionBatch(const Robot& robot, std::ptrdiff_t states, Samples qd, Samples f) {
  forEachPack(states, [&](const Lanes& lanes) {
    Pack x[kMaxJoints];
    gather(robot, qd, lanes, x);
    for (int i = 0; i < robot.joints; ++i) x[i] = frictionOfPack(robot, i, x[i]);
    scatter(robot, x, lanes, f);
  });
}

void sineCosineOfEach(int count, const double* angle, const double* quarter_turns, double* sine,
                      double* cosine) {
  for (int k = 0; k < count; ++k) {
    Pack s;
    Pack c;
    if (any<Pack>(sineCosine(all<Pack>(angle[k]), all<Pack>(quarter_turns[k]), s, c))) {
      sineCosineOfAny(angle[k], quarter_turns[k], sine[k], cosine[k]);
    } else {
      sine[k] = s[kWidth - 1];
      cosine[k] = c[kWidth - 1];
    }
  }
}

}  // namespace

const Kernels& CHAIN_DYNAMICS_KERNELS() {
  static constexpr Kernels kernels = {CHAIN_DYNAMICS_KERNELS_NAME,
                                      structureOf,
                                      torquesOfState,
                                      coriolisOfState,
                                      gravityOfState,
                                      inertiaOfState,
                                      componentsOfState,
                                      frictionOfState,
                                      torquesBatch,
                                      coriolisBatch,
                                      gravityBatch,
                                      inertiaBatch,
                                      componentsBatch,
                                      frictionBatch,
                                      sineCosineOfEach};
  return kernels;
}

}  // namespace chain_dynamics::fast
