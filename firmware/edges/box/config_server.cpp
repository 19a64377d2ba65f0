#include "edges/box/config_server.hpp"

#include <algorithm>

#include "config/config_table.hpp"
#include "edges/box/settings_file.hpp"
#include "rfmvo/config_reply_t.hpp"

namespace rfmvo {
namespace {

constexpr std::size_t kMaxRequestBytes = 4096;  // key and value are at most 1 kB each

config_row_t row_of(const ConfigRow& row, const Config& config) {
  config_row_t m;
  m.key = row.key;
  m.value = text_of(get_value(config, row));
  m.unit = row.unit;
  m.doc = row.doc;
  m.live = row.live ? 1 : 0;
  return m;
}

template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  (void)message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

std::optional<config_request_t> decoded(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMaxRequestBytes) return std::nullopt;
  config_request_t request;
  try {  // a string length of 0 or below throws in the generated code
    if (request.decode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size()))
      return std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  // The generated code does not look at the zeros behind texts; only one way to write a request is good.
  if (!same_bytes(encoded(request), bytes)) return std::nullopt;
  return request;
}

// The key as a row of the table, or the error that names the nearest one.
Result<const ConfigRow*> known(const std::string& key) {
  if (const ConfigRow* row = find_row(key)) return row;
  Config scratch;
  return set_value(scratch, key, false).error();
}

}  // namespace

ConfigServer::ConfigServer(Doors doors, std::optional<Key> key, Key secret)
    : doors_(std::move(doors)), key_(std::move(key)), challenges_(std::move(secret)) {}

Result<Config> ConfigServer::change(const config_request_t& request, DeviceTime now) {
  if (!key_) return Error{ErrorCode::kUnsupported, "this box takes no changes from afar (daemon.key_file)", ""};
  Challenge challenge{};
  std::copy(std::begin(request.challenge), std::end(request.challenge), challenge.begin());
  const Mac good = seal_change(*key_, challenge, request.key, request.value);
  const std::span<const std::uint8_t> given(request.mac);
  if (!same_bytes(good, given)) return Error{ErrorCode::kUnsupported, "not sealed with this box's key", ""};
  if (!challenges_.use(challenge, now))
    return Error{ErrorCode::kUnsupported, "the challenge is used up or too old", ""};
  return doors_.change(request.key, request.value);
}

std::optional<std::vector<std::uint8_t>> ConfigServer::on_request(std::span<const std::uint8_t> bytes, DeviceTime now) {
  const auto request = decoded(bytes);
  if (!request) return std::nullopt;
  config_reply_t reply{};
  reply.id = request->id;
  const auto refuse = [&reply](const Error& error) { reply.error = error.text(); };
  const auto show = [&reply](const ConfigRow& row, const Config& config) { reply.rows.push_back(row_of(row, config)); };
  if (request->verb == "list") {
    const Config config = doors_.running();
    for (const ConfigRow& row : config_rows()) show(row, config);
  } else if (request->verb == "get" || request->verb == "set") {
    const auto row = known(request->key);
    if (!row) {
      refuse(row.error());
    } else {
      const Result<Config> config = request->verb == "get" ? Result<Config>(doors_.running()) : change(*request, now);
      if (!config)
        refuse(config.error());
      else
        show(*row.value(), config.value());
    }
  } else if (request->verb == "challenge") {
    const Challenge challenge = challenges_.make(now);
    std::copy(challenge.begin(), challenge.end(), std::begin(reply.challenge));
  } else {
    refuse({ErrorCode::kMalformed, "the verb is none of list, get, challenge, set", ""});
  }
  reply.ok = reply.error.empty() ? 1 : 0;
  reply.count = static_cast<std::int32_t>(reply.rows.size());
  return encoded(reply);
}

}  // namespace rfmvo
