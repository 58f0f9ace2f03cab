// SPDX-License-Identifier: Apache-2.0
#error "ament_index_cpp 1.14.1 has no get_package_share_directory.hpp"
