// How this computer is: temperature, disk, memory, processor, clock.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/time.hpp"

namespace rfmvo {

// The hottest of the kernel's thermal zones; nothing if it has none.
[[nodiscard]] std::optional<double> temperature_c(const std::string& folder = "/sys/class/thermal");
// Free for this program on the disk that `path` is on; nothing if that cannot be asked.
[[nodiscard]] std::optional<std::int64_t> disk_free_bytes(const std::string& path);
[[nodiscard]] std::int64_t resident_bytes();  // of this program; 0: unknown
[[nodiscard]] Duration cpu_time();            // of this program so far

struct SystemClock {
  std::int64_t s = 0;         // since 1970
  bool synchronised = false;  // by a time server
  // It cannot be that early: nobody has set it.
  [[nodiscard]] bool is_set() const;
};
[[nodiscard]] SystemClock system_clock();

}  // namespace rfmvo
