// A reader through the LLRP Toolkit's C++ library instead of our own socket and codec: for whoever must run the
// toolkit that a site has approved. What is said to the reader, keepalives, the watchdog and the reads are the same
// ReaderSession; the toolkit carries and checks every frame, both ways.
//
// Its limits: port 5084, IPv4, no TLS; connecting has no time-out of its own and its receiver may overrun its own
// (3 s on a slow peer), so wake() and stop() can be late by that; one unknown standard parameter drops a message.
#pragma once

#include <memory>

#include "base/result.hpp"
#include "edges/device_clock.hpp"
#include "edges/llrp/reader_settings.hpp"
#include "edges/reader.hpp"

namespace rfmvo::ltkcpp {

// Errors: settings that the toolkit cannot follow (another port, TLS).
[[nodiscard]] Result<std::unique_ptr<Reader>> open_ltkcpp_reader(const llrp::ReaderSettings& settings,
                                                                 DeviceClockFunction clock, std::uint64_t seed);

}  // namespace rfmvo::ltkcpp
