#include "simulate/radio_run.hpp"

namespace rfmvo::simulate {

RadioRun make_radio_run(const Scene& scene, std::uint64_t seed) {
  RadioRun run;
  run.link = scene.physical_link ? make_physical_link(scene) : make_statistical_link(scene, seed);
  run.singulations =
      scene.physical_link ? gen2_inventory(scene, run.link, seed) : statistical_inventory(scene, run.link, seed);
  return run;
}

}  // namespace rfmvo::simulate
