#include <cmath>

#include "base/units.hpp"
#include "simulate/radio_link.hpp"
#include "simulate/smooth_field.hpp"

namespace rfmvo::simulate {
namespace {

// Round trip on boresight, then -12 dB per doubling: of the 5 dBm below, -6 dB are reflected; back the same way
// -31.7 dB - 3 dB + 2 dB + 8 dB; cables and mismatch take 4 dB.
constexpr double kRssiAtOneMetre_dbm = -30.0;
// 30 dBm into 8 dBi circular, -31.7 dB of free space over 1 m at 920 MHz, -3 dB circular to linear,
// 2 dBi tag: 5 dBm at the tag.
constexpr double kTagPowerAtOneMetre_dbm = 5.0;
constexpr double kTagSensitivity_dbm = -18.0;     // Impinj Monza 4/5 in an H47 inlay
constexpr double kReaderSensitivity_dbm = -80.0;  // Impinj R420 data sheet: -82
constexpr double kBeamLimitCosine = 0.3420;       // 70 degrees: beyond, a real pattern is anybody's guess
constexpr double kFading_db = 2.0;                // one way, 1 sigma: multipath of a shelf
constexpr double kCaptureLength_m = 0.25;         // who wins slots changes slower than the phase

// Measured on real R420 data (DESIGN 2.8).
double white_sigma_rad(double rssi_dbm) {
  if (rssi_dbm > -45.0) return 0.022;
  if (rssi_dbm > -55.0) return 0.06;
  return 0.2;
}

struct PairFields {
  SmoothField structure, fading, capture;
};

}  // namespace

double patch_gain_db(double cosine) {
  constexpr double kExponent = 3.47;         // cos^n is 1/2 at 35 degrees
  constexpr double kFrontToBack_db = -20.0;  // typical data sheet value
  if (cosine <= 0.0) return kFrontToBack_db;
  return std::max(kFrontToBack_db, 10.0 * kExponent * std::log10(cosine));
}

Sight sight_of(const Scene& scene, double t_s, std::size_t antenna, std::size_t tag) {
  const AntennaCalibration& mounted = scene.calibration.antennas[antenna];
  const Rigid3 T_S_C = scene.T_S_C(t_s);
  Sight sight;
  sight.p_S_A_m = T_S_C * mounted.p_C_A_m;
  sight.boresight_S = T_S_C.R * mounted.boresight_C;
  const Eigen::Vector3d ray = scene.tags[tag].p_S_X_m - sight.p_S_A_m;
  sight.distance_m = ray.norm();
  sight.cosine = ray.dot(sight.boresight_S) / sight.distance_m;
  return sight;
}

RadioLink make_statistical_link(const Scene& scene, std::uint64_t seed) {
  const std::size_t antennas = scene.calibration.antennas.size();
  auto arcs = std::make_shared<std::vector<ArcLength>>();
  for (const AntennaCalibration& a : scene.calibration.antennas) arcs->emplace_back(scene, a.p_C_A_m);
  auto fields = std::make_shared<std::vector<PairFields>>();
  for (std::size_t tag = 0; tag < scene.tags.size(); ++tag) {
    for (std::size_t a = 0; a < antennas; ++a) {
      const std::uint64_t index = tag * 256 + a;
      const double length_m = (*arcs)[a].total();
      fields->push_back({{length_m, kStructuredLength_m, seed, "structured phase", index},
                         {length_m, kStructuredLength_m, seed, "fading", index},
                         {length_m, kCaptureLength_m, seed, "slot capture", index}});
    }
  }
  return [scene, arcs, fields, antennas](double t_s, std::size_t antenna, std::size_t tag, double frequency_hz) {
    const Sight sight = sight_of(scene, t_s, antenna, tag);
    const double arc_m = (*arcs)[antenna].at(t_s);
    const PairFields& pair = (*fields)[tag * antennas + antenna];
    const double one_way_db =
        patch_gain_db(sight.cosine) - 20.0 * std::log10(sight.distance_m) + kFading_db * pair.fading.at(arc_m);
    LinkState link;
    link.rssi_dbm = kRssiAtOneMetre_dbm + 2.0 * one_way_db;
    link.readable = sight.cosine > kBeamLimitCosine && kTagPowerAtOneMetre_dbm + one_way_db > kTagSensitivity_dbm &&
                    link.rssi_dbm > kReaderSensitivity_dbm;
    link.white_sigma_rad = white_sigma_rad(link.rssi_dbm);
    link.weight = std::exp(scene.capture_sigma * pair.capture.at(arc_m));
    link.phase_rad = 2.0 * kTwoPi * frequency_hz * sight.distance_m / kSpeedOfLight_m_s +
                     scene.structured_sigma_rad * pair.structure.at(arc_m);
    return link;
  };
}

}  // namespace rfmvo::simulate
