#include "reproduce/first_arrays.hpp"

#include <map>

namespace rfmvo::reproduce {

std::vector<SampledRead> synchronized_reads(const montecarlo::Recording& recording, const Config& config) {
  SamplingSynchronization synchronization(config);
  std::vector<SampledRead> all;
  for (const Event& event : recording.events) {
    const std::vector<SampledRead>* ready = nullptr;
    if (const auto* pose = std::get_if<CameraPose>(&event)) ready = &synchronization.on(*pose);
    if (const auto* read = std::get_if<TagRead>(&event)) ready = &synchronization.on(*read);
    if (ready != nullptr) all.insert(all.end(), ready->begin(), ready->end());
  }
  return all;
}

std::vector<AntennaArray> first_arrays(const std::vector<SampledRead>& reads, const Calibration& calibration,
                                       std::int64_t elements) {
  std::map<Epc, std::map<std::uint8_t, std::deque<SampledRead>>> by_tag;
  PhaseCalibration phases;
  for (const SampledRead& read : reads) {
    auto& of_antenna = by_tag[read.read.epc][read.read.port];
    if (!of_antenna.empty()) phases.on_pair(of_antenna.back().read, read.read);
    of_antenna.push_back(read);
  }
  const auto count = static_cast<std::size_t>(elements);
  for (const auto& [epc, by_port] : by_tag) {
    std::vector<AntennaArray> arrays;
    for (const AntennaCalibration& antenna : calibration.antennas) {
      const auto found = by_port.find(antenna.port);
      if (found == by_port.end() || found->second.size() < count) break;
      const Eigen::Vector3d p_V_origin = by_port.begin()->second.front().T_V_C.p_V_C;
      arrays.push_back(make_array(found->second, 0, count, p_V_origin, antenna, phases, {}));
    }
    if (arrays.size() == calibration.antennas.size()) return arrays;
  }
  return {};
}

std::vector<AntennaTerm> terms_of(const std::vector<AntennaArray>& arrays, const SpectrumPeak& peak) {
  std::vector<AntennaTerm> terms;
  for (std::size_t j = 0; j < arrays.size(); ++j)
    terms.push_back(
        {arrays[j], peak.angles[j], std::vector<AngleSums>(static_cast<std::size_t>(arrays[j].elements()))});
  return terms;
}

}  // namespace rfmvo::reproduce
