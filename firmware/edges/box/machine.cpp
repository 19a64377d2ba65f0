#include "edges/box/machine.hpp"

#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace rfmvo {
namespace {

constexpr std::int64_t kNotBefore_s = 1'704'067'200;  // 2024-01-01: older than this program

}  // namespace

std::optional<double> temperature_c(const std::string& folder) {
  std::optional<double> hottest;
  std::error_code ignored;
  for (std::filesystem::directory_iterator zone(folder, ignored), end; !ignored && zone != end;
       zone.increment(ignored)) {
    std::ifstream file(zone->path() / "temp");
    double milli = 0.0;
    if (file >> milli) hottest = std::max(hottest.value_or(-273.15), milli / 1000.0);
  }
  return hottest;
}

std::optional<std::int64_t> disk_free_bytes(const std::string& path) {
  struct statvfs disk {};
  if (path.empty() || ::statvfs(path.c_str(), &disk) != 0) return std::nullopt;
  return static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
}

std::int64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::int64_t all_pages = 0, resident_pages = 0;
  return file >> all_pages >> resident_pages ? resident_pages * ::sysconf(_SC_PAGESIZE) : 0;
}

Duration cpu_time() {
  struct rusage used {};
  if (::getrusage(RUSAGE_SELF, &used) != 0) return {};
  const std::int64_t s = used.ru_utime.tv_sec + used.ru_stime.tv_sec;
  return {s * 1'000'000'000 + (used.ru_utime.tv_usec + used.ru_stime.tv_usec) * std::int64_t{1000}};
}

bool SystemClock::is_set() const { return s >= kNotBefore_s; }

SystemClock system_clock() {
  struct timex state {};
  const int result = ::adjtimex(&state);
  return {static_cast<std::int64_t>(std::time(nullptr)),
          result >= 0 && result != TIME_ERROR && (state.status & STA_UNSYNC) == 0};
}

}  // namespace rfmvo
