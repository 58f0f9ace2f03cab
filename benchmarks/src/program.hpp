// SPDX-License-Identifier: Apache-2.0

/// @file
/// What the programs of this package have around their work.
#pragma once

#include <exception>
#include <iostream>

namespace inverse_dynamics_benchmarks {

/// The exit status of run(argc, argv); an exception becomes a line on the standard error, and 1.
inline int statusOf(const char* program, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << program << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace inverse_dynamics_benchmarks
