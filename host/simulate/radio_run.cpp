#include "simulate/radio_run.hpp"

#include "simulate/reader.hpp"

namespace rfmvo::simulate {

RadioRun make_radio_run(const Scene& scene, std::uint64_t seed) {
  RadioRun run;
  run.link = scene.physical_link ? make_physical_link(scene) : make_statistical_link(scene, seed);
  run.singulations =
      scene.physical_link ? gen2_inventory(scene, run.link, seed) : statistical_inventory(scene, run.link, seed);
  return run;
}

std::vector<TagRead> make_reads(const Scene& scene, const Options& options, DeviceTime epoch) {
  const RadioRun radio = make_radio_run(scene, options.seed);
  const ReaderHardware hardware = draw_hardware(scene.tags.size(), scene.calibration.antennas.size(), options.seed);
  return report(scene, radio.singulations, radio.link, hardware, options.seed, epoch,
                {.flip_share = options.flip_share, .outlier_share = options.outlier_share});
}

}  // namespace rfmvo::simulate
