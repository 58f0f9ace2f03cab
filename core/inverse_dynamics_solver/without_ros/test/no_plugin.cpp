// SPDX-License-Identifier: Apache-2.0
//
// Registers nothing that a build without ROS knows, as a plugin of a ROS workspace.

extern "C" int nothing() { return 0; }
