// A reader client and a simulated reader over loopback TCP, both in this thread, on a clock that the test turns.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "edges/llrp/reader_link.hpp"
#include "reader_sim/reader_server.hpp"

namespace rfmvo::testing {

// `count` reads, `spacing_s` apart, of two tags on two ports and three channels, with every phase that an R420 says.
[[nodiscard]] inline std::vector<TagRead> sample_reads(int count, double spacing_s) {
  std::vector<TagRead> reads;
  for (int k = 0; k < count; ++k) {
    TagRead read;
    read.time = DeviceTime{Duration::from_seconds((k + 1) * spacing_s).ns};
    read.epc = Epc::from_hex(k % 3 == 0 ? "3074257BF7194E4000001A85" : "3074257BF7194E4000001A86").value();
    read.port = static_cast<std::uint8_t>(1 + k % 2);
    read.phase = {static_cast<std::uint16_t>(k * 32)};
    read.frequency_hz = static_cast<std::uint32_t>(920'625'000 + 500'000 * (k % 3));
    read.rssi_cdbm = static_cast<std::int16_t>(-5000 - 50 * (k % 20));
    read.doppler_hz_q4 = static_cast<std::int16_t>(k % 100 - 50);
    reads.push_back(read);
  }
  return reads;
}

[[nodiscard]] inline reader_sim::ReaderModel sample_model(int count = 100, double spacing_s = 0.01) {
  reader_sim::ReaderModel model;
  model.channels_khz = {921'625, 920'625, 921'125};
  model.reads = sample_reads(count, spacing_s);
  return model;
}

class ReaderBench {
 public:
  explicit ReaderBench(reader_sim::ReaderModel model, reader_sim::Delivery delivery = {},
                       llrp::ReaderSettings settings = {}, reader_sim::ServerSettings server_settings = {}) {
    server_settings.port = 0;
    server_settings.delivery = delivery;
    auto made = reader_sim::ReaderServer::create(server_settings, std::move(model), clock());
    EXPECT_TRUE(made.ok()) << made.error().text();
    server = std::move(made).value();
    settings.host = server_settings.host;
    settings.port = server->port();
    link = make_link(settings);
  }
  [[nodiscard]] std::unique_ptr<llrp::ReaderLink> make_link(const llrp::ReaderSettings& settings) {
    auto made = llrp::ReaderLink::create(settings, clock(), 1);
    EXPECT_TRUE(made.ok()) << made.error().text();
    return std::move(made).value();
  }
  [[nodiscard]] DeviceClockFunction clock() {
    return [this] { return now; };
  }

  // Lets both talk until they have nothing to say, then turns the clock; repeated for `s` seconds.
  void run(double s, double step_s = 0.01) {
    for (const DeviceTime until = now + Duration::from_seconds(s); now < until;) {
      now = now + Duration::from_seconds(step_s);
      settle();
    }
  }
  // True as soon as `done` is, within `s` seconds of the test's clock.
  bool run_until(const std::function<bool()>& done, double s, double step_s = 0.01) {
    for (const DeviceTime until = now + Duration::from_seconds(s); now < until && !done();) run(step_s, step_s);
    return done();
  }
  // Loopback delivers within microseconds of wall time, but not at once: some silent rounds must pass.
  void settle() {
    for (int quiet = 0; quiet < 3; ++quiet) {
      server->poll(Duration{0});
      for (Event& event : link->poll(Duration{0})) {
        if (std::holds_alternative<TagRead>(event)) quiet = 0;
        events.push_back(std::move(event));
      }
    }
  }
  template <class T>
  [[nodiscard]] std::vector<T> all() const {
    std::vector<T> found;
    for (const Event& event : events)
      if (const auto* x = std::get_if<T>(&event)) found.push_back(*x);
    return found;
  }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> texts;
    for (const Fault& fault : all<Fault>()) texts.push_back(fault.text.substr(fault.text.find(": ") + 2));
    return texts;
  }

  DeviceTime now{1'767'225'600'000'000'000};  // 2026-01-01
  std::unique_ptr<reader_sim::ReaderServer> server;
  std::unique_ptr<llrp::ReaderLink> link;
  std::vector<Event> events;
};

}  // namespace rfmvo::testing
