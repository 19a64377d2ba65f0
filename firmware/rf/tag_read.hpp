// One inventory report of one tag by one antenna port, as the reader's edge delivers it.
#pragma once

#include <cstdint>

#include "base/time.hpp"
#include "rf/epc.hpp"
#include "rf/phase.hpp"

namespace rfmvo {

struct TagRead {
  DeviceTime time;         // of the singulation, mapped to the device clock by the edge
  ReaderTime reader_time;  // the reader's own stamp, kept for the journal
  Epc epc;
  std::uint8_t port = 1;          // antenna port, 1-based as on the reader's case
  Phase phase;                    // grows with distance: +4 pi f d / c (edges flip readers that differ)
  std::uint32_t frequency_hz = 0;  // carrier, from the reader's own channel table
  std::int16_t rssi_cdbm = 0;      // peak RSSI, 1/100 dBm
  std::uint16_t seen_count = 1;    // phase belongs to this singulation only if 1 (LLRP 1.1 section 14.2.3)
  std::int16_t doppler_hz_q4 = 0;  // 1/16 Hz, as Impinj reports it; 0 = not reported
};

}  // namespace rfmvo
