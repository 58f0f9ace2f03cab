// SPDX-License-Identifier: Apache-2.0

// Writes C code for one robot with CasADi: what its users compile and call. Two expressions of each
// quantity: our templates on CasADi's scalars, and a textbook recursion [Luh, Walker and Paul 1980;
// Featherstone 2008, sec. 6.2] with the robot's numbers in it.
//
//     casadi_code URDF NAME FILE.c      functions NAME_QUANTITY_templates, NAME_QUANTITY_textbook

#include <casadi/casadi.hpp>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/dynamic_components.hpp>
#include <chain_dynamics/torques.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cmath>
#include <cstddef>
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace Eigen {

template <>
struct NumTraits<casadi::SXElem> : GenericNumTraits<casadi::SXElem> {
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
  enum { ReadCost = 1, AddCost = 2, MulCost = 2 };
  using Real = casadi::SXElem;
  using NonInteger = casadi::SXElem;
  using Nested = casadi::SXElem;
};

}  // namespace Eigen

namespace {

using casadi::SX;
using casadi::SXElem;
using chain_dynamics::Chain;
using Eigen::Index;
using Vector = Eigen::Matrix<SXElem, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<SXElem, Eigen::Dynamic, Eigen::Dynamic>;
using Vector3 = Eigen::Matrix<SXElem, 3, 1>;
using Matrix3 = Eigen::Matrix<SXElem, 3, 3>;

/// What is computed, as expressions.
struct Terms {
  explicit Terms(Index n) : tau(n), c(n), g(n), H(n, n) {}
  Vector tau, c, g;
  Matrix H;
};

SX column(const Eigen::Ref<const Matrix>& numbers) {
  SX all = SX::zeros(numbers.rows(), numbers.cols());
  for (Index i = 0; i < numbers.rows(); ++i) {
    for (Index j = 0; j < numbers.cols(); ++j) all(i, j) = SX(numbers(i, j));
  }
  return all;
}

Vector elements(const SX& symbols) {
  Vector v(symbols.size1());
  for (Index i = 0; i < v.size(); ++i) v[i] = symbols.nonzeros().at(static_cast<std::size_t>(i));
  return v;
}

Terms fromTemplates(const Chain& chain, const Vector& q, const Vector& qd, const Vector& qdd) {
  Terms terms(q.size());
  chain_dynamics::torques(chain, q, qd, qdd, terms.tau);
  chain_dynamics::dynamicComponents(chain, q, qd, terms.H, terms.c, terms.g);
  return terms;
}

// --- the textbook's ---

/// A number as it is, but for what products of rotations leave of zero and one.
SXElem constant(double number) {
  const double whole = std::round(number);
  return std::abs(number - whole) < 1e-13 ? whole : number;
}

struct Textbook {
  Textbook(const Chain& arm, const Vector& q) : chain(arm), n(q.size()) {
    for (Index i = 0; i < n; ++i) {
      const auto& joint = chain.joints()[static_cast<std::size_t>(i)];
      const SXElem c = cos(q[i]);
      const SXElem s = sin(q[i]);
      Matrix3 turn;
      turn << c, -s, SXElem(0), s, c, SXElem(0), SXElem(0), SXElem(0), SXElem(1);
      const Matrix3 fixed = joint.placement.R.unaryExpr(&constant);
      const Vector3 offset = joint.placement.p.unaryExpr(&constant);
      R.push_back(fixed * turn);
      p.push_back(offset);
    }
  }

  Vector torques(const Vector& qd, const Vector& qdd, const Eigen::Vector3d& gravity) const {
    Vector3 w = Vector3::Zero();
    Vector3 dw = Vector3::Zero();
    Vector3 a = (-gravity).unaryExpr(&constant);
    std::vector<Vector3> force, moment;
    for (Index i = 0; i < n; ++i) {
      const Matrix3& R_i = R[static_cast<std::size_t>(i)];
      const Vector3& p_i = p[static_cast<std::size_t>(i)];
      const Vector3 moved = a + dw.cross(p_i) + w.cross(w.cross(p_i));
      a = R_i.transpose() * moved;
      w = (R_i.transpose() * w).eval();
      dw = (R_i.transpose() * dw).eval();
      const Vector3 turning(SXElem(0), SXElem(0), qd[i]);
      dw = (dw + w.cross(turning) + Vector3(SXElem(0), SXElem(0), qdd[i])).eval();
      w = (w + turning).eval();
      const auto& link = chain.links()[static_cast<std::size_t>(i)];
      const Vector3 mc = link.first_moment.unaryExpr(&constant);
      const Matrix3 I = link.inertia.unaryExpr(&constant);
      force.push_back(SXElem(link.mass) * a + dw.cross(mc) + w.cross(w.cross(mc)));
      moment.push_back(I * dw + w.cross(I * w) + mc.cross(a));
    }
    Vector tau(n);
    Vector3 f = Vector3::Zero();
    Vector3 m = Vector3::Zero();
    for (Index i = n - 1; i >= 0; --i) {
      f = (f + force[static_cast<std::size_t>(i)]).eval();
      m = (m + moment[static_cast<std::size_t>(i)]).eval();
      const double rotor = chain.joints()[static_cast<std::size_t>(i)].rotor_inertia;
      tau[i] = m.z() + SXElem(rotor) * qdd[i];
      f = (R[static_cast<std::size_t>(i)] * f).eval();
      m = (R[static_cast<std::size_t>(i)] * m + p[static_cast<std::size_t>(i)].cross(f)).eval();
    }
    return tau;
  }

  /// Composite bodies: mass, first moment and inertia about the frame's origin.
  Matrix inertia() const {
    Matrix H(n, n);
    SXElem mass = 0;
    Vector3 mc = Vector3::Zero();
    Matrix3 I = Matrix3::Zero();
    for (Index i = n - 1; i >= 0; --i) {
      const auto& link = chain.links()[static_cast<std::size_t>(i)];
      mass += link.mass;
      mc = (mc + Vector3(link.first_moment.unaryExpr(&constant))).eval();
      I = (I + Matrix3(link.inertia.unaryExpr(&constant))).eval();
      Vector3 f(-mc.y(), mc.x(), SXElem(0));
      Vector3 m = I.col(2);
      const double rotor = chain.joints()[static_cast<std::size_t>(i)].rotor_inertia;
      H(i, i) = m.z() + SXElem(rotor);
      for (Index j = i; j > 0; --j) {
        f = (R[static_cast<std::size_t>(j)] * f).eval();
        m = (R[static_cast<std::size_t>(j)] * m + p[static_cast<std::size_t>(j)].cross(f)).eval();
        H(i, j - 1) = H(j - 1, i) = m.z();
      }
      carry(static_cast<std::size_t>(i), mass, mc, I);
    }
    return H;
  }

  void carry(std::size_t i, const SXElem& mass, Vector3& mc, Matrix3& I) const {
    const Vector3 turned = R[i] * mc;
    const Matrix3 about = R[i] * I * R[i].transpose();
    const Vector3& o = p[i];
    const SXElem trace = SXElem(2) * turned.dot(o) + mass * o.dot(o);
    I = about - turned * o.transpose() - o * turned.transpose() - mass * o * o.transpose();
    for (int k = 0; k < 3; ++k) I(k, k) += trace;
    for (int k = 0; k < 3; ++k) {  // one half is enough
      for (int l = 0; l < k; ++l) I(k, l) = I(l, k);
    }
    mc = turned + mass * o;
  }

  const Chain& chain;
  Index n;
  std::vector<Matrix3> R;
  std::vector<Vector3> p;
};

Terms fromTextbook(const Chain& chain, const Vector& q, const Vector& qd, const Vector& qdd) {
  const Textbook book(chain, q);
  const Vector zero = Vector::Constant(q.size(), SXElem(0));
  Terms terms(q.size());
  terms.tau = book.torques(qd, qdd, chain.gravity());
  terms.c = book.torques(qd, zero, Eigen::Vector3d::Zero());
  terms.g = book.torques(zero, zero, chain.gravity());
  terms.H = book.inertia();
  return terms;
}

void add(casadi::CodeGenerator& code, const std::string& robot, const std::string& expression,
         const Terms& terms, const std::vector<SX>& x) {
  const auto function = [&](const std::string& quantity, const std::vector<SX>& in,
                            const std::vector<SX>& out) {
    std::string name = robot;
    name += "_" + quantity + "_" + expression;
    code.add(casadi::Function(name, in, out));
  };
  const SX H = SX::densify(column(terms.H));
  const SX c = SX::densify(column(terms.c));
  const SX g = SX::densify(column(terms.g));
  function("torques", x, {SX::densify(column(terms.tau))});
  function("inertia", {x[0]}, {H});
  function("coriolis", {x[0], x[1]}, {c});
  function("gravity", {x[0]}, {g});
  function("components", {x[0], x[1]}, {H, c, g});
}

void write(const std::string& urdf, const std::string& robot, const std::string& file) {
  std::ifstream in(urdf);
  std::stringstream text;
  text << in.rdbuf();
  const Chain chain = chain_dynamics::chainFromUrdf(text.str());
  const auto n = static_cast<casadi_int>(chain.jointCount());
  const std::vector<SX> x = {SX::sym("q", n), SX::sym("qd", n), SX::sym("qdd", n)};
  const Vector q = elements(x[0]), qd = elements(x[1]), qdd = elements(x[2]);

  casadi::CodeGenerator code(file, casadi::Dict{{"with_header", false}, {"mex", false}});
  add(code, robot, "templates", fromTemplates(chain, q, qd, qdd), x);
  add(code, robot, "textbook", fromTextbook(chain, q, qd, qdd), x);
  code.generate();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: casadi_code URDF NAME FILE.c\n";
    return 2;
  }
  try {
    write(argv[1], argv[2], argv[3]);
  } catch (const std::exception& error) {
    std::cerr << "casadi_code: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
