#include "edges/ltkcpp/ltkcpp_reader.hpp"

// The toolkit's headers look for gcc's old name of the system, which the standard's modes do not define.
#if defined(__linux__) && !defined(linux)
#define linux 1
#endif
#include <ltkcpp.h>

#include <algorithm>
#include <atomic>
#include <ctime>

#include "edges/llrp/reader_session.hpp"

namespace rfmvo::ltkcpp {
namespace {

constexpr std::uint16_t kOnlyPort = 5084;
constexpr unsigned kFrameBytes = 1U << 17;       // of the toolkit's buffers
constexpr Duration kLongestReceive{50'000'000};  // so that wake() is heard
constexpr Duration kStopWithin{1'000'000'000};
constexpr std::int64_t kNsPerMs = 1'000'000;

class LtkcppReader : public Reader {
 public:
  LtkcppReader(const llrp::ReaderSettings& settings, DeviceClockFunction clock, std::uint64_t seed)
      : host_(settings.host), clock_(std::move(clock)), session_(settings, seed), types_(LLRP::getTheTypeRegistry()) {}
  LtkcppReader(const LtkcppReader&) = delete;
  LtkcppReader& operator=(const LtkcppReader&) = delete;
  ~LtkcppReader() override {
    connection_.reset();
    delete types_;
  }

  [[nodiscard]] std::vector<Event> poll(Duration wait) override {
    woken_ = false;
    const DeviceTime until = clock_() + wait;
    std::vector<Event> events;
    while (events.empty() && !woken_ && clock_() < until) {
      step(until);
      events = session_.take_events();
    }
    return events;
  }
  void wake() override { woken_ = true; }
  void stop() override {
    session_.stop(clock_());
    for (const DeviceTime until = clock_() + kStopWithin; !session_.stopped() && clock_() < until;) step(until);
    (void)session_.take_events();
    connection_.reset();
  }

 private:
  void step(DeviceTime until) {
    follow_wishes();
    const DeviceTime due = std::min(until, session_.deadline());
    receive(std::clamp(due - clock_(), Duration{kNsPerMs}, kLongestReceive));
    session_.on_time(clock_());
    send();
  }

  void follow_wishes() {
    if (session_.wish() == llrp::ReaderSession::Wish::kClose) {
      connection_.reset();
      session_.granted(clock_());
    }
    if (session_.wish() != llrp::ReaderSession::Wish::kConnect) return;
    session_.granted(clock_());
    connection_ = std::make_unique<LLRP::CConnection>(types_, kFrameBytes);
    if (connection_->openConnectionToReader(host_.c_str()) == 0) return session_.on_connected(clock_());
    session_.on_closed(clock_(), std::string("cannot be reached: ") + connection_->getConnectError());
    connection_.reset();
  }

  void receive(Duration wait) {
    if (!connection_) {
      const timespec pause{0, static_cast<long>(wait.ns)};
      (void)::nanosleep(&pause, nullptr);
      return;
    }
    const std::unique_ptr<LLRP::CMessage> message(connection_->recvMessage(static_cast<int>(wait.ns / kNsPerMs)));
    if (message == nullptr) {
      const LLRP::CErrorDetails* error = connection_->getRecvError();
      if (error->m_eResultCode == LLRP::RC_RecvTimeout) return;
      if (error->m_eResultCode == LLRP::RC_RecvEOF || error->m_eResultCode == LLRP::RC_RecvIOError)
        session_.on_closed(clock_(), std::string("the connection is lost: ") + error->m_pWhatStr);
      return;  // a message that the toolkit did not understand
    }
    std::vector<std::uint8_t> frame(kFrameBytes);
    LLRP::CFrameEncoder encoder(frame.data(), kFrameBytes);
    encoder.encodeElement(message.get());
    if (encoder.m_ErrorDetails.m_eResultCode != LLRP::RC_OK) return;
    session_.on_bytes(clock_(), std::span(frame).first(encoder.getLength()));
  }

  void send() {
    if (!connection_) return;
    llrp::FrameSplitter splitter;
    splitter.feed(session_.take_output());
    for (auto next = splitter.next(); next.ok() && next.value(); next = splitter.next()) {
      std::vector<std::uint8_t> frame(next.value()->begin(), next.value()->end());
      LLRP::CFrameDecoder decoder(types_, frame.data(), static_cast<unsigned>(frame.size()));
      const std::unique_ptr<LLRP::CMessage> message(decoder.decodeMessage());
      RFMVO_ASSERT(message != nullptr);
      if (connection_->sendMessage(message.get()) != LLRP::RC_OK)
        return session_.on_closed(clock_(), "the connection is lost: the toolkit cannot send");
    }
  }

  std::string host_;
  DeviceClockFunction clock_;
  llrp::ReaderSession session_;
  LLRP::CTypeRegistry* types_;
  std::unique_ptr<LLRP::CConnection> connection_;
  std::atomic<bool> woken_{false};
};

}  // namespace

Result<std::unique_ptr<Reader>> open_ltkcpp_reader(const llrp::ReaderSettings& settings, DeviceClockFunction clock,
                                                   std::uint64_t seed) {
  if (settings.port != kOnlyPort)
    return Error{ErrorCode::kUnsupported, "the LLRP Toolkit knows port 5084 only", "reader.port"};
  if (settings.tls) return Error{ErrorCode::kUnsupported, "the LLRP Toolkit has no TLS", "reader.tls"};
  return std::unique_ptr<Reader>(std::make_unique<LtkcppReader>(settings, std::move(clock), seed));
}

}  // namespace rfmvo::ltkcpp
