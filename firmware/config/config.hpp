// Every setting of the product. Defaults stand here; name, unit, range and documentation of each
// key stand in one row of config_table.cpp. Keys read "section.name" and carry their unit.
#pragma once

#include <cstdint>
#include <string>

namespace rfmvo {

struct EstimatorConfig {
  std::string kind = "joint";          // joint | paper
  std::string pose_source = "frames";  // frames: own visual odometry; poses: camera poses of the event stream
  double publish_interval_s = 1.0;     // estimates are published this often, in event time
};

struct SyncConfig {
  double max_pose_gap_s = 0.2;     // no interpolation across a longer gap between two camera poses
};

// Sections III to V of the paper. The options named fix_* are the repairs of docs/paper.md; all
// false is the paper to the letter.
struct PaperConfig {
  std::int64_t elements = 60;          // L, reads per antenna array
  double angle_step_deg = 5.0;         // of alpha and beta in the spectrum search
  double scale_step = 0.1;             // of gamma, in units of the (normalised) scale
  double refine_step_deg = 1.0;        // alpha_opt, beta_opt of Eq. (16)
  double refine_range_deg = 20.0;      // mu of Eq. (16)
  double max_speed_m_s = 1.0;          // of the cart, Eq. (5)
  double min_read_rate_hz = 10.0;      // of one tag, Eq. (5)
  std::int64_t max_iterations = 10;    // of the joint optimization
  std::int64_t array_stride = 1;       // reads between two antenna arrays (1 in the paper)
  bool fix_rotation = false;           // antenna positions from the camera's rotation, not Eq. (12)'s constant offset
  bool fix_sphere_average = false;     // average directions on the sphere instead of angles, Eq. (9), (10)
  bool fix_cycles = false;             // round((predicted - measured) / 2 pi) instead of Eq. (21), (22)
  bool fix_scale_range = false;        // search limits that noise and missed reads cannot push past the truth
};

struct JointConfig {
  double structured_sigma_rad = 0.4;      // smooth phase error (multipath, antenna pattern) before it is estimated
  double structured_sigma_floor_rad = 0.15;
  double correlation_length_m = 0.058;    // Matern 3/2 length: 0.61 at 8 cm, as measured on real data
  double flip_probability = 0.003;        // of a pi flip of the reader
  double outlier_probability = 0.01;      // of a phase that tells nothing
  double tag_range_max_m = 5.0;           // tags farther than this from the path are not looked for
  double scale_min_m = 0.05, scale_max_m = 20.0;  // metres per unit of V
  double stale_after_s = 600.0;           // a tag not read for longer is STALE
  double scale_sigma_max = 0.15;          // of ln(scale); above: NO_SCALE
  double speed_min_m_s = 0.03, speed_max_m_s = 3.0;  // of the cart while it moves, mean
  double time_offset_sigma_s = 0.005;     // camera against reader, after the clocks are matched
  double knot_spacing_m = 0.25;           // between the path's correction knots
  double located_sigma_max_m = 0.25;      // above: WEAK_GEOMETRY
  double vo_scale_walk_per_sqrt_m = 0.0035;   // drift of the odometry's scale, 1 sigma
  double vo_rotation_walk_deg_per_sqrt_m = 0.25;
  double vo_position_walk_m_per_sqrt_m = 0.001;  // wander of the position that neither of the two explains
  double vo_position_sigma_m = 0.001;     // per pose, white
};

struct VisionConfig {
  std::int64_t max_tracks = 200;
  std::int64_t window_keyframes = 15;     // of the bundle adjustment
  double min_parallax_deg = 1.0;          // of a new map point
  double reprojection_gate_px = 2.0;
  double k1_sigma = 0.05;                 // of a lens whose calibration states no distortion; 0: k1 stays
  double readout_s = 0.0;                 // 0: global shutter
  double readout_sigma_s = 0.02;          // 0: the readout time stays
};

struct LcmConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string prefix = "RFMVO_";
};

struct CameraConfig {
  std::string source = "";            // v4l2:DEVICE | libcamera:ID | images:DIR | journal:FILE
  double start_time_s = 0.0;          // of images: device time of the first one, if they are played live
  std::int64_t width_px = 640, height_px = 480;  // of what a camera takes, before crop
  double frame_rate_hz = 30.0;        // 0: the camera's own
  double exposure_s = 0.0;            // 0: automatic
  double gain = 0.0;                  // 0: automatic
  std::string format = "auto";
  std::string flip = "none";
  std::int64_t crop_x_px = 0, crop_y_px = 0;
  std::int64_t crop_width_px = 0, crop_height_px = 0;  // 0: to the edge
  double time_offset_s = 0.0;         // added to every frame's time
  double stall_s = 1.0;               // without a picture for longer, a camera is started anew
};

struct ReaderConfig {
  std::string backend = "own";        // own | ltkcpp
  std::string address = "";           // empty: no reader
  std::int64_t port = 0;              // 0: 5084, with TLS 5085
  bool tls = false;
  std::string tls_ca = "";
  std::string antennas = "";          // ports, "1,2"; empty: those of the calibration
  std::string phase_sign = "grows";   // grows | falls, with distance
  std::int64_t mode = -1;
  std::int64_t session = 1;
  double power_dbm = 0.0;
  std::int64_t hop_table = 0;
  std::int64_t channel = 0;
  double keepalive_s = 1.0;
};

struct JournalConfig {
  std::string directory = "";         // empty: no journal
  std::int64_t quota_mb = 16'000;     // of all journals in the folder; 0: no limit
  std::int64_t segment_mb = 256;
  double flush_s = 0.05;              // so much is lost at most when power fails
  std::int64_t queue_mb = 64;         // what may wait for a slow card
  std::string frames = "raw";         // raw | jpeg
  std::int64_t jpeg_quality = 90;
};

struct DaemonConfig {
  std::string calibration = "";       // TOML file: camera, mounting, antennas
  std::string key_file = "";          // shared key of remote configuration; empty: it is off
};

struct Config {
  EstimatorConfig estimator;
  SyncConfig sync;
  PaperConfig paper;
  JointConfig joint;
  VisionConfig vision;
  LcmConfig lcm;
  CameraConfig camera;
  ReaderConfig reader;
  JournalConfig journal;
  DaemonConfig daemon;
};

}  // namespace rfmvo
