// What is asked of an RFID reader: the configuration's reader section as the client uses it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/time.hpp"
#include "edges/llrp/tag_reports.hpp"

namespace rfmvo::llrp {

struct ReaderSettings {
  std::string host;
  std::uint16_t port = 5084;
  bool tls = false;
  std::string tls_ca;                   // file of certificates to trust; empty: any certificate is taken
  std::vector<std::uint16_t> antennas;  // ports; empty: all that the reader has
  PhaseSign phase_sign = PhaseSign::kGrows;
  int mode = -1;             // identifier in the reader's own table; -1: 2 (dense reader, M4), else its first fixed one
  std::uint8_t session = 1;  // of Gen2; with dual target, 0 and 1 give repeated reads
  double power_dbm = 0.0;    // the table's largest that is not above; 0: the largest
  std::uint8_t hop_table_id = 0;      // 0: the reader's first
  std::uint16_t channel_index = 0;    // of a reader that does not hop; 0: the first
  Duration keepalive{1'000'000'000};  // the reader shows a sign of life this often
};

}  // namespace rfmvo::llrp
