// Time of what every event passes on its way: encode, decode, journal.
#include <benchmark/benchmark.h>

#include "edges/lcm_codec.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

const Event& sample(std::size_t index) {
  static const std::vector<Event> kEvents = testing::one_of_each_event();
  return kEvents[index];
}

void encode_tag_read(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(encode(sample(3), "RFMVO_"));
}
BENCHMARK(encode_tag_read);

void decode_tag_read(benchmark::State& state) {
  const LcmMessage message = encode(sample(3), "RFMVO_");
  for (auto _ : state) benchmark::DoNotOptimize(decode_event(message.channel, message.data, "RFMVO_"));
}
BENCHMARK(decode_tag_read);

void decode_grey_frame_640x480(benchmark::State& state) {
  Frame frame;
  frame.width_px = 640;
  frame.height_px = 480;
  frame.grey = std::make_shared<const std::vector<std::uint8_t>>(640 * 480, std::uint8_t{7});
  const LcmMessage message = encode(Event(frame), "RFMVO_");
  for (auto _ : state) benchmark::DoNotOptimize(decode_event(message.channel, message.data, "RFMVO_"));
}
BENCHMARK(decode_grey_frame_640x480);

void pipeline_tag_read(benchmark::State& state) {
  const std::vector<Event> events = testing::short_run(200);
  for (auto _ : state) {
    Pipeline pipeline;
    for (const Event& event : events) benchmark::DoNotOptimize(pipeline.on(event).data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * events.size()));
}
BENCHMARK(pipeline_tag_read)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rfmvo
