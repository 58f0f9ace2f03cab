// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the examples of chain_dynamics take for granted. Compiled, never linked.
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/energy.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model_file.hpp>
#include <chain_dynamics/spatial.hpp>
#include <chain_dynamics/torques.hpp>
#include <string>
#include <vector>

using namespace chain_dynamics;

namespace given {

// A robot, and its state.
extern const Chain chain;
extern const Model model;
extern const FastModel fast;
extern const std::string urdf_xml;
extern const Eigen::Index n;
extern Eigen::VectorXd q, qd, qdd, tau, c, g, f;
extern Eigen::MatrixXd H, dJ;

// A joint, the links beside it, and how they move.
extern const Joint joint;
extern const LinkParameters I_1;
extern const SpatialInertia<double> link, I_B;
extern const Transform<double> X_AB;
extern const Motion<double> A_B, V_B;

// What a program does with results.
template <class... Results>
void print(const Results&...);

// What means something else in each header.
namespace fast_model_examples {
extern Eigen::MatrixXd Q, QD, QDD, TAU;
}
namespace friction_examples {
extern const std::vector<FrictionLaw> laws;
extern Eigen::VectorXd f_vector;
}  // namespace friction_examples
namespace joint_axis_examples {
extern double qd, tau;
extern Motion<double> V;
extern Force<double> F;
}  // namespace joint_axis_examples
namespace parameter_sets_examples {
extern const std::vector<std::vector<LinkParameters>> row_parameters;
extern const std::vector<LinkParameters> gravity_parameters;
}  // namespace parameter_sets_examples
namespace regressor_examples {
extern const Eigen::VectorXd rotor_inertia;
}
namespace regressor_gram_examples {
extern Eigen::MatrixXd signs, ones, A;
extern Eigen::VectorXd weights, b;
}  // namespace regressor_gram_examples
namespace share_states_examples {
extern const ConstStates q;
extern const States g;
}  // namespace share_states_examples
namespace states_examples {
extern Eigen::MatrixXd columns, rows;
extern const double* data;
extern const Eigen::Index N;
}  // namespace states_examples

}  // namespace given
