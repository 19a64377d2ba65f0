#include "edges/camera/v4l2_node.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include "edges/net/fd.hpp"

namespace rfmvo {
namespace {

class KernelNode : public V4l2Node {
 public:
  explicit KernelNode(net::Fd fd) : fd_(std::move(fd)) {}

  [[nodiscard]] int control(unsigned long request, void* argument) override {
    int result = 0;
    do result = ::ioctl(fd_.get(), request, argument);
    while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
  }
  [[nodiscard]] const std::uint8_t* map(std::size_t bytes, std::int64_t offset) override {
    void* start = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd_.get(), offset);
    return start == MAP_FAILED ? nullptr : static_cast<const std::uint8_t*>(start);
  }
  void unmap(const std::uint8_t* start, std::size_t bytes) override {
    (void)::munmap(const_cast<std::uint8_t*>(start), bytes);
  }
  [[nodiscard]] bool wait(Duration wait) override {
    pollfd waited{fd_.get(), POLLIN, 0};
    return ::poll(&waited, 1, static_cast<int>(wait.ns / 1'000'000)) > 0;
  }

 private:
  net::Fd fd_;
};

}  // namespace

Result<std::unique_ptr<V4l2Node>> open_v4l2_node(const std::string& device) {
  net::Fd fd(::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!fd.valid()) {
    const bool missing = errno == ENOENT || errno == ENODEV || errno == ENXIO;
    return Error{missing ? ErrorCode::kNotFound : ErrorCode::kUnreadable,
                 missing ? "no such camera" : std::string("cannot be opened: ") + std::strerror(errno), device};
  }
  return std::unique_ptr<V4l2Node>(std::make_unique<KernelNode>(std::move(fd)));
}

}  // namespace rfmvo
