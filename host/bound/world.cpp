#include "bound/world.hpp"

#include <cmath>

#include "base/units.hpp"
#include "simulate/radio_run.hpp"
#include "simulate/reader.hpp"
#include "simulate/smooth_field.hpp"

namespace rfmvo::bound {
namespace {

// An R420 says 2048 phases a turn; the variance of rounding.
constexpr double kRounding_rad2 = (kTwoPi / 2048.0) * (kTwoPi / 2048.0) / 12.0;
// What the aisle's reflections do to the phase, measured over six seeds (simulate/physical_link.cpp):
// 0.27..0.29 rad; correlation 0.88 / 0.75 / 0.55 / 0.35 at 4 / 8 / 16 / 30 cm, which is exp(-s / 28 cm).
constexpr StructuredError kAisle{0.28, 0.28, true};
constexpr double kGridStep_s = 0.001;  // of regular reads

using Arcs = std::vector<simulate::ArcLength>;

struct Source {
  const simulate::Scene& scene;
  const simulate::RadioLink& link;
  const simulate::ChannelPlan channels;
  const Arcs& arcs;
  const ReadChoice& choice;
};

void add_read(const Source& from, double t_s, std::size_t port, std::size_t tag, World& world) {
  Read read{t_s, tag, port, from.channels.frequency_hz(t_s), 0.0, from.arcs[port].at(t_s)};
  const double white_rad = from.choice.white_rad.value_or(from.link(t_s, port, tag, read.frequency_hz).white_sigma_rad);
  read.white_rad = std::sqrt(white_rad * white_rad + kRounding_rad2);
  world.reads.push_back(read);
}

void add_regular_reads(const Source& from, double spacing_m, World& world) {
  for (std::size_t port = 0; port < from.arcs.size(); ++port) {
    double next_m = 0.0;
    for (double t_s = from.scene.start_s(); t_s < from.scene.end_s(); t_s += kGridStep_s) {
      if (from.arcs[port].at(t_s) < next_m) continue;
      next_m += spacing_m;
      for (std::size_t tag = 0; tag < from.scene.tags.size(); ++tag) {
        if (from.link(t_s, port, tag, from.channels.frequency_hz(t_s)).readable) add_read(from, t_s, port, tag, world);
      }
    }
  }
}

World places_of(const simulate::Scene& scene) {
  World world;
  for (const simulate::SceneTag& tag : scene.tags) world.tags.push_back({tag.epc, tag.p_S_X_m});
  for (const AntennaCalibration& antenna : scene.calibration.antennas) {
    world.lever_arms_C_m.push_back(antenna.p_C_A_m);
    world.lever_arm_sigma_m = antenna.lever_arm_sigma_m;
  }
  world.T_S_C = scene.T_S_C;
  world.frame_times_s = scene.frame_times_s;
  world.structured =
      scene.physical_link ? kAisle : StructuredError{scene.structured_sigma_rad, simulate::kStructuredLength_m, false};
  return world;
}

}  // namespace

Result<World> world_of(const simulate::Options& options, const ReadChoice& choice) {
  if (options.frame_gap_s > 0.0)
    return Error{ErrorCode::kUnsupported, "the bound of an interrupted odometry is not modelled", "--frame-gap-s"};
  const auto drift = simulate::find_drift_class(options.vo_class);
  if (!drift) return Error{ErrorCode::kUnknownKey, "unknown odometry class '" + options.vo_class + "'", "--vo-class"};
  auto made = simulate::make_scene(options);
  if (!made) return made.error();
  const simulate::Scene scene = std::move(made).value();
  World world = places_of(scene);
  world.drift = *drift;
  const simulate::RadioRun radio = simulate::make_radio_run(scene, options.seed);
  Arcs arcs;
  for (const auto& lever_arm_m : world.lever_arms_C_m) arcs.emplace_back(scene, lever_arm_m);
  const Source from{scene, radio.link, simulate::ChannelPlan(options.seed), arcs, choice};
  if (choice.read_spacing_m) {
    add_regular_reads(from, *choice.read_spacing_m, world);
  } else {
    for (const simulate::Singulation& s : radio.singulations) add_read(from, s.t_s, s.antenna, s.tag, world);
  }
  return world;
}

}  // namespace rfmvo::bound
