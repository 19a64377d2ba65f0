#include "edges/event_io.hpp"

namespace rfmvo {
namespace {

void to_recorded_resolution(TagRead& read) {
  read.time = DeviceTime::from_us(read.time.us());
  read.reader_time = ReaderTime::from_us(read.reader_time.us());
}

template <class AnyEvent>
void to_recorded_resolution(AnyEvent& event) {
  event.time = DeviceTime::from_us(event.time.us());
}

Status publish_all(std::span<const Estimate> estimates, EstimateSink& out) {
  for (const Estimate& estimate : estimates)
    if (const Status s = out.publish(estimate); !s) return s;
  return Done{};
}

}  // namespace

Status run(EventSource& source, EventSink* journal, Pipeline& pipeline, EstimateSink& out) {
  while (true) {
    auto next = source.next();
    if (!next) return next.error();
    std::optional<Event> event = std::move(next).value();
    if (!event) break;
    // The journal counts microseconds: live, the estimator must not see more than replay will.
    std::visit([](auto& e) { to_recorded_resolution(e); }, *event);
    if (journal != nullptr)
      if (const Status s = journal->write(*event); !s) return s;
    if (const Status s = publish_all(pipeline.on(*event), out); !s) return s;
  }
  return publish_all(pipeline.finish(), out);
}

}  // namespace rfmvo
