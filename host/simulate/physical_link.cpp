// The backscatter channel by image sources: direct path, one mirror image per flat reflector, one path per
// scatterer. The one-way field h is their complex sum; the same way back gives h^2. Polarisation, double
// bounces and shadowing are left out. In the aisle the phase then differs from the line of sight by 0.27..0.29 rad
// rms (six seeds) after the mean of each (tag, antenna); it decorrelates over a longer way than in the
// recordings of one antenna 0.5 m from its tags: 0.88 / 0.75 / 0.55 / 0.35 at 4 / 8 / 16 / 30 cm.
#include <cmath>
#include <complex>

#include "base/units.hpp"
#include "simulate/environment.hpp"
#include "simulate/radio_link.hpp"

namespace rfmvo::simulate {
namespace {

using Eigen::Vector3d;
using Complex = std::complex<double>;

// Budget at 1 m on boresight, as in statistical_link.cpp: 30 dBm into 8 dBi.
constexpr double kRssiAtOneMetre_dbm = -30.0;
constexpr double kTagPowerAtOneMetre_dbm = 5.0;
constexpr double kTagSensitivity_dbm = -18.0;
constexpr double kReaderSensitivity_dbm = -80.0;
// The carrier's leakage into the receiver is what limits phase: 0.06 rad at -50 dBm, as measured on an R420.
constexpr double kPhaseNoiseFloor_dbm = -71.8;
constexpr double kPhaseFloor_rad = 0.017;  // thermal floor measured at strong signals
constexpr double kTagBackPower = 0.1;      // an inlay on a carton still receives from behind

struct Ends {
  Vector3d antenna, boresight, tag, tag_normal;
};

// Amplitude of a ray that leaves the antenna towards `out` and reaches the tag from `in` (points).
double pattern(const Ends& ends, const Vector3d& out, const Vector3d& in) {
  const double off_boresight = (out - ends.antenna).normalized().dot(ends.boresight);
  const double at_tag = std::max(0.0, (in - ends.tag).normalized().dot(ends.tag_normal));
  return std::pow(10.0, patch_gain_db(off_boresight) / 20.0) *
         std::sqrt(kTagBackPower + (1.0 - kTagBackPower) * at_tag * at_tag);
}

// 1 well inside the rectangle, 0 well outside, smooth over a quarter wavelength: what diffraction does.
double inside(const Reflector& r, const Vector3d& p) {
  constexpr double kSoftEdge_m = 0.08;
  const Vector3d offset = p - r.centre;
  const double along = r.half_length_m - std::abs(offset.dot(r.axis));
  const double across = r.half_width_m - std::abs(offset.dot(r.normal.cross(r.axis)));
  return 1.0 / (1.0 + std::exp(-std::min(along, across) / kSoftEdge_m));
}

Complex ray(double amplitude, double length_m, double wave_number) {
  return std::polar(amplitude, -wave_number * length_m);
}

Complex reflection(const Ends& ends, const Reflector& r, double wave_number) {
  const double antenna_height = (ends.antenna - r.centre).dot(r.normal);
  const double tag_height = (ends.tag - r.centre).dot(r.normal);
  if (antenna_height * tag_height <= 0.0) return {};  // the plane lies between them: no mirror image
  const Vector3d image = ends.tag - 2.0 * tag_height * r.normal;
  const Vector3d bounce = ends.antenna + antenna_height / (antenna_height + tag_height) * (image - ends.antenna);
  const double length_m = (image - ends.antenna).norm();
  return ray(r.coefficient * inside(r, bounce) * pattern(ends, bounce, bounce) / length_m, length_m, wave_number);
}

Complex scattering(const Ends& ends, const Scatterer& s, double wave_number) {
  const double first_m = (s.p - ends.antenna).norm(), second_m = (s.p - ends.tag).norm();
  const double strength = std::sqrt(s.cross_section_m2 / (4.0 * kPi));
  // The far-field law grows without bound at the scatterer itself.
  const double amplitude = strength * pattern(ends, s.p, s.p) / (first_m * std::max(second_m, 2.0 * strength));
  return ray(amplitude, first_m + second_m, wave_number);
}

Complex channel(const Environment& environment, const Ends& ends, double wave_number) {
  const double direct_m = (ends.tag - ends.antenna).norm();
  Complex h = ray(pattern(ends, ends.tag, ends.antenna) / direct_m, direct_m, wave_number);
  for (const Reflector& r : environment.reflectors) h += reflection(ends, r, wave_number);
  for (const Scatterer& s : environment.scatterers) h += scattering(ends, s, wave_number);
  return h;
}

}  // namespace

RadioLink make_physical_link(const Scene& scene) {
  return [scene](double t_s, std::size_t antenna, std::size_t tag, double frequency_hz) {
    const Sight sight = sight_of(scene, t_s, antenna, tag);
    // Tags face the aisle.
    const Ends ends{sight.p_S_A_m, sight.boresight_S, scene.tags[tag].p_S_X_m, -Vector3d::UnitY()};
    const Complex h = channel(*scene.environment, ends, kTwoPi * frequency_hz / kSpeedOfLight_m_s);
    const double one_way_db = 20.0 * std::log10(std::abs(h));
    LinkState link;
    link.rssi_dbm = kRssiAtOneMetre_dbm + 2.0 * one_way_db;
    link.readable =
        kTagPowerAtOneMetre_dbm + one_way_db > kTagSensitivity_dbm && link.rssi_dbm > kReaderSensitivity_dbm;
    // Phase of a tone in noise: sigma^2 = 1 / (2 SNR).
    const double noise_to_signal = std::pow(10.0, (kPhaseNoiseFloor_dbm - link.rssi_dbm) / 10.0);
    link.white_sigma_rad = std::sqrt(kPhaseFloor_rad * kPhaseFloor_rad + 0.5 * noise_to_signal);
    link.phase_rad = -2.0 * std::arg(h);
    return link;
  };
}

}  // namespace rfmvo::simulate
