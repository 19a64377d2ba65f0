// What the reproduction measures, run by run. Errors in metres; nothing where a method gives no answer.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rfmvo::reproduce {

// The columns. The paper's estimator twice: to the letter, and with all repairs of docs/paper.md; each as section III
// leaves it and after the joint optimization of section IV.
enum class Method : std::uint8_t {
  kPaperSearch,
  kPaper,
  kRepairedSearch,
  kRepaired,
  kJoint,
  kTagoram,
  kMobiTagbot,
};
inline constexpr std::size_t kMethods = 7;
inline constexpr std::array<Method, kMethods> kAllMethods{Method::kPaperSearch, Method::kPaper, Method::kRepairedSearch,
                                                          Method::kRepaired,    Method::kJoint, Method::kTagoram,
                                                          Method::kMobiTagbot};
template <class T>
using ByMethod = std::array<T, kMethods>;
[[nodiscard]] constexpr std::size_t index_of(Method method) { return static_cast<std::size_t>(method); }
// "paper_search", ...: keys of the JSON.
[[nodiscard]] const char* key_of(Method method);

// Against the true scale over about a second of the path (window_scale_errors).
struct ScaleError {
  double absolute = 0.0;  // |gamma - gamma_true|, Eq. (31): metres per unit of the odometry
  double relative = 0.0;  // the same, divided by gamma_true
};

// One antenna array of one tag, Eq. (8)..(28).
struct ArrayResult {
  std::size_t tag = 0;
  double middle_s = 0.0, span_s = 0.0;            // of its reads, since the run's start
  double travel_m = 0.0;                          // of the camera meanwhile
  double distance_m = 0.0;                        // mean true distance of the tag from the antennas
  double hdop = 0.0;                              // of the optimized position; 0: undefined
  double true_gamma = 0.0;                        // metres per unit of V while it was read
  bool holds_truth = false;                       // true_gamma lies in the range of Eq. (4), (5)
  bool converged = false;                         // section IV
  std::optional<double> search_error_m, error_m;  // Eq. (30), in the camera's frame
  std::optional<ScaleError> search_scale_error, scale_error;
};

// Sections III to V on one run.
struct PaperRun {
  std::vector<ArrayResult> arrays;
  std::vector<std::optional<double>> search_error_m, error_m;  // by tag, of the array of least HDOP
  std::vector<ScaleError> search_scale, scale;                 // of the recovered path, Eq. (29)
  std::vector<Eigen::Vector3d> search_path_m, path_m;          // in W
  std::size_t tags = 0, tags_with_enough_reads = 0;
  std::size_t arrays_due = 0, arrays_without_range = 0;
  double cpu_s = 0.0;
};

// Distances of a tag from the true one, and whether it came to lie at the edge of the region.
struct BaselineTag {
  double error_m = 0.0;
  bool at_edge = false;
};

struct Run {
  std::uint64_t seed = 0;
  double span_s = 0.0;
  std::size_t reads = 0;
  PaperRun paper, repaired;
  std::vector<std::optional<double>> joint_error_m;  // by tag; located ones
  std::vector<ScaleError> joint_scale;
  std::vector<Eigen::Vector3d> joint_path_m, true_path_m;  // in W
  double joint_cpu_s = 0.0;
  std::vector<std::optional<BaselineTag>> tagoram, mobitagbot;  // by tag; nothing: fewer than two reads
  double tagoram_cpu_s = 0.0, mobitagbot_cpu_s = 0.0;
};

// By tag, for any method.
[[nodiscard]] std::vector<std::optional<double>> tag_errors_m(const Run& run, Method method);
// Empty for the baselines: they are given the path.
[[nodiscard]] const std::vector<ScaleError>& scale_errors(const Run& run, Method method);

// One setting of a sweep, over all arrays of all its runs (Fig. 11 to 13).
struct SweepPoint {
  double value = 0.0;
  std::size_t arrays_due = 0;
  // Without and with section IV; nothing: no array has an answer.
  struct Side {
    std::size_t arrays = 0;
    std::optional<double> tag_error_mean_m, tag_error_median_m;
    std::optional<double> scale_absolute_mean, scale_relative_mean, scale_relative_median;
  } search, optimized;
};
struct Sweep {
  std::string parameter, unit;  // "L", "reads"
  std::vector<SweepPoint> paper, repaired;
};

// The paper's estimator on the wall made easier, step by step.
struct Condition {
  std::string name;
  std::size_t tags = 0;
  struct Side {
    std::size_t located = 0, good = 0;                                // of the tags; within kGood_m
    std::optional<double> tag_error_median_m, scale_relative_median;  // optimized; of the tags, of the path
  } paper, repaired;
};
inline constexpr double kGood_m = 0.15;

// Seconds of one core.
struct RunTime {
  std::string what, paper;  // what is timed; the paper's figure as text, empty: none
  double measured_s = 0.0;
};

// One scene, all its runs.
struct Study {
  std::string scene;
  std::vector<Run> runs;  // in order of the seeds
};

struct Results {
  Study wall;
  std::optional<Study> real_frames;
  std::vector<Sweep> sweeps;  // Fig. 11, 12, 13; on the first runs of the wall
  std::size_t sweep_runs = 0;
  std::vector<Condition> conditions;  // on as many runs
  std::vector<RunTime> run_times;
};

}  // namespace rfmvo::reproduce
