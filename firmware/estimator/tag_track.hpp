// One tag in the paper's estimator: its last reads per antenna, the antenna arrays they form, and
// the best array so far. An array k waits until the arrays that share its last element exist, because
// Eq. (9), (10), (15) average over them ("2 (L - 1) data for the initialization").
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "estimator/accuracy_estimation.hpp"
#include "estimator/antenna_array.hpp"
#include "estimator/joint_optimization.hpp"
#include "estimator/phase_calibration.hpp"
#include "estimator/spatial_power_spectrum.hpp"

namespace rfmvo {

// What section III alone says, before the joint optimization of section IV.
struct SearchedPosition {
  bool found = false;                               // false: all lines are parallel, or out of any reader's range
  Eigen::Vector3d p_X_m = Eigen::Vector3d::Zero();  // X_T of Eq. (17): as ArraySolution
  double gamma = 0.0;                               // gamma* of Eq. (8)
  Hdop hdop;                                        // x-y of W
};

// The paper's whole answer for one tag in one antenna array.
struct SolvedArray {
  DeviceTime first, last;                                     // of its reads
  Eigen::Quaterniond R_V_C = Eigen::Quaterniond::Identity();  // camera at `first`
  ScaleRange range;                                           // Eq. (4), (5)
  SearchedPosition searched;
  ArraySolution solution;  // p_X_m: axes of V, origin the camera at `first`
  Hdop hdop;               // x-y of W
  double bearing_sweep_rad = 0.0;
  std::uint32_t reads = 0;  // M x L
};

class TagTrack {
 public:
  TagTrack(const PaperConfig& config, const std::vector<AntennaCalibration>& antennas);

  // `antenna`: index into the antennas. Searches the spectrum when a new array is due. The read before
  // on the same antenna, if any, for the phase calibration.
  void on(std::size_t antenna, const SampledRead& read, const PhaseCalibration& phases);
  [[nodiscard]] const SampledRead* newest(std::size_t antenna) const;

  // Solves the next array that is complete (`all`: the next one at all); nothing if there is none. An
  // array without a solution gives a SolvedArray with solution.found = false.
  [[nodiscard]] std::optional<SolvedArray> solve_next(bool all, const PhaseCalibration& phases,
                                                      const Eigen::Quaterniond& R_W_V);

  // Forgets reads and arrays (the scale of another segment is another one), not the counters.
  void begin_segment();

  [[nodiscard]] DeviceTime last_read() const { return last_read_; }
  [[nodiscard]] std::uint32_t reads() const { return reads_; }
  [[nodiscard]] bool enough_reads() const { return enough_reads_; }  // L on one antenna, at any time
  // Arrays that were due, and those of them without a peak: empty range of scales, or no usable step.
  [[nodiscard]] std::uint32_t arrays_due() const { return arrays_due_; }
  [[nodiscard]] std::uint32_t arrays_without_range() const { return arrays_without_range_; }

 private:
  struct Member {  // one antenna of an array
    std::size_t antenna = 0;
    std::uint64_t first = 0;  // number of its first read on that antenna
    Eigen::Quaterniond R_V_D = Eigen::Quaterniond::Identity();
    IncidentAngles searched;  // of the spectrum
    IncidentAngles angles;    // the same; refined once the array is solved
  };
  struct Record {
    std::vector<Member> members;
    ScaleRange range;  // Eq. (4), (5)
    double gamma = 0.0;
    bool solved = false;
  };
  struct AntennaReads {
    std::deque<SampledRead> reads;
    std::uint64_t first = 0;  // number of reads.front()
  };

  [[nodiscard]] std::vector<Member> due_members() const;
  void search(const PhaseCalibration& phases);
  [[nodiscard]] bool complete(const Record& record) const;
  [[nodiscard]] AntennaArray array_of(const Member& member, const Eigen::Vector3d& p_V_origin,
                                      const PhaseCalibration& phases) const;
  [[nodiscard]] std::vector<AngleSums> others(const Record& record, const Member& member,
                                              IncidentAngles Member::*angles) const;
  [[nodiscard]] std::vector<AntennaTerm> terms_of(const Record& record, IncidentAngles Member::*angles,
                                                  const PhaseCalibration& phases) const;
  [[nodiscard]] const SampledRead& first_read(const Record& record) const;
  [[nodiscard]] SolvedArray solve(Record& record, const PhaseCalibration& phases, const Eigen::Quaterniond& R_W_V);
  [[nodiscard]] bool shared(const Record& record) const;
  void forget();

  PaperConfig config_;
  const std::vector<AntennaCalibration>* antennas_;
  ArrayOptions array_options_;
  std::vector<AntennaReads> by_antenna_;
  std::deque<Record> records_;  // in order; solved ones stay while an unsolved one shares elements
  std::uint64_t elements_;      // L
  std::int64_t reads_since_array_ = 0;
  DeviceTime last_read_;
  std::uint32_t reads_ = 0;
  bool enough_reads_ = false;
  std::uint32_t arrays_due_ = 0, arrays_without_range_ = 0;
};

}  // namespace rfmvo
