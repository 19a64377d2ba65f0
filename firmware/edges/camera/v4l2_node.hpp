// The few system calls that a V4L2 camera is made of: the real ones, or a test's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/result.hpp"
#include "base/time.hpp"

namespace rfmvo {

class V4l2Node {
 public:
  virtual ~V4l2Node() = default;  // closes
  // 0, or errno. Interrupted calls are repeated.
  [[nodiscard]] virtual int control(unsigned long request, void* argument) = 0;
  // Null if it fails.
  [[nodiscard]] virtual const std::uint8_t* map(std::size_t bytes, std::int64_t offset) = 0;
  virtual void unmap(const std::uint8_t* start, std::size_t bytes) = 0;
  // True once a picture is there or the device has gone; false after `wait`.
  [[nodiscard]] virtual bool wait(Duration wait) = 0;
};

using OpenV4l2Node = std::function<Result<std::unique_ptr<V4l2Node>>(const std::string& device)>;

// Errors: kNotFound, kUnreadable naming the device.
[[nodiscard]] Result<std::unique_ptr<V4l2Node>> open_v4l2_node(const std::string& device);

}  // namespace rfmvo
