// Prints what the box says. subscriber [URL]
#include <cstdio>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <string>

#include "rfmvo/camera_pose_t.hpp"
#include "rfmvo/health_t.hpp"
#include "rfmvo/map_revision_t.hpp"
#include "rfmvo/metric_pose_t.hpp"
#include "rfmvo/pose_t.hpp"
#include "rfmvo/scale_t.hpp"
#include "rfmvo/tag_estimate_t.hpp"
#include "rfmvo/trajectory_t.hpp"

namespace {

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char two[3];
    std::snprintf(two, sizeof two, "%02X", byte);
    text += two;
  }
  return text;
}

class Printer {
 public:
  void on_tag(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::tag_estimate_t* m) {
    const std::string epc = hex({m->epc.begin(), m->epc.end()});
    if (m->status == rfmvo::tag_estimate_t::CONVERGED)
      std::printf("TAG %s at %.3f %.3f %.3f m\n", epc.c_str(), m->pos[0], m->pos[1], m->pos[2]);
    else
      std::printf("TAG %s not certain (status %d, %d hypotheses)\n", epc.c_str(), m->status, m->num_hypotheses);
  }
  void on_scale(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::scale_t* m) {
    if (m->observable)
      std::printf("SCALE %.4f m per unit, %.1f %%\n", m->m_per_unit, 100.0 * m->log_sigma);
    else
      std::printf("SCALE not observable yet\n");
  }
  void on_metric_pose(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::metric_pose_t* m) {
    std::printf("METRIC_POSE %.3f %.3f %.3f m\n", m->pos[0], m->pos[1], m->pos[2]);
  }
  void on_pose(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::pose_t* m) {
    std::printf("POSE %.3f %.3f %.3f m\n", m->pos[0], m->pos[1], m->pos[2]);
  }
  void on_trajectory(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::trajectory_t* m) {
    std::printf("TRAJECTORY of %d poses\n", m->num_poses);
  }
  void on_revision(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::map_revision_t* m) {
    std::printf("MAP_REVISION %lld: %s\n", static_cast<long long>(m->revision), m->reason.c_str());
  }
  void on_vo_pose(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::camera_pose_t* m) {
    std::printf("VO_POSE %.3f %.3f %.3f units\n", m->pos[0], m->pos[1], m->pos[2]);
  }
  void on_health(const lcm::ReceiveBuffer*, const std::string&, const rfmvo::health_t* m) {
    std::printf("HEALTH %lld frames, %lld reads, %d of %d tags located, %lld faults\n",
                static_cast<long long>(m->frames), static_cast<long long>(m->reads), m->tags_located, m->tags,
                static_cast<long long>(m->faults));
  }
};

}  // namespace

int main(int argc, char** argv) {
  lcm::LCM bus(argc > 1 ? argv[1] : "udpm://239.255.76.67:7667?ttl=0");
  if (!bus.good()) return 1;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  Printer printer;
  const std::string prefix = "RFMVO_";  // lcm.prefix of the box
  bus.subscribe(prefix + "TAG", &Printer::on_tag, &printer);
  bus.subscribe(prefix + "SCALE", &Printer::on_scale, &printer);
  bus.subscribe(prefix + "METRIC_POSE", &Printer::on_metric_pose, &printer);
  bus.subscribe(prefix + "POSE", &Printer::on_pose, &printer);
  bus.subscribe(prefix + "TRAJECTORY", &Printer::on_trajectory, &printer);
  bus.subscribe(prefix + "MAP_REVISION", &Printer::on_revision, &printer);
  bus.subscribe(prefix + "VO_POSE", &Printer::on_vo_pose, &printer);
  bus.subscribe(prefix + "HEALTH", &Printer::on_health, &printer);
  std::printf("listening\n");
  while (bus.handle() == 0) {
  }
  return 1;
}
