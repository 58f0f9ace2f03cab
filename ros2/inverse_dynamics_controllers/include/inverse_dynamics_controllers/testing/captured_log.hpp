// SPDX-License-Identifier: Apache-2.0
/// @file
/// What is logged while an object of this class is there.
///
///     CapturedLog log;
///     ...
///     EXPECT_NE(log.text().find("ERROR: ..."), std::string::npos) << log.text();
#pragma once

#include <rcutils/logging.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>

namespace inverse_dynamics_controllers {

class CapturedLog {
 public:
  CapturedLog() : before_(rcutils_logging_get_output_handler()) {
    text_().clear();
    rcutils_logging_set_output_handler(&CapturedLog::handle);
  }
  ~CapturedLog() { rcutils_logging_set_output_handler(before_); }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;

  /// Warnings and errors so far, a line each: `WARN: ...`, `ERROR: ...`.
  std::string text() const {
    const std::lock_guard<std::mutex> lock(mutex_());
    return text_();
  }

  bool has(const std::string& part) const { return text().find(part) != std::string::npos; }

 private:
  static std::string& text_() {
    static std::string text;
    return text;
  }
  static std::mutex& mutex_() {
    static std::mutex mutex;
    return mutex;
  }

  // Without a controller manager nobody initialises the statistics that lyrical's controllers register.
  static void handle(const rcutils_log_location_t*, int severity, const char* name,
                     rcutils_time_point_value_t, const char* format, va_list* arguments) {
    if (severity < RCUTILS_LOG_SEVERITY_WARN) return;
    if (name && std::string_view(name) == "pal_statistics") return;
    std::array<char, 4096> line{};
    std::vsnprintf(line.data(), line.size(), format, *arguments);
    const std::lock_guard<std::mutex> lock(mutex_());
    text_() += std::string(severity == RCUTILS_LOG_SEVERITY_WARN ? "WARN: " : "ERROR: ") +
               line.data() + "\n";
  }

  rcutils_logging_output_handler_t before_;
};

}  // namespace inverse_dynamics_controllers
