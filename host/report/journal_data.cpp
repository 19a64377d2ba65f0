#include "report/journal_data.hpp"

#include "edges/journal.hpp"

namespace rfmvo::report {

Result<JournalData> read_journal_data(const std::string& path, const std::string& prefix,
                                      const evaluate::LastEstimates& last) {
  auto reader = JournalReader::open(path, prefix, {false});
  if (!reader) return reader.error();
  JournalData data;
  std::vector<TagRead> reads;
  std::optional<Calibration> calibration;
  while (true) {
    auto event = reader.value()->next();
    if (!event) return event.error();
    if (!event.value()) break;
    if (const auto* start = std::get_if<Start>(&*event.value())) calibration = start->calibration;
    if (const auto* fault = std::get_if<Fault>(&*event.value())) data.faults.push_back(*fault);
    if (const auto* read = std::get_if<TagRead>(&*event.value())) {
      reads.push_back(*read);
      data.reads.push_back({read->time, read->epc, read->port, std::nullopt});
    }
  }
  if (calibration) add_residuals(reads, *calibration, last, data.reads);
  return data;
}

}  // namespace rfmvo::report
