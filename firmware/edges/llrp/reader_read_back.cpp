// Read-back: whether the reader holds what it was told.
#include <string>

#include "edges/llrp/reader_setup.hpp"

namespace rfmvo::llrp {
namespace {

const AISpec* ai_spec_of(const ROSpec& spec) {
  for (const SpecParameter& part : spec.spec_parameters)
    if (const auto* ai_spec = std::get_if<AISpec>(&part)) return ai_spec;
  return nullptr;
}

const AntennaConfiguration* antenna_of(const AISpec& spec) {
  if (spec.inventory_parameter_specs.empty()) return nullptr;
  const auto& antennas = spec.inventory_parameter_specs.front().antenna_configurations;
  return antennas.empty() ? nullptr : &antennas.front();
}

std::string not_as_told(const std::string& what, std::uint64_t told, std::uint64_t held) {
  return what + " is " + std::to_string(held) + ", told was " + std::to_string(told);
}

std::string difference(const AntennaConfiguration& told, const AntennaConfiguration& held) {
  if (held.rf_transmitter && held.rf_transmitter->transmit_power != told.rf_transmitter->transmit_power)
    return not_as_told("TransmitPower", told.rf_transmitter->transmit_power, held.rf_transmitter->transmit_power);
  if (held.c1g2_inventory_commands.empty()) return "";
  const auto &ours = told.c1g2_inventory_commands.front(), &its = held.c1g2_inventory_commands.front();
  if (its.c1g2_rf_control && its.c1g2_rf_control->mode_index != ours.c1g2_rf_control->mode_index)
    return not_as_told("ModeIndex", ours.c1g2_rf_control->mode_index, its.c1g2_rf_control->mode_index);
  if (its.c1g2_singulation_control && its.c1g2_singulation_control->session != ours.c1g2_singulation_control->session)
    return not_as_told("Session", ours.c1g2_singulation_control->session, its.c1g2_singulation_control->session);
  return "";
}

}  // namespace

std::string difference(const ROSpec& told, const GetRoSpecsResponse& held) {
  for (const ROSpec& spec : held.ro_specs) {
    if (spec.ro_spec_id != told.ro_spec_id) continue;
    if (!spec.ro_report_spec || spec.ro_report_spec->n != told.ro_report_spec->n)
      return not_as_told("ROReportSpec N", told.ro_report_spec->n, spec.ro_report_spec ? spec.ro_report_spec->n : 0);
    const AISpec *ours = ai_spec_of(told), *its = ai_spec_of(spec);
    if (its == nullptr) return "the AISpec is gone";
    if (ours->antenna_ids != its->antenna_ids) return "AntennaIDs are not those told";
    const AntennaConfiguration *our_antenna = antenna_of(*ours), *its_antenna = antenna_of(*its);
    return its_antenna == nullptr ? "the AntennaConfiguration is gone" : difference(*our_antenna, *its_antenna);
  }
  return "the ROSpec is gone";
}

std::string difference(const ReaderSettings& told, const GetReaderConfigResponse& held) {
  const auto period_ms = static_cast<std::uint64_t>(told.keepalive.ns / 1'000'000);
  if (!held.keepalive_spec) return "";  // readers answer with what they like
  if (held.keepalive_spec->keepalive_trigger_type == 0) return "there are no keepalives";
  if (held.keepalive_spec->periodic_trigger_value != period_ms)
    return not_as_told("PeriodicTriggerValue", period_ms, held.keepalive_spec->periodic_trigger_value);
  return "";
}

}  // namespace rfmvo::llrp
