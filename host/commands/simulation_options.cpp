#include "commands/simulation_options.hpp"

namespace rfmvo {
namespace {

constexpr double kMaxDelay_s = 1.0;
constexpr double kMaxShare = 0.9;  // of bad reads
constexpr std::size_t kMaxTags = 10'000;

void add_stress_options(CLI::App& command, simulate::Options& options) {
  command.add_option("--reader-delay-s", options.reader_delay_s, "Read stamps are late by this much")
      ->check(CLI::Range(-kMaxDelay_s, kMaxDelay_s))
      ->capture_default_str();
  command.add_option("--outliers", options.outlier_share, "Share of the reads whose phase tells nothing")
      ->check(CLI::Range(0.0, kMaxShare))
      ->capture_default_str();
  command.add_option("--flips", options.flip_share, "Share of the reads that are turned by pi, in bursts")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command.add_option("--frame-gap-s", options.frame_gap_s, "No frames and poses for this long, in the middle")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  command.add_option("--structured-rad", options.structured_rad, "Strength of the structured phase error, 1 sigma")
      ->check(CLI::Range(0.0, 3.0));
  command.add_option("--tags", options.tags, "Number of tags (default: the scene's own)")
      ->check(CLI::Range(std::size_t{1}, kMaxTags));
  command.add_option("--read-rate-hz", options.read_rate_hz, "Reads per second of all tags (S3 .. tags300)")
      ->check(CLI::Range(1.0, 5000.0));
  command.add_option("--duration-s", options.duration_s, "Length of a drive (shelf05 .. corridor)")
      ->check(CLI::Range(8.0, 7200.0));
}

}  // namespace

void add_simulation_options(CLI::App& command, simulate::Options& options) {
  CLI::Option* scene = command.add_option("--scene", options.scene, "What is simulated")
                           ->check(CLI::IsMember(simulate::scene_names()))
                           ->capture_default_str();
  command
      .add_option("--images", options.images_dir,
                  "Real images with metric truth (images/, times.txt, groundtruth.txt, calib.txt); tags and antennas "
                  "are simulated")
      ->check(CLI::ExistingDirectory)
      ->excludes(scene);
  command.add_option("--vo-class", options.vo_class, "Drift of the camera poses in the journal")
      ->check(CLI::IsMember(simulate::vo_class_names()))
      ->capture_default_str();
  add_stress_options(command, options);
}

}  // namespace rfmvo
