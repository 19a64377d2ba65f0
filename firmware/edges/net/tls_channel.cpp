#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <cerrno>
#include <cstring>

#include "base/assert.hpp"
#include "edges/net/channel.hpp"

namespace rfmvo::net {
namespace {

using SslPointer = std::unique_ptr<SSL, void (*)(SSL*)>;

std::string newest_error() {
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  if (code == 0) return errno != 0 ? std::strerror(errno) : "TLS failed";
  const char* reason = ERR_reason_error_string(code);
  return std::string("TLS: ") + (reason != nullptr ? reason : "unknown error");
}

class TlsChannel : public Channel {
 public:
  TlsChannel(Fd fd, SslPointer ssl) : fd_(std::move(fd)), ssl_(std::move(ssl)) {}
  // Both hand-shake on the way.
  Io read(std::span<std::uint8_t> into) override {
    ERR_clear_error();
    errno = 0;
    std::size_t count = 0;
    const int ok = SSL_read_ex(ssl_.get(), into.data(), into.size(), &count);
    return result(ok, count);
  }
  Io write(std::span<const std::uint8_t> from) override {
    if (from.empty()) return {};
    ERR_clear_error();
    errno = 0;
    std::size_t count = 0;
    const int ok = SSL_write_ex(ssl_.get(), from.data(), from.size(), &count);
    return result(ok, count);
  }
  [[nodiscard]] bool wants_write() const override { return SSL_want_write(ssl_.get()) != 0; }
  [[nodiscard]] int fd() const override { return fd_.get(); }

 private:
  Io result(int ok, std::size_t count) {
    if (ok == 1) return {count, false, ""};
    switch (SSL_get_error(ssl_.get(), ok)) {
      case SSL_ERROR_WANT_READ:
      case SSL_ERROR_WANT_WRITE:
        return {};
      case SSL_ERROR_ZERO_RETURN:
        return {0, true, ""};
      default:
        return {0, true, newest_error()};
    }
  }
  Fd fd_;
  SslPointer ssl_;
};

}  // namespace

struct TlsContext::Impl {
  std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context{nullptr, &SSL_CTX_free};
  bool server = false;
  std::string host;  // to verify; empty: nothing is verified
};

TlsContext::TlsContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TlsContext::TlsContext(TlsContext&&) noexcept = default;
TlsContext& TlsContext::operator=(TlsContext&&) noexcept = default;
TlsContext::~TlsContext() = default;

Result<TlsContext> TlsContext::client(const std::string& ca_file, const std::string& host) {
  auto impl = std::make_unique<Impl>();
  impl->context.reset(SSL_CTX_new(TLS_client_method()));
  if (!impl->context) return Error{ErrorCode::kUnsupported, newest_error(), "TLS"};
  (void)SSL_CTX_set_min_proto_version(impl->context.get(), TLS1_2_VERSION);
  if (!ca_file.empty()) {
    if (SSL_CTX_load_verify_locations(impl->context.get(), ca_file.c_str(), nullptr) != 1)
      return Error{ErrorCode::kUnreadable, newest_error(), ca_file};
    SSL_CTX_set_verify(impl->context.get(), SSL_VERIFY_PEER, nullptr);
    impl->host = host;
  }
  return TlsContext(std::move(impl));
}

Result<TlsContext> TlsContext::server(const std::string& certificate_file, const std::string& key_file) {
  auto impl = std::make_unique<Impl>();
  impl->server = true;
  impl->context.reset(SSL_CTX_new(TLS_server_method()));
  if (!impl->context) return Error{ErrorCode::kUnsupported, newest_error(), "TLS"};
  if (SSL_CTX_use_certificate_chain_file(impl->context.get(), certificate_file.c_str()) != 1)
    return Error{ErrorCode::kUnreadable, newest_error(), certificate_file};
  if (SSL_CTX_use_PrivateKey_file(impl->context.get(), key_file.c_str(), SSL_FILETYPE_PEM) != 1)
    return Error{ErrorCode::kUnreadable, newest_error(), key_file};
  return TlsContext(std::move(impl));
}

std::unique_ptr<Channel> TlsContext::channel(Fd fd) const {
  SslPointer ssl(SSL_new(impl_->context.get()), &SSL_free);
  RFMVO_ASSERT(ssl != nullptr);
  (void)SSL_set_fd(ssl.get(), fd.get());
  // A write that could not go through is repeated from wherever the buffer then is.
  SSL_set_mode(ssl.get(), SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  if (!impl_->host.empty()) {
    X509_VERIFY_PARAM* wanted = SSL_get0_param(ssl.get());
    if (X509_VERIFY_PARAM_set1_ip_asc(wanted, impl_->host.c_str()) != 1)
      (void)SSL_set1_host(ssl.get(), impl_->host.c_str());
    ERR_clear_error();
  }
  if (impl_->server)
    SSL_set_accept_state(ssl.get());
  else
    SSL_set_connect_state(ssl.get());
  return std::make_unique<TlsChannel>(std::move(fd), std::move(ssl));
}

}  // namespace rfmvo::net
