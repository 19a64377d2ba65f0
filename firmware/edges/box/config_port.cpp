#include "edges/box/config_port.hpp"

#include <lcm/lcm-cpp.hpp>

namespace rfmvo {
namespace {

constexpr int kLook_ms = 100;
constexpr int kMostWaiting = 64;

}  // namespace

struct ConfigPort::Impl {
  Impl(const std::string& url, std::string channel_prefix, std::unique_ptr<ConfigServer> answering,
       DeviceClockFunction device)
      : bus(url), prefix(std::move(channel_prefix)), server(std::move(answering)), clock(std::move(device)) {}

  void on_message(const lcm::ReceiveBuffer* buffer, const std::string&) {
    const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    const auto reply = server->on_request(bytes, clock());
    if (reply) (void)bus.publish(prefix + "CONFIG_REPLY", reply->data(), static_cast<unsigned>(reply->size()));
  }
  void run() {
    while (!stop) (void)bus.handleTimeout(kLook_ms);
  }

  lcm::LCM bus;
  std::string prefix;
  std::unique_ptr<ConfigServer> server;
  DeviceClockFunction clock;
  std::atomic<bool> stop{false};
  std::thread thread;
};

ConfigPort::ConfigPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {
  impl_->thread = std::thread([this] { impl_->run(); });
}

ConfigPort::~ConfigPort() {
  impl_->stop = true;
  impl_->thread.join();
}

Result<std::unique_ptr<ConfigPort>> ConfigPort::open(const std::string& url, const std::string& prefix,
                                                     std::unique_ptr<ConfigServer> server, DeviceClockFunction clock) {
  if (!url.starts_with("udpm://")) return std::unique_ptr<ConfigPort>();
  auto impl = std::make_unique<Impl>(url, prefix, std::move(server), std::move(clock));
  if (!impl->bus.good()) return Error{ErrorCode::kUnsupported, "LCM cannot open this url", url};
  lcm::Subscription* subscription = impl->bus.subscribe(prefix + "CONFIG_REQUEST", &Impl::on_message, impl.get());
  (void)subscription->setQueueCapacity(kMostWaiting);
  return std::unique_ptr<ConfigPort>(new ConfigPort(std::move(impl)));
}

}  // namespace rfmvo
