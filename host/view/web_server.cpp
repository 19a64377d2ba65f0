#include "view/web_server.hpp"

#include <libwebsockets.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <string_view>
#include <vector>

#include "edges/net/tcp.hpp"

namespace rfmvo::view {
namespace {

constexpr lws_usec_t kTick_us = 100'000;
constexpr std::size_t kMaxHeader = 512;

using Bytes = std::shared_ptr<const std::vector<unsigned char>>;

// libwebsockets writes its framing in front of what it sends.
Bytes framed(const std::string& message) {
  auto bytes = std::make_shared<std::vector<unsigned char>>(LWS_PRE + message.size());
  std::copy(message.begin(), message.end(), bytes->begin() + LWS_PRE);
  return bytes;
}

struct Message {
  std::uint64_t version = 0;
  Bytes bytes;
};

// libwebsockets keeps one of these for each connection, in zeroed memory.
struct Session {
  std::array<std::uint64_t, kSlots> sent;
};

std::string header(lws* wsi, lws_token_indexes which) {
  std::array<char, kMaxHeader> text{};
  const int length = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), which);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : "";
}

std::string without_port(const std::string& host) {
  const std::size_t bracket = host.find(']');
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  return host.substr(0, colon);
}

}  // namespace

struct WebServer::Impl {
  // libwebsockets hands its own part back, which stands first.
  struct Timer {
    lws_sorted_usec_list_t list;
    Impl* impl;
  };

  WebSettings settings;
  Bytes page;
  std::size_t page_bytes = 0;
  lws_context* context = nullptr;
  lws_vhost* vhost = nullptr;
  Timer timer{{}, this};
  std::array<Message, kSlots> messages;
  std::set<lws*> pages;
  const std::function<bool()>* tick = nullptr;
  bool running = false;

  static int on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
  static int on_socket(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
  static void on_timer(lws_sorted_usec_list_t* timer);
  static Impl& of(lws* wsi) { return *static_cast<Impl*>(lws_context_user(lws_get_context(wsi))); }

  [[nodiscard]] bool may(lws* wsi) const;
  int answer(lws* wsi, std::string_view path) const;
  int send_next(lws* wsi, Session& session) const;
};

// By the token; without one, by the name that the browser called this machine, so that a page from elsewhere cannot
// reach it under a name of its own (DNS rebinding) or through a WebSocket (no same-origin rule).
bool WebServer::Impl::may(lws* wsi) const {
  if (!settings.token.empty()) {
    std::array<char, 128> given{};
    const char* token = lws_get_urlarg_by_name(wsi, "token=", given.data(), static_cast<int>(given.size()));
    return token != nullptr && std::strlen(token) == settings.token.size() &&
           CRYPTO_memcmp(token, settings.token.data(), settings.token.size()) == 0;
  }
  const std::string host = header(wsi, WSI_TOKEN_HOST), origin = header(wsi, WSI_TOKEN_ORIGIN);
  return is_loopback(without_port(host)) && (origin.empty() || origin == "http://" + host);
}

int WebServer::Impl::answer(lws* wsi, std::string_view path) const {
  if (!may(wsi))
    return lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, "The token is missing or wrong.") == 0 ? 0 : -1;
  if (path != "/") return lws_return_http_status(wsi, HTTP_STATUS_NOT_FOUND, nullptr) == 0 ? 0 : -1;
  std::array<unsigned char, LWS_PRE + 2048> buffer{};
  unsigned char *start = buffer.data() + LWS_PRE, *p = start, *end = buffer.data() + buffer.size() - 1;
  if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, "text/html; charset=utf-8", page_bytes, &p, end) != 0) return -1;
  const std::pair<const char*, const char*> headers[] = {
      {"content-security-policy:",
       "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
       "connect-src 'self' ws: wss:; img-src blob: data:"},
      {"x-content-type-options:", "nosniff"},
      {"referrer-policy:", "no-referrer"},
      {"cache-control:", "no-store"}};
  for (const auto& [name, value] : headers)
    if (lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                    reinterpret_cast<const unsigned char*>(value), static_cast<int>(std::strlen(value)),
                                    &p, end) != 0)
      return -1;
  if (lws_finalize_write_http_header(wsi, start, &p, end) != 0) return -1;
  lws_callback_on_writable(wsi);
  return 0;
}

int WebServer::Impl::on_http(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  if (reason == LWS_CALLBACK_HTTP) return of(wsi).answer(wsi, {static_cast<const char*>(in), length});
  if (reason != LWS_CALLBACK_HTTP_WRITEABLE) return lws_callback_http_dummy(wsi, reason, user, in, length);
  const Impl& impl = of(wsi);
  std::vector<unsigned char> copy(*impl.page);  // it is written into
  const int written = lws_write(wsi, copy.data() + LWS_PRE, impl.page_bytes, LWS_WRITE_HTTP_FINAL);
  if (written < 0) return -1;
  return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
}

// One message a call; the rest when there is room again.
int WebServer::Impl::send_next(lws* wsi, Session& session) const {
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    const Message& message = messages[slot];
    if (message.version == session.sent[slot]) continue;
    session.sent[slot] = message.version;
    std::vector<unsigned char> copy(*message.bytes);
    const bool binary = slot == static_cast<std::size_t>(Slot::kPicture);
    if (lws_write(wsi, copy.data() + LWS_PRE, copy.size() - LWS_PRE, binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < 0)
      return -1;
    lws_callback_on_writable(wsi);
    return 0;
  }
  return 0;
}

int WebServer::Impl::on_socket(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length) {
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return of(wsi).may(wsi) ? 0 : 1;
    case LWS_CALLBACK_ESTABLISHED:
      of(wsi).pages.insert(wsi);
      static_cast<Session*>(user)->sent.fill(0);
      lws_callback_on_writable(wsi);
      return 0;
    case LWS_CALLBACK_CLOSED:
      of(wsi).pages.erase(wsi);
      return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return of(wsi).send_next(wsi, *static_cast<Session*>(user));
    default:
      return lws_callback_http_dummy(wsi, reason, user, in, length);
  }
}

void WebServer::Impl::on_timer(lws_sorted_usec_list_t* timer) {
  Impl& impl = *reinterpret_cast<Timer*>(timer)->impl;
  impl.running = (*impl.tick)();
  if (impl.running) lws_sul_schedule(impl.context, 0, timer, &Impl::on_timer, kTick_us);
}

WebServer::WebServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WebServer::~WebServer() {
  if (impl_->context != nullptr) lws_context_destroy(impl_->context);
}

Result<std::unique_ptr<WebServer>> WebServer::create(const WebSettings& settings, std::string page) {
  static const lws_protocols kProtocols[] = {{"http", &Impl::on_http, 0, 0, 0, nullptr, 0},
                                             {"rfmvo", &Impl::on_socket, sizeof(Session), 1024, 0, nullptr, 0},
                                             {nullptr, nullptr, 0, 0, 0, nullptr, 0}};
  lws_set_log_level(0, nullptr);
  const Error refused{ErrorCode::kUnsupported, "cannot be listened on (taken, or not an address of this machine)",
                      settings.address + ":" + std::to_string(settings.port)};
  // libwebsockets waits for an address that this machine does not have, as for a cable that is not plugged in yet.
  if (!net::listen_on(settings.address, settings.port)) return refused;
  auto impl = std::make_unique<Impl>();
  impl->settings = settings;
  impl->page = framed(page);
  impl->page_bytes = page.size();
  lws_context_creation_info info{};
  info.port = settings.port;
  info.iface = impl->settings.address == "0.0.0.0" ? nullptr : impl->settings.address.c_str();
  info.protocols = kProtocols;
  info.user = impl.get();
  info.gid = static_cast<gid_t>(-1);
  info.uid = static_cast<uid_t>(-1);
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_EXPLICIT_VHOSTS;
  impl->context = lws_create_context(&info);
  if (impl->context != nullptr) impl->vhost = lws_create_vhost(impl->context, &info);
  if (impl->vhost == nullptr) {
    if (impl->context != nullptr) lws_context_destroy(impl->context);
    return refused;
  }
  return std::unique_ptr<WebServer>(new WebServer(std::move(impl)));
}

std::uint16_t WebServer::port() const { return static_cast<std::uint16_t>(lws_get_vhost_listen_port(impl_->vhost)); }

std::size_t WebServer::pages() const { return impl_->pages.size(); }

void WebServer::publish(Slot slot, std::string message) {
  Message& kept = impl_->messages[static_cast<std::size_t>(slot)];
  kept.bytes = framed(message);
  ++kept.version;
  for (lws* wsi : impl_->pages) lws_callback_on_writable(wsi);
}

void WebServer::run(const std::function<bool()>& tick) {
  impl_->tick = &tick;
  impl_->running = true;
  lws_sul_schedule(impl_->context, 0, &impl_->timer.list, &Impl::on_timer, 1);
  while (impl_->running && lws_service(impl_->context, 0) >= 0) {
  }
}

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address == "[::1]" ||
         (address.starts_with("127.") && address.find_first_not_of("0123456789.") == std::string::npos);
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  RFMVO_ASSERT(::RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1);
  std::string hex;
  for (const unsigned char byte : bytes) {
    constexpr const char* kDigits = "0123456789abcdef";
    hex += {kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return hex;
}

}  // namespace rfmvo::view
