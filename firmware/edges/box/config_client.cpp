#include "edges/box/config_client.hpp"

#include <algorithm>
#include <chrono>
#include <lcm/lcm-cpp.hpp>

#include "edges/lcm_bus.hpp"
#include "rfmvo/config_reply_t.hpp"
#include "rfmvo/config_request_t.hpp"

namespace rfmvo {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPatience{2000}, kAskAgainAfter{400};

std::int64_t random_number() {
  std::int64_t number = 0;
  if (const auto bytes = random_bytes(sizeof(number)))
    for (const std::uint8_t byte : bytes.value()) number = (number << 7) ^ byte;
  return number;
}

Setting setting_of(const config_row_t& row) { return {row.key, row.value, row.unit, row.doc, row.live != 0}; }

}  // namespace

struct ConfigClient::Impl {
  Impl(const std::string& bus_url, std::string channel_prefix)
      : bus(bus_url), url(bus_url), prefix(std::move(channel_prefix)) {}

  void take(const lcm::ReceiveBuffer*, const std::string&, const config_reply_t* message) {
    if (message->id == wanted) reply = *message;
  }
  // A multicast message may be lost: what changes nothing is asked for again.
  Result<config_reply_t> ask(config_request_t& request) {
    request.id = wanted = random_number();
    reply.reset();
    const auto until = SteadyClock::now() + kPatience;
    auto again = SteadyClock::now();
    while (!reply && SteadyClock::now() < until) {
      if (SteadyClock::now() >= again) {
        if (bus.publish(prefix + "CONFIG_REQUEST", &request) != 0)
          return Error{ErrorCode::kUnwritable, "cannot publish", url};
        again += request.verb == "set" ? kPatience : kAskAgainAfter;
      }
      constexpr int kLook_ms = 50;
      (void)bus.handleTimeout(kLook_ms);
    }
    if (!reply) return Error{ErrorCode::kNotFound, "no box answers", url};
    if (reply->ok == 0) return Error{ErrorCode::kUnsupported, reply->error, ""};
    return *reply;
  }
  Result<Setting> ask_for_one(config_request_t& request) {
    auto answer = ask(request);
    if (!answer) return answer.error();
    if (answer.value().rows.size() != 1) return Error{ErrorCode::kMalformed, "the box gives no value", request.key};
    return setting_of(answer.value().rows.front());
  }

  lcm::LCM bus;
  std::string url, prefix;
  std::int64_t wanted = 0;
  std::optional<config_reply_t> reply;
};

ConfigClient::ConfigClient(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ConfigClient::~ConfigClient() = default;

Result<std::unique_ptr<ConfigClient>> ConfigClient::open(const std::string& url, const std::string& prefix) {
  // It knows what is wrong with an url, and whether there is a route.
  if (auto route = LcmBus::create(url, prefix); !route) return route.error();
  auto impl = std::make_unique<Impl>(url, prefix);
  if (!impl->bus.good()) return Error{ErrorCode::kUnsupported, "LCM cannot open this url", url};
  (void)impl->bus.subscribe(prefix + "CONFIG_REPLY", &Impl::take, impl.get());
  return std::unique_ptr<ConfigClient>(new ConfigClient(std::move(impl)));
}

Result<std::vector<Setting>> ConfigClient::list() {
  config_request_t request{};
  request.verb = "list";
  auto answer = impl_->ask(request);
  if (!answer) return answer.error();
  std::vector<Setting> settings;
  for (const config_row_t& row : answer.value().rows) settings.push_back(setting_of(row));
  return settings;
}

Result<Setting> ConfigClient::get(const std::string& key) {
  config_request_t request{};
  request.verb = "get";
  request.key = key;
  return impl_->ask_for_one(request);
}

Result<Setting> ConfigClient::set(const Key& seal, const std::string& key, const std::string& value) {
  config_request_t request{};
  request.verb = "challenge";
  auto answer = impl_->ask(request);
  if (!answer) return answer.error();
  Challenge challenge{};
  std::copy(std::begin(answer.value().challenge), std::end(answer.value().challenge), challenge.begin());
  request.verb = "set";
  request.key = key;
  request.value = value;
  std::copy(challenge.begin(), challenge.end(), std::begin(request.challenge));
  const Mac mac = seal_change(seal, challenge, key, value);
  std::copy(mac.begin(), mac.end(), std::begin(request.mac));
  return impl_->ask_for_one(request);
}

}  // namespace rfmvo
