// An RFID reader as the daemon sees it, whichever library speaks to it.
#pragma once

#include <vector>

#include "estimator/event.hpp"

namespace rfmvo {

class Reader {
 public:
  virtual ~Reader() = default;
  // Waits until something happens, or for `wait`; what has happened since the last call: tag reads, faults, reader
  // status. Troubles of the reader are faults, and it is tried again; so this has no error.
  [[nodiscard]] virtual std::vector<Event> poll(Duration wait) = 0;
  // Ends a poll() that waits; from any thread.
  virtual void wake() = 0;
  // Leaves the reader in order; takes up to a second. poll() then gives nothing.
  virtual void stop() = 0;
};

}  // namespace rfmvo
