// SPDX-License-Identifier: Apache-2.0

/// @file
/// What differs between the releases of rosbag2, found by what there is and not by version.

#pragma once

#include <cstdint>
#include <rosbag2_storage/serialized_bag_message.hpp>
#include <type_traits>

namespace inverse_dynamics_ros {
namespace detail {

template <class Message, class = void>
struct HasReceiveTimestamp : std::false_type {};
template <class Message>
struct HasReceiveTimestamp<Message, std::void_t<decltype(std::declval<Message>().recv_timestamp)>>
    : std::true_type {};

}  // namespace detail

/// When a message was received [ns]: `time_stamp` up to iron, `recv_timestamp` from jazzy on.
template <class Message = rosbag2_storage::SerializedBagMessage>
std::int64_t receiveStamp(const Message& message) {
  if constexpr (detail::HasReceiveTimestamp<Message>::value) {
    return message.recv_timestamp;
  } else {
    return message.time_stamp;
  }
}

}  // namespace inverse_dynamics_ros
