#include "bus/bus_listener.hpp"

#include <deque>
#include <lcm/lcm-cpp.hpp>

#include "bus/udpm_listener.hpp"

namespace rfmvo {
namespace {

// memq:, tcpq:, file: by liblcm, which knows no loss there.
class LiblcmListener : public BusListener {
 public:
  explicit LiblcmListener(const std::string& url) : lcm_(url), url_(url) {
    if (lcm_.good()) lcm_.subscribe(".*", &LiblcmListener::on_message, this);
  }
  [[nodiscard]] bool good() { return lcm_.good(); }

  [[nodiscard]] Result<std::optional<BusMessage>> next(Duration timeout) override {
    if (waiting_.empty() && lcm_.handleTimeout(static_cast<int>(timeout.ns / 1'000'000)) < 0)
      return Error{ErrorCode::kUnreadable, "the bus broke", url_};
    if (waiting_.empty()) return std::optional<BusMessage>();
    BusMessage message = std::move(waiting_.front());
    waiting_.pop_front();
    return std::optional(std::move(message));
  }
  [[nodiscard]] BusLoss loss() const override { return {false, 0, 0}; }

 private:
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    const auto* data = static_cast<const std::uint8_t*>(buffer->data);
    waiting_.push_back({channel, {data, data + buffer->data_size}});
  }
  lcm::LCM lcm_;
  std::string url_;
  std::deque<BusMessage> waiting_;
};

}  // namespace

Result<std::unique_ptr<BusListener>> open_bus_listener(const std::string& url) {
  if (url.starts_with("udpm://")) return UdpmListener::create(url);
  auto listener = std::make_unique<LiblcmListener>(url);
  if (!listener->good()) return Error{ErrorCode::kUnsupported, "LCM cannot open this url", url};
  return std::unique_ptr<BusListener>(std::move(listener));
}

}  // namespace rfmvo
