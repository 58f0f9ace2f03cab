// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a call complains of, for tests. (GoogleMock's ThrowsMessage is younger than ROS 2 humble.)
#pragma once

#include <string>

namespace inverse_dynamics_evaluation {

/// The text of the Error that a call throws; "no error" if it doesn't.
template <class Error, class Call>
std::string errorOf(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace inverse_dynamics_evaluation
