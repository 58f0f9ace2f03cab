// SPDX-License-Identifier: Apache-2.0
/// @file
/// Pinocchio's models and algorithms, of versions that keep them in other headers.
#pragma once

#if __has_include(<pinocchio/multibody.hpp>)
#include <pinocchio/multibody.hpp>
#else
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>
#endif
#include <pinocchio/config.hpp>
