#include "reader_sim/reader_server.hpp"

#include <sys/epoll.h>

#include <algorithm>
#include <array>
#include <ctime>

namespace rfmvo::reader_sim {
namespace {

constexpr std::size_t kReadBytes = 16384;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

ReaderServer::ReaderServer(const ServerSettings& settings, ReaderModel model, DeviceClockFunction clock)
    : settings_(settings), clock_(std::move(clock)), reader_(std::move(model)), epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
  RFMVO_ASSERT(epoll_.valid());
}

ReaderServer::~ReaderServer() = default;

Result<std::unique_ptr<ReaderServer>> ReaderServer::create(const ServerSettings& settings, ReaderModel model,
                                                           DeviceClockFunction clock) {
  std::unique_ptr<ReaderServer> server(new ReaderServer(settings, std::move(model), std::move(clock)));
  if (!settings.tls_certificate.empty()) {
    auto tls = net::TlsContext::server(settings.tls_certificate, settings.tls_key);
    if (!tls) return tls.error();
    server->tls_.emplace(std::move(tls).value());
  }
  if (const Status s = server->plug_in(); !s) return s.error();
  return server;
}

Status ReaderServer::plug_in() {
  auto listener = net::listen_on(settings_.host, settings_.port);
  if (!listener) return listener.error();
  listener_ = std::move(listener).value();
  port_ = net::port_of(listener_);
  settings_.port = port_;  // the same one next time
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = listener_.get();
  (void)::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, listener_.get(), &event);
  return Done{};
}

void ReaderServer::pull_the_plug() {
  listener_.reset();
  reset_all();
}

void ReaderServer::reboot() {
  reset_all();
  reader_.reboot(clock_());
}

void ReaderServer::reset_all() {
  while (!peers_.empty()) reset(peers_.begin()->first);
}

void ReaderServer::reset(int fd) {
  const linger now{1, 0};  // RST instead of FIN
  (void)::setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  reader_.on_closed(fd);
  peers_.erase(fd);
}

void ReaderServer::poll(Duration wait) {
  const DeviceTime now = clock_();
  std::int64_t wait_ns = std::min(wait.ns, std::max<std::int64_t>(0, reader_.deadline().ns - now.ns));
  for (const auto& [fd, peer] : peers_)
    if (!peer.frames.empty() && settings_.delivery.chunk_gap.ns > 0)
      wait_ns = std::min(wait_ns, std::max<std::int64_t>(0, (peer.next_chunk - now).ns));
  std::array<epoll_event, 16> events{};
  // To the nanosecond: a report leaves when its tag was read.
  const timespec wait_time{wait_ns / kNsPerSecond, wait_ns % kNsPerSecond};
  const int count = ::epoll_pwait2(epoll_.get(), events.data(), static_cast<int>(events.size()), &wait_time, nullptr);
  for (int i = 0; i < count; ++i) {
    const int fd = events[static_cast<std::size_t>(i)].data.fd;
    if (fd == listener_.get())
      accept();
    else
      read(fd);
  }
  reader_.on_time(clock_());
  deliver();
}

void ReaderServer::accept() {
  while (true) {
    net::Fd fd = net::accept_from(listener_);
    if (!fd.valid()) return;
    const int key = fd.get();
    Peer& peer = peers_[key];
    peer.channel = tls_ ? tls_->channel(std::move(fd)) : net::plain_channel(std::move(fd));
    reader_.on_accept(key, clock_());
  }
}

void ReaderServer::read(int fd) {
  const auto found = peers_.find(fd);
  if (found == peers_.end()) return;
  std::array<std::uint8_t, kReadBytes> buffer{};
  while (true) {
    const net::Io io = found->second.channel->read(buffer);
    if (io.bytes > 0) reader_.on_bytes(fd, clock_(), std::span(buffer).first(io.bytes));
    if (io.closed) {
      reader_.on_closed(fd);
      peers_.erase(found);
      return;
    }
    if (io.bytes == 0) return;
  }
}

void ReaderServer::deliver() {
  for (auto& output : reader_.take_output()) {
    const auto found = peers_.find(output.connection);
    if (found == peers_.end() || found->second.closing) continue;
    found->second.frames.push_back(std::move(output.bytes));
    found->second.closing = output.close;
  }
  for (auto it = peers_.begin(); it != peers_.end();) {
    const auto current = it++;
    if (deliver(current->first, current->second)) watch(current->first, current->second);
  }
}

bool ReaderServer::deliver(int fd, Peer& peer) {
  const Delivery& delivery = settings_.delivery;
  while (!peer.frames.empty()) {
    const DeviceTime now = clock_();
    if (delivery.chunk_gap.ns > 0 && now < peer.next_chunk) return true;
    std::size_t limit = delivery.chunk_bytes == 0 ? SIZE_MAX : delivery.chunk_bytes;
    const bool to_reset = delivery.reset_after_bytes && !reset_done_;
    if (to_reset) limit = std::min(limit, *delivery.reset_after_bytes - peer.sent_in_all);
    if (!send_chunk(peer, limit)) return true;
    if (to_reset && peer.sent_in_all >= *delivery.reset_after_bytes) {
      reset_done_ = true;
      reset(fd);
      return false;
    }
    peer.next_chunk = now + delivery.chunk_gap;
  }
  if (!peer.closing) return true;
  reader_.on_closed(fd);
  peers_.erase(fd);
  return false;
}

// All that waits, in one write if it fits: TCP has no frames. False: nothing goes through now.
bool ReaderServer::send_chunk(Peer& peer, std::size_t limit) {
  std::vector<std::uint8_t> chunk;
  for (std::size_t i = 0; i < peer.frames.size() && chunk.size() < limit; ++i) {
    const auto& frame = peer.frames[i];
    const std::size_t from = i == 0 ? peer.sent_bytes : 0;
    const std::size_t take = std::min(frame.size() - from, limit - chunk.size());
    const auto first = frame.begin() + static_cast<std::ptrdiff_t>(from);
    chunk.insert(chunk.end(), first, first + static_cast<std::ptrdiff_t>(take));
  }
  const net::Io io = peer.channel->write(chunk);
  peer.sent_in_all += io.bytes;
  peer.sent_bytes += io.bytes;
  while (!peer.frames.empty() && peer.sent_bytes >= peer.frames.front().size()) {
    peer.sent_bytes -= peer.frames.front().size();
    peer.frames.pop_front();
  }
  return io.bytes > 0;
}

void ReaderServer::watch(int fd, Peer& peer) {
  epoll_event event{};
  event.events = EPOLLIN;
  const bool held_back = settings_.delivery.chunk_gap.ns > 0;
  if ((!peer.frames.empty() && !held_back) || peer.channel->wants_write()) event.events |= EPOLLOUT;
  event.data.fd = fd;
  if (event.events == peer.watched) return;
  (void)::epoll_ctl(epoll_.get(), peer.watched == 0 ? EPOLL_CTL_ADD : EPOLL_CTL_MOD, fd, &event);
  peer.watched = event.events;
}

}  // namespace rfmvo::reader_sim
