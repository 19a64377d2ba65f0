// A minute of 1,000 reports a second over loopback TCP: what is lost, what the client costs, how late events are.
// Counters: reports that left the reader and did not arrive; reads that the simulated reader never reported (it was
// not told to read in time, which only a machine without time for it does); the client's share of one core; from the
// reader's stamp to the event, median, 99 of 100 and worst. Label: the first fault.
#include "support/reader_bench.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <thread>

#include "edges/llrp/reader_link.hpp"

namespace rfmvo {
namespace {

constexpr double kRate_hz = 1000.0, kSpan_s = 60.0, kSetUp_s = 5.0;

double thread_cpu_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void reader_at_full_rate(benchmark::State& state) {
  const auto clock = device_clock();
  reader_sim::ServerSettings server_settings;
  server_settings.port = 0;
  const int count = static_cast<int>(kRate_hz * kSpan_s);
  auto server = reader_sim::ReaderServer::create(server_settings, testing::sample_model(count, 1.0 / kRate_hz), clock);
  if (!server) return state.SkipWithError(server.error().text().c_str());
  std::atomic<bool> stop{false};
  std::atomic<std::size_t> reported{0};
  std::thread serving([&] {
    while (!stop) {
      server.value()->poll(Duration{1'000'000});
      reported = server.value()->reader().reported().size();
    }
  });
  llrp::ReaderSettings settings;
  settings.host = "127.0.0.1";
  settings.port = server.value()->port();
  auto link = llrp::ReaderLink::create(settings, clock, 1);
  for (auto _ : state) {
    std::vector<double> late_s;
    std::string fault;
    const double cpu_before_s = thread_cpu_s();
    const DeviceTime start = clock();
    // Until the reader has nothing more to report and all is here.
    const auto under_way = [&] {
      const Duration since = clock() - start;
      return since < Duration::from_seconds(kSpan_s + kSetUp_s) || late_s.size() < reported;
    };
    while (late_s.size() < static_cast<std::size_t>(count) && under_way() &&
           clock() - start < Duration::from_seconds(2.0 * kSpan_s)) {
      const std::vector<Event> events = link.value()->poll(Duration{100'000'000});
      const DeviceTime now = clock();
      for (const Event& event : events) {
        if (const auto* read = std::get_if<TagRead>(&event))
          late_s.push_back((now - DeviceTime{read->reader_time.ns}).seconds());
        if (const auto* f = std::get_if<Fault>(&event); f != nullptr && fault.empty()) fault = f->text;
      }
    }
    const double cpu_s = thread_cpu_s() - cpu_before_s, span_s = (clock() - start).seconds();
    stop = true;
    serving.join();
    state.SetLabel(fault);
    state.counters["lost"] = static_cast<double>(reported.load()) - static_cast<double>(late_s.size());
    state.counters["never_reported"] = static_cast<double>(count) - static_cast<double>(reported.load());
    state.counters["core_share"] = cpu_s / span_s;
    if (late_s.empty()) continue;
    std::sort(late_s.begin(), late_s.end());
    state.counters["p50_ms"] = 1e3 * late_s[late_s.size() / 2];
    state.counters["p99_ms"] = 1e3 * late_s[late_s.size() * 99 / 100];
    state.counters["max_ms"] = 1e3 * late_s.back();
  }
}
BENCHMARK(reader_at_full_rate)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace rfmvo
