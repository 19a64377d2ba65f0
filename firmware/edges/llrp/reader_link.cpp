#include "edges/llrp/reader_link.hpp"

#include <sys/epoll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <array>

namespace rfmvo::llrp {
namespace {

constexpr std::size_t kReadBytes = 65536;
constexpr Duration kStopStep{20'000'000};
constexpr std::uint64_t kNsPerMs = 1'000'000;

}  // namespace

ReaderLink::ReaderLink(const ReaderSettings& settings, DeviceClockFunction clock, std::uint64_t seed)
    : settings_(settings),
      clock_(std::move(clock)),
      session_(settings, seed),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      input_(kReadBytes) {
  RFMVO_ASSERT(epoll_.valid() && wake_.valid());
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = wake_.get();
  (void)::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, wake_.get(), &event);
}

ReaderLink::~ReaderLink() = default;

Result<std::unique_ptr<ReaderLink>> ReaderLink::create(const ReaderSettings& settings, DeviceClockFunction clock,
                                                       std::uint64_t seed) {
  std::unique_ptr<ReaderLink> link(new ReaderLink(settings, std::move(clock), seed));
  if (settings.tls) {
    auto tls = net::TlsContext::client(settings.tls_ca, settings.host);
    if (!tls) return tls.error();
    link->tls_.emplace(std::move(tls).value());
  }
  return link;
}

std::vector<Event> ReaderLink::poll(Duration wait) {
  follow_wishes();
  const Duration due = std::max(Duration{0}, session_.deadline() - clock_());
  wait_for(std::min(wait, due));
  session_.on_time(clock_());
  follow_wishes();
  return session_.take_events();
}

void ReaderLink::wake() {
  const std::uint64_t one = 1;
  (void)!::write(wake_.get(), &one, sizeof one);
}

void ReaderLink::stop() {
  session_.stop(clock_());
  const DeviceTime until = clock_() + Duration::from_seconds(1.0);
  while (!session_.stopped() && clock_() < until) {
    follow_wishes();
    wait_for(kStopStep);
    session_.on_time(clock_());
  }
  (void)session_.take_events();
  close();
}

void ReaderLink::follow_wishes() {
  if (session_.wish() == ReaderSession::Wish::kClose) {
    close();
    session_.granted(clock_());
  }
  if (session_.wish() == ReaderSession::Wish::kConnect) {
    session_.granted(clock_());
    connect();
  }
  write();
  watch();
}

void ReaderLink::connect() {
  auto addresses = net::resolve(settings_.host, settings_.port);
  if (!addresses) return session_.on_closed(clock_(), "cannot be found: " + addresses.error().what);
  addresses_ = std::move(addresses).value();
  connect_next("no address");
}

// A name may have addresses of both kinds, and a reader listen on one only.
void ReaderLink::connect_next(const std::string& last_failure) {
  std::string failure = last_failure;
  while (!addresses_.empty()) {
    auto started = net::start_connect(addresses_.front());
    addresses_.erase(addresses_.begin());
    if (started) {
      connecting_ = std::move(started).value();
      return;
    }
    failure = started.error().what;
  }
  session_.on_closed(clock_(), "cannot be reached: " + failure);
}

void ReaderLink::close() {
  connecting_.reset();
  channel_.reset();
  addresses_.clear();
  output_.clear();
  watched_ = 0;  // the kernel forgets a closed socket
}

void ReaderLink::watch() {
  const int fd = channel_ ? channel_->fd() : connecting_.get();
  if (fd < 0) return;
  epoll_event event{};
  event.events = EPOLLIN | EPOLLRDHUP;
  if (!channel_ || !output_.empty() || channel_->wants_write()) event.events |= EPOLLOUT;
  event.data.fd = fd;
  if (event.events == watched_) return;
  (void)::epoll_ctl(epoll_.get(), watched_ == 0 ? EPOLL_CTL_ADD : EPOLL_CTL_MOD, fd, &event);
  watched_ = event.events;
}

void ReaderLink::wait_for(Duration wait) {
  std::array<epoll_event, 4> events{};
  // Rounded up: a deadline must have come when it is looked at.
  const auto wait_ms = static_cast<int>((static_cast<std::uint64_t>(wait.ns) + kNsPerMs - 1) / kNsPerMs);
  const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), wait_ms);
  for (int i = 0; i < count; ++i) {
    if (events[static_cast<std::size_t>(i)].data.fd == wake_.get()) {
      std::uint64_t ignored = 0;
      (void)!::read(wake_.get(), &ignored, sizeof ignored);
    } else if (!channel_) {
      const std::string failure = net::connect_failure(connecting_);
      net::Fd decided = std::move(connecting_);
      watched_ = 0;
      if (!failure.empty()) {
        decided.reset();
        connect_next(failure);
        continue;
      }
      (void)::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, decided.get(), nullptr);
      channel_ = tls_ ? tls_->channel(std::move(decided)) : net::plain_channel(std::move(decided));
      session_.on_connected(clock_());
      read();
    } else {
      read();
    }
  }
}

// One read takes all there is, unless the buffer is too small for it. What comes after it, epoll says again.
void ReaderLink::read() {
  while (channel_) {
    const net::Io io = channel_->read(input_);
    if (io.bytes > 0) session_.on_bytes(clock_(), std::span(input_).first(io.bytes));
    if (io.closed) {
      session_.on_closed(
          clock_(), io.error.empty() ? "the reader has closed the connection" : "the connection is lost: " + io.error);
      return close();
    }
    if (session_.wish() != ReaderSession::Wish::kKeep || io.bytes < input_.size()) break;
  }
  write();
}

void ReaderLink::write() {
  if (!channel_) return;
  const auto more = session_.take_output();
  output_.insert(output_.end(), more.begin(), more.end());
  while (!output_.empty()) {
    const net::Io io = channel_->write(output_);
    output_.erase(output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(io.bytes));
    if (io.closed) return;  // read() will say why
    if (io.bytes == 0) break;
  }
}

}  // namespace rfmvo::llrp
