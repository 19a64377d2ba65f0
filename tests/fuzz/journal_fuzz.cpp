// Any file as a journal, and any message of any channel: events, estimates, or an error that says something.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <iterator>
#include <string>

#include "edges/journal.hpp"
#include "edges/lcm_codec.hpp"

using namespace rfmvo;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void read_as_file(const std::uint8_t* data, std::size_t size) {
  const int fd = ::memfd_create("journal", MFD_CLOEXEC);
  require(fd >= 0 && ::write(fd, data, size) == static_cast<ssize_t>(size));
  const std::string path = "/proc/self/fd/" + std::to_string(fd);
  if (auto reader = JournalReader::open(path, "RFMVO_", {false})) {
    while (true) {
      const auto event = reader.value()->next();
      require(event.ok() || !event.error().text().empty());
      if (!event || !event.value()) break;
    }
  }
  (void)read_estimates(path, "RFMVO_");
  ::close(fd);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_as_file(data, size);
  if (size == 0) return 0;
  static constexpr const char* kChannels[] = {"START", "FRAME",       "CAMERA_POSE",   "TAG_READ",     "TICK",
                                              "FAULT", "COMMAND",     "READER_STATUS", "VO_POSE",      "TAG",
                                              "SCALE", "METRIC_POSE", "TRAJECTORY",    "MAP_REVISION", "HEALTH"};
  const std::string channel = std::string("RFMVO_") + kChannels[data[0] % std::size(kChannels)];
  const std::span message(data + 1, size - 1);
  if (is_event_channel(channel, "RFMVO_")) {
    const auto event = decode_event(channel, message, "RFMVO_");
    require(event.ok() || !event.error().text().empty());
    if (event) require(!encode(event.value(), "RFMVO_").data.empty());
  } else {
    const auto estimate = decode_estimate(channel, message, "RFMVO_");
    require(estimate.ok() || !estimate.error().text().empty());
  }
  return 0;
}
