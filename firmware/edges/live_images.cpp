#include "edges/live_images.hpp"

#include <algorithm>
#include <ctime>

namespace rfmvo {
namespace {

constexpr Duration kLongestSleep{50'000'000};

}  // namespace

LiveImages::LiveImages(std::unique_ptr<ImageFolder> folder, DeviceTime first, DeviceClockFunction clock,
                       const std::atomic<bool>& stop)
    : folder_(std::move(folder)), first_(first), clock_(std::move(clock)), stop_(stop) {}

Result<std::optional<Event>> LiveImages::next() {
  auto result = folder_->next();
  if (!result || !result.value()) return result;
  Event event = *std::move(result).value();
  if (!recorded_first_) recorded_first_ = time_of(event);
  const DeviceTime due = first_ + (time_of(event) - *recorded_first_);
  std::visit([due](auto& e) { e.time = due; }, event);
  if (std::holds_alternative<Start>(event)) return std::optional(std::move(event));
  for (Duration left = due - clock_(); left.ns > 0; left = due - clock_()) {
    if (stop_) return std::optional<Event>();
    const timespec pause{0, static_cast<long>(std::min(left, kLongestSleep).ns)};
    (void)::nanosleep(&pause, nullptr);
  }
  return std::optional(std::move(event));
}

}  // namespace rfmvo
