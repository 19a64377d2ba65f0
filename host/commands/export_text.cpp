#include "commands/export_text.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>

#include "rf/epc_uri.hpp"

namespace rfmvo {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;

// Exact: a double does not hold nanoseconds since 1970.
std::string seconds_of(DeviceTime time) {
  std::int64_t s = time.ns / kNsPerS;
  std::int64_t ns = time.ns % kNsPerS;
  const bool negative = time.ns < 0;
  if (negative) {
    s = -s;
    ns = -ns;
  }
  return fmt::format("{}{}.{:09}", negative ? "-" : "", s, ns);
}

}  // namespace

std::string to_tum(const evaluate::LastEstimates& last) {
  std::string text;
  for (const auto& [segment, trajectory] : last.trajectories) {
    for (const MetricPose& pose : trajectory.poses) {
      const Eigen::Vector3d& t = pose.T_W_C.t;
      const Eigen::Quaterniond& q = pose.T_W_C.R;
      fmt::format_to(std::back_inserter(text), "{} {:.9f} {:.9f} {:.9f} {:.12f} {:.12f} {:.12f} {:.12f}\n",
                     seconds_of(pose.time), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
    }
  }
  return text;
}

std::string to_tags_csv(const evaluate::LastEstimates& last) {
  std::string text =
      "epc,status,x_m,y_m,z_m,cov_xx_m2,cov_xy_m2,cov_xz_m2,cov_yy_m2,cov_yz_m2,cov_zz_m2,hdop,reads,segment,uri\n";
  for (const auto& [epc, tag] : last.tags) {
    fmt::format_to(std::back_inserter(text), "{},{},", epc.hex(), evaluate::label_of(tag.status));
    if (evaluate::is_located(tag)) {
      const Eigen::Vector3d& p = tag.p_W_X_m;
      const Eigen::Matrix3d& c = tag.covariance_m2;
      fmt::format_to(std::back_inserter(text), "{:.6f},{:.6f},{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.6g}",
                     p.x(), p.y(), p.z(), c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2), tag.hdop);
    } else {
      text += ",,,,,,,,,";
    }
    fmt::format_to(std::back_inserter(text), ",{},{},{}\n", tag.reads, tag.segment, epc_tag_uri(epc).value_or(""));
  }
  return text;
}

}  // namespace rfmvo
