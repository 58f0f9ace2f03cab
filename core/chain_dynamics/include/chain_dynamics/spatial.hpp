// SPDX-License-Identifier: Apache-2.0

/// @file
/// Spatial vectors: what a rigid body does (motion), what is done to it (force), what it is
/// (inertia).
///
///     Force<double> F_B = I_B * A_B + cross(V_B, I_B * V_B);  // Newton-Euler, in frame B
///     Force<double> F_A = X_AB * F_B;                         // the same force, stated in frame A
///     double power = dot(V_B, F_B);                           // the same number in every frame
///
/// A spatial vector [Featherstone 2008, ch. 2] packs an angular and a linear 3-vector and is stated
/// *in a frame*: expressed in its axes **and** taken at its origin. Velocity at the origin of B is
/// another vector than velocity at the origin of A, even when the axes are parallel, and so is the
/// moment of a force. Changing the frame therefore mixes the two halves:
///
///     motion (angular w, linear v)     v moves by  w x p     a turning body is faster off its axis
///     force  (moment n,  force f)      n moves by  p x f     a lever arm
///
/// Motions and forces change frame differently and must never be added: they are distinct types
/// here, and what makes no sense doesn't compile. Names say the frames: `X_AB` is the pose of B in
/// A, `V_B` a motion stated in B, and neighbouring letters match: `F_A = X_AB * F_B`.
///
/// Members aren't initialised by default construction (a scratch array of them costs nothing).
/// Real time: no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace chain_dynamics {
inline namespace v2 {

template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;
template <typename Scalar>
using Vector10 = Eigen::Matrix<Scalar, 10, 1>;

/// The matrix of the cross product: `skew(a) * b = a x b`.
template <typename Scalar>
Matrix3<Scalar> skew(const Vector3<Scalar>& a) {
  const Scalar zero(0);
  Matrix3<Scalar> a_x;
  a_x << zero, -a.z(), a.y(), a.z(), zero, -a.x(), -a.y(), a.x(), zero;
  return a_x;
}

/// A velocity or an acceleration, at the origin of the frame it is stated in.
template <typename Scalar>
struct Motion {
  Vector3<Scalar> angular;  ///< w, rad/s (acceleration: rad/s^2)
  Vector3<Scalar> linear;   ///< v, m/s (acceleration: m/s^2)

  static Motion zero() { return {Vector3<Scalar>::Zero(), Vector3<Scalar>::Zero()}; }

  template <typename Other>
  Motion<Other> cast() const {
    return {angular.template cast<Other>(), linear.template cast<Other>()};
  }

  Motion& operator+=(const Motion& other) {
    angular += other.angular;
    linear += other.linear;
    return *this;
  }
  friend Motion operator+(Motion a, const Motion& b) { return a += b; }
  friend Motion operator-(const Motion& a, const Motion& b) {
    return {a.angular - b.angular, a.linear - b.linear};
  }
  friend Motion operator*(const Motion& a, const Scalar& factor) {
    return {a.angular * factor, a.linear * factor};
  }
};

/// A force with its moment (or momentum), the moment taken about the origin of the frame.
template <typename Scalar>
struct Force {
  Vector3<Scalar> moment;  ///< n, N m
  Vector3<Scalar> force;   ///< f, N

  static Force zero() { return {Vector3<Scalar>::Zero(), Vector3<Scalar>::Zero()}; }

  template <typename Other>
  Force<Other> cast() const {
    return {moment.template cast<Other>(), force.template cast<Other>()};
  }

  Force& operator+=(const Force& other) {
    moment += other.moment;
    force += other.force;
    return *this;
  }
  friend Force operator+(Force a, const Force& b) { return a += b; }
  friend Force operator-(const Force& a, const Force& b) {
    return {a.moment - b.moment, a.force - b.force};
  }
  friend Force operator*(const Force& a, const Scalar& factor) {
    return {a.moment * factor, a.force * factor};
  }
};

/// Power of a force on a motion, `w . n + v . f` [W]: the same in every frame [Featherstone 2008,
/// sec. 2.6].
template <typename Scalar>
Scalar dot(const Motion<Scalar>& V, const Force<Scalar>& F) {
  return V.angular.dot(F.moment) + V.linear.dot(F.force);
}

/// `V x M`: rate of a motion M that is carried along by V [Featherstone 2008, sec. 2.9].
template <typename Scalar>
Motion<Scalar> cross(const Motion<Scalar>& V, const Motion<Scalar>& M) {
  return {V.angular.cross(M.angular), V.angular.cross(M.linear) + V.linear.cross(M.angular)};
}

/// `V x* F`: rate of a force or momentum F that is carried along by V [Featherstone 2008,
/// sec. 2.9].
template <typename Scalar>
Force<Scalar> cross(const Motion<Scalar>& V, const Force<Scalar>& F) {
  return {V.angular.cross(F.moment) + V.linear.cross(F.force), V.angular.cross(F.force)};
}

/// The ten inertial parameters of a rigid body, stated in a frame: `[m, mc, I]`.
///
/// **The moment of inertia is about the origin of the frame, not about the center of mass.** This
/// is the one place that decides it; everything in this package follows. It makes the equations of
/// motion linear in the parameters, and bodies can be added entry by entry.
template <typename Scalar>
struct SpatialInertia {
  Scalar mass;                   ///< m, kg
  Vector3<Scalar> first_moment;  ///< mc = mass times center of mass, kg m
  Matrix3<Scalar> inertia;       ///< I, symmetric, kg m^2; Ixy = -integral of x y dm

  static SpatialInertia zero() {
    return {Scalar(0), Vector3<Scalar>::Zero(), Matrix3<Scalar>::Zero()};
  }

  /// From what a data sheet or a URDF states: inertia about the center of mass, in parallel axes.
  ///
  /// `I = I_c - m [c]x [c]x` (parallel axes theorem) [Featherstone 2008, sec. 2.13].
  static SpatialInertia fromCenterOfMass(const Scalar& mass, const Vector3<Scalar>& center,
                                         const Matrix3<Scalar>& inertia_about_center) {
    const Matrix3<Scalar> c_x = skew<Scalar>(center);
    return {mass, mass * center, inertia_about_center - mass * (c_x * c_x)};
  }

  /// From `[m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz]`, the order of files and regressor.
  static SpatialInertia fromVector(const Vector10<Scalar>& p) {
    SpatialInertia result{p[0], p.template segment<3>(1), Matrix3<Scalar>()};
    result.inertia << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
    return result;
  }

  /// `[m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz]`.
  Vector10<Scalar> toVector() const {
    Vector10<Scalar> p;
    p << mass, first_moment, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
        inertia(1, 2), inertia(2, 2);
    return p;
  }

  template <typename Other>
  SpatialInertia<Other> cast() const {
    return {static_cast<Other>(mass), first_moment.template cast<Other>(),
            inertia.template cast<Other>()};
  }

  /// Two bodies welded together, both stated in the same frame.
  SpatialInertia& operator+=(const SpatialInertia& other) {
    mass += other.mass;
    first_moment += other.first_moment;
    inertia += other.inertia;
    return *this;
  }
  friend SpatialInertia operator+(SpatialInertia a, const SpatialInertia& b) { return a += b; }

  /// Momentum of a velocity, force of an acceleration: `(I w + mc x v, m v - mc x w)`
  /// [Featherstone 2008, sec. 2.13].
  friend Force<Scalar> operator*(const SpatialInertia& I, const Motion<Scalar>& V) {
    return {I.inertia * V.angular + I.first_moment.cross(V.linear),
            I.mass * V.linear - I.first_moment.cross(V.angular)};
  }
};

/// Pose `X_AB` of a frame B in a frame A; moves vectors from one to the other.
template <typename Scalar>
struct Transform {
  Matrix3<Scalar> R;  ///< R_AB: columns are the axes of B, expressed in A
  Vector3<Scalar> p;  ///< p_AB: origin of B, from the origin of A, expressed in A; m

  static Transform identity() { return {Matrix3<Scalar>::Identity(), Vector3<Scalar>::Zero()}; }

  template <typename Other>
  Transform<Other> cast() const {
    return {R.template cast<Other>(), p.template cast<Other>()};
  }

  /// `X_BA`.
  Transform inverse() const { return {R.transpose(), -(R.transpose() * p)}; }

  /// `X_AC = X_AB X_BC`.
  friend Transform operator*(const Transform& X_AB, const Transform& X_BC) {
    return {X_AB.R * X_BC.R, X_AB.p + X_AB.R * X_BC.p};
  }

  /// `V_A = X_AB V_B` [Featherstone 2008, sec. 2.8].
  friend Motion<Scalar> operator*(const Transform& X_AB, const Motion<Scalar>& V_B) {
    const Vector3<Scalar> w = X_AB.R * V_B.angular;
    return {w, X_AB.R * V_B.linear + X_AB.p.cross(w)};
  }

  /// `F_A = X_AB F_B` [Featherstone 2008, sec. 2.8].
  friend Force<Scalar> operator*(const Transform& X_AB, const Force<Scalar>& F_B) {
    const Vector3<Scalar> f = X_AB.R * F_B.force;
    return {X_AB.R * F_B.moment + X_AB.p.cross(f), f};
  }

  /// `I_A = X_AB I_B`: the same body, stated in frame A [Featherstone 2008, sec. 2.13].
  friend SpatialInertia<Scalar> operator*(const Transform& X_AB,
                                          const SpatialInertia<Scalar>& I_B) {
    const Vector3<Scalar>& p_AB = X_AB.p;
    const Vector3<Scalar> mc = X_AB.R * I_B.first_moment;  // about the origin of B, axes of A

    // I_A = R I R' - [mc]x [p]x - [p]x [mc]x - m [p]x [p]x, written with k = mc + m p / 2
    const Vector3<Scalar> k = mc + (Scalar(0.5) * I_B.mass) * p_AB;
    const Matrix3<Scalar> k_p = k * p_AB.transpose();
    Matrix3<Scalar> inertia = X_AB.R * I_B.inertia * X_AB.R.transpose() - k_p - k_p.transpose();
    inertia.diagonal().array() += Scalar(2) * k.dot(p_AB);
    return {I_B.mass, mc + I_B.mass * p_AB, inertia};
  }

  /// `V_B` of a given `V_A`, without forming the inverse.
  Motion<Scalar> inverseTimes(const Motion<Scalar>& V_A) const {
    return {R.transpose() * V_A.angular, R.transpose() * (V_A.linear + V_A.angular.cross(p))};
  }
};

}  // namespace v2
}  // namespace chain_dynamics
