#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "report/map_view.hpp"
#include "report/plots.hpp"
#include "report/script.hpp"

namespace rfmvo::report {
namespace {

constexpr double kChi2_95_2dof = 5.991464547107979;  // 95 % of chi-square, 2 degrees of freedom
constexpr int kEllipsePoints = 48, kManyEllipsePoints = 16;
constexpr std::size_t kManyTags = 300;  // from here on outlines only, and coarser: the page must stay quick
constexpr double kMargin_m = 0.4;       // around everything shown
constexpr std::size_t kMaxLabels = 80;  // more numbers than that hide the map
constexpr double kFilledMax_m = 1.0;    // larger ellipses are outlines only

constexpr double kReach_m = 6.0;  // other positions farther than this from everything else stay outside
constexpr int kWidth = 1000;
constexpr double kLeft_px = 85, kRight_px = 15, kTop_px = 12, kBottom_px = 68;

std::string point(const Eigen::Vector2d& p) { return fmt::format("{:.4f} {:.4f}\n", p.x(), p.y()); }

// Colour classes of the legend.
enum class Trust { kGood, kDoubt, kStale };
Trust trust_of(TagStatus status) {
  if (status == TagStatus::kConverged) return Trust::kGood;
  return status == TagStatus::kMoved || status == TagStatus::kStale ? Trust::kStale : Trust::kDoubt;
}

std::string ellipse(const Eigen::Vector2d& centre, const Eigen::Matrix2d& covariance, int points) {
  if (!covariance.allFinite()) return "";
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance);
  if (!(solver.eigenvalues()[0] > 0.0)) return "";
  const Eigen::Matrix2d axes = solver.eigenvectors() * (kChi2_95_2dof * solver.eigenvalues()).cwiseSqrt().asDiagonal();
  std::string text;
  for (int i = 0; i <= points; ++i) {
    const double angle = kTwoPi * i / points;
    text += point(centre + axes * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return text + "\n";
}

// The map in the making: layers, and the legend of those that show something.
struct Sketch {
  View view;
  Script script;
  std::vector<LegendEntry> legend;

  void add(Layer layer) { script.add(std::move(layer)); }
  void add(Layer layer, const PlotColour& colour, const char* symbol, const char* text) {
    if (script.add(std::move(layer))) legend.push_back({colour.css, symbol, text});
  }
};

Eigen::Matrix2d marginal(const Eigen::Matrix3d& c, const View& view) { return view.onto * c * view.onto.transpose(); }

std::string path_data(const std::vector<Eigen::Vector3d>& path, const View& view) {
  constexpr std::size_t kMaxPoints = 4000;  // more cannot be seen
  const std::size_t step = path.size() / kMaxPoints + 1;
  std::string text;
  for (std::size_t i = 0; i < path.size(); i += step) text += point(view(path[i]));
  return text;
}

std::vector<std::vector<Eigen::Vector3d>> estimated_paths(const ReportData& data) {
  std::vector<std::vector<Eigen::Vector3d>> paths;
  for (const auto& [segment, trajectory] : data.last.trajectories) {
    auto& path = paths.emplace_back();
    for (const MetricPose& pose : trajectory.poses) {
      if (pose.T_W_C.t.allFinite()) path.push_back(pose.T_W_C.t);
    }
  }
  return paths;
}

Box extent(const ReportData& data, const View& view) {
  Box box;
  for (const auto& path : estimated_paths(data)) {
    for (const auto& p : path) box.add(view(p));
  }
  for (const TagEstimate& tag : data.tags) {
    if (evaluate::is_located(tag)) box.add(view(tag.p_W_X_m));
  }
  for (const auto& p : data.truth.path) box.add(view(p));
  for (const auto& [epc, p] : data.truth.tags) box.add(view(p));
  if (box.empty()) return box;
  if (*view.right == '\0')
    for (int axis = 0; axis < 3; ++axis) box.add(view(Eigen::Vector3d::Unit(axis)));

  const Box near = box;
  for (const TagEstimate& tag : data.tags) {
    for (const TagHypothesis& hypothesis : tag.hypotheses) {
      const Eigen::Vector2d p = view(hypothesis.p_W_X_m);
      const Eigen::Vector2d beyond = (near.low - p).cwiseMax(p - near.high);
      if (evaluate::is_located(tag) && beyond.maxCoeff() < kReach_m) box.add(p);
    }
  }
  return box;
}

void add_paths(const ReportData& data, Sketch& sketch) {
  const View& view = sketch.view;
  sketch.add(
      {path_data(data.truth.path, view), fmt::format("with lines lw 2.5 lc rgb '{}' dt '-' notitle", kTruth.gnuplot)},
      kTruth, "╌", "true path");
  std::string text, start;
  for (const auto& path : estimated_paths(data)) {
    if (path.empty()) continue;
    text += path_data(path, view) + "\n";
    start += point(view(path.front()));
  }
  sketch.add({text, fmt::format("with lines lw 2 lc rgb '{}' notitle", kPath.gnuplot)}, kPath, "━", "camera path");
  sketch.add({start, fmt::format("with points pt 7 ps 0.8 lc rgb '{}' notitle", kPath.gnuplot)}, kPath, "●", "start");
}

void add_hypotheses(const ReportData& data, Sketch& sketch) {
  const View& view = sketch.view;
  std::string points, lines;
  for (const TagEstimate& tag : data.tags) {
    if (!evaluate::is_located(tag)) continue;
    for (std::size_t i = 1; i < tag.hypotheses.size(); ++i) {
      const Eigen::Vector2d p = view(tag.hypotheses[i].p_W_X_m);
      if (!p.allFinite()) continue;
      points += point(p);
      lines += point(view(tag.p_W_X_m)) + point(p) + "\n";
    }
  }
  sketch.add({lines, fmt::format("with lines lw 0.8 lc rgb '{}' dt '.' notitle", kDoubt.gnuplot)});
  sketch.add({points, fmt::format("with points pt 6 ps 0.8 lc rgb '{}' notitle", kDoubt.gnuplot)}, kDoubt, "○",
             "other position that fits");
}

void add_tags(const ReportData& data, Trust trust, const PlotColour& colour, const char* title, Sketch& sketch) {
  const View& view = sketch.view;
  std::string points, filled, outlines;
  const bool many = data.tags.size() > kManyTags;
  for (const TagEstimate& tag : data.tags) {
    if (!evaluate::is_located(tag) || trust_of(tag.status) != trust) continue;
    const Eigen::Matrix2d covariance = marginal(tag.covariance_m2, view);
    const std::string shape = ellipse(view(tag.p_W_X_m), covariance, many ? kManyEllipsePoints : kEllipsePoints);
    if (!many && kChi2_95_2dof * covariance.trace() < kFilledMax_m * kFilledMax_m) filled += shape;
    outlines += shape;
    points += point(view(tag.p_W_X_m));
  }
  sketch.add({filled, fmt::format("with filledcurves closed fs transparent solid 0.18 noborder lc rgb '{}' notitle",
                                  colour.gnuplot)});
  sketch.add({outlines, fmt::format("with lines lw 0.8 lc rgb '{}' notitle", colour.gnuplot)});
  sketch.add({points, fmt::format("with points pt 7 ps 0.55 lc rgb '{}' notitle", colour.gnuplot)}, colour, "●", title);
}

void add_true_tags(const ReportData& data, Sketch& sketch) {
  const View& view = sketch.view;
  std::string points, lines;
  for (const auto& [epc, p] : data.truth.tags) {
    points += point(view(p));
    const auto tag = data.last.tags.find(epc);
    if (tag == data.last.tags.end() || !evaluate::is_located(tag->second)) continue;
    lines += point(view(p)) + point(view(tag->second.p_W_X_m)) + "\n";
  }
  sketch.add({lines, fmt::format("with lines lw 1 lc rgb '{}' notitle", kTruth.gnuplot)});
  sketch.add({points, fmt::format("with points pt 2 ps 0.7 lw 1.5 lc rgb '{}' notitle", kTruth.gnuplot)}, kTruth, "×",
             "true tag");
}

void add_labels(const ReportData& data, Sketch& sketch) {
  const View& view = sketch.view;
  std::string text;
  const auto located = std::count_if(data.tags.begin(), data.tags.end(), evaluate::is_located);
  if (static_cast<std::size_t>(located) > kMaxLabels) return;
  for (std::size_t i = 0; i < data.tags.size(); ++i) {
    if (!evaluate::is_located(data.tags[i])) continue;
    const Eigen::Vector2d p = view(data.tags[i].p_W_X_m);
    text += fmt::format("{:.4f} {:.4f} {}\n", p.x(), p.y(), i + 1);
  }
  sketch.add({text, fmt::format("using 1:2:3 with labels left offset character 0.5,0.5 font ',10' tc rgb '{}' notitle",
                                kInk.gnuplot)});
}

// Numbers along axes that are not those of W would say nothing.
std::string labels(const View& view) {
  if (*view.right == '\0') return "unset border\nunset tics\nunset grid\n";
  return fmt::format("set xlabel '{}'\nset ylabel '{}'\n", view.right, view.up);
}

// The directions of W, and how high each tag is above the plane of the start.
void add_axes(const ReportData& data, Sketch& sketch) {
  const View& view = sketch.view;
  std::string stalks, cross, names;
  for (const TagEstimate& tag : data.tags) {
    if (!evaluate::is_located(tag)) continue;
    const Eigen::Vector3d foot(tag.p_W_X_m.x(), tag.p_W_X_m.y(), 0.0);
    stalks += point(view(tag.p_W_X_m)) + point(view(foot)) + "\n";
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d end = Eigen::Vector3d::Unit(axis);
    cross += point(view(Eigen::Vector3d::Zero())) + point(view(end)) + "\n";
    names += fmt::format("{:.4f} {:.4f} {}\n", view(end).x(), view(end).y(), "xyz"[axis]);
  }
  sketch.add({stalks, fmt::format("with lines lw 0.7 lc rgb '{}' notitle", kGrid.gnuplot)});
  sketch.add({cross, fmt::format("with lines lw 1.2 lc rgb '{}' notitle", kInk.gnuplot)}, kInk, "━",
             "1 m along x, y, z");
  sketch.add(
      {names, fmt::format("using 1:2:3 with labels offset character 0.8,0.4 tc rgb '{}' notitle", kInk.gnuplot)});
}

std::string ranges(const Plot& plot, const View& view, const Box& box) {
  const double w = plot.width, h = plot.height;
  return fmt::format(
      "set size ratio -1\nset key off\nset lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
      "set bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n{}"
      "set xrange [{:.4f}:{:.4f}]\nset yrange [{:.4f}:{:.4f}]\n",
      kLeft_px / w, 1.0 - kRight_px / w, kBottom_px / h, 1.0 - kTop_px / h, labels(view), box.low.x(), box.high.x(),
      box.low.y(), box.high.y());
}

// The plot's height follows from equal axes; what is too flat gets more room above and below.
int fit_height(Box& box) {
  constexpr double kMinHeight = 260, kMaxHeight = 900;
  const double px_per_m = (kWidth - kLeft_px - kRight_px) / (box.high - box.low).x();
  const double frame = kTop_px + kBottom_px;
  const double lacking_m = (kMinHeight - frame) / px_per_m - (box.high - box.low).y();
  if (lacking_m > 0.0) {
    box.low.y() -= 0.5 * lacking_m;
    box.high.y() += 0.5 * lacking_m;
  }
  return static_cast<int>(std::lround(std::min(frame + px_per_m * (box.high - box.low).y(), kMaxHeight)));
}

std::optional<Plot> map(const ReportData& data, const View& view) {
  Box box = extent(data, view);
  if (box.empty()) return std::nullopt;
  box.low.array() -= kMargin_m;
  box.high.array() += kMargin_m;
  const int height = fit_height(box);

  Sketch sketch{.view = view, .script = {}, .legend = {}};
  if (*view.right == '\0') add_axes(data, sketch);
  add_paths(data, sketch);
  add_hypotheses(data, sketch);
  add_tags(data, Trust::kGood, kGood, "tag, 95 % ellipse", sketch);
  add_tags(data, Trust::kDoubt, kDoubt, "ambiguous or weak", sketch);
  add_tags(data, Trust::kStale, kStale, "moved or stale", sketch);
  add_true_tags(data, sketch);
  add_labels(data, sketch);
  Plot plot{.name = view.name,
            .title = view.title,
            .width = kWidth,
            .height = height,
            .script = axes_style(),
            .legend = std::move(sketch.legend)};
  plot.script += ranges(plot, view, box) + sketch.script.text();
  return plot;
}

}  // namespace

std::optional<Plot> top_view(const ReportData& data) { return map(data, {.name = "top", .title = "Map from above"}); }

std::optional<Plot> side_view(const ReportData& data) {
  const Box above = extent(data, {});
  const bool along_y = !above.empty() && (above.high - above.low).y() > (above.high - above.low).x();
  return map(data, {.onto = axes(along_y ? 1 : 0, 2),
                    .name = "side",
                    .title = "Map from the side",
                    .right = along_y ? "y (m)" : "x (m)",
                    .up = "z (m)"});
}

std::optional<Plot> oblique_view(const ReportData& data) {
  return map(data, {.onto = oblique(), .name = "oblique", .title = "Map in three dimensions", .right = "", .up = ""});
}

}  // namespace rfmvo::report
