#include "reproduce/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "reproduce/summary.hpp"

namespace rfmvo::reproduce {
namespace {

constexpr double kCmPerM = 100.0, kPercent = 100.0;
constexpr double kShownMin_cm = 0.3;  // of distributions: smaller errors are luck
constexpr double kShownMin_percent = 0.01;

struct Variant {
  const PaperRun Run::*run;
  const char* name;
};
constexpr Variant kLetter{&Run::paper, "the paper's estimator to the letter"};
constexpr Variant kRepairs{&Run::repaired, "the repaired estimator"};

std::size_t solved(const std::vector<ArrayResult>& arrays) {
  return static_cast<std::size_t>(
      std::count_if(arrays.begin(), arrays.end(), [](const ArrayResult& a) { return a.error_m.has_value(); }));
}

std::size_t solved(const Study& study, const Variant& variant) {
  std::size_t count = 0;
  for (const Run& run : study.runs) count += solved((run.*variant.run).arrays);
  return count;
}

// The paper's own where it has answers.
Variant variant_of(const Study& study) { return solved(study, kLetter) >= study.runs.size() ? kLetter : kRepairs; }

// Arrays of the tag that has most of them in any run.
struct Pass {
  std::uint64_t seed = 0;
  std::size_t tag = 0;
  std::vector<ArrayResult> arrays;
};

Pass best_pass(const Study& study, const Variant& variant) {
  Pass best;
  for (const Run& run : study.runs) {
    std::map<std::size_t, std::vector<ArrayResult>> by_tag;
    for (const ArrayResult& array : (run.*variant.run).arrays)
      if (array.error_m) by_tag[array.tag].push_back(array);
    for (auto& [tag, arrays] : by_tag)
      if (arrays.size() > best.arrays.size()) best = {run.seed, tag, std::move(arrays)};
  }
  return best;
}

Curve curve(const char* key, const char* title, const report::PlotColour& colour) {
  Curve c;
  c.key = key;
  c.title = title;
  c.colour = &colour;
  return c;
}

FigureData fig7_distance(const Study& study) {
  const Variant variant = variant_of(study);
  const Pass pass = best_pass(study, variant);
  FigureData figure;
  figure.id = "figsevena";
  figure.heading = "Fig. 7 (a, b): HDOP and distance";
  figure.caption = fmt::format(
      "HDOP of each antenna array and mean distance of the tag from its antennas, tag {} of run {}, {}. The paper "
      "finds "
      "that both have the same trend.",
      pass.tag + 1, pass.seed, variant.name);
  figure.nothing = "No antenna array has an answer.";
  figure.x = "middle of the antenna array, time since start (s)";
  figure.y = "HDOP (m per m)";
  figure.y2 = "mean distance (m)";
  Curve hdop = curve("hdop", "HDOP", report::kGood), distance = curve("distance", "mean distance", report::kDoubt);
  hdop.marks = distance.marks = Curve::Marks::kLineAndPoints;
  distance.second_axis = true;
  for (const ArrayResult& a : pass.arrays) {
    hdop.points.emplace_back(a.middle_s, a.hdop);
    distance.points.emplace_back(a.middle_s, a.distance_m);
  }
  figure.curves = {std::move(hdop), std::move(distance)};
  return figure;
}

FigureData fig7_error(const Study& study) {
  const Variant variant = variant_of(study);
  FigureData figure;
  figure.id = "figsevenc";
  figure.heading = "Fig. 7 (c): HDOP and error";
  figure.caption = fmt::format(
      "Every antenna array of every tag and run, {}. The paper: the lowest HDOP is not the smallest error. Here it "
      "says "
      "little: HDOP knows neither height nor scale nor the errors of phase and path.",
      variant.name);
  figure.nothing = "No antenna array has an answer.";
  figure.x = "HDOP (m per m)";
  figure.y = "tag error, Eq. (30) (cm)";
  figure.log_x = figure.log_y = true;
  Curve points = curve("arrays", "one antenna array", report::kGood);
  points.marks = Curve::Marks::kPoints;
  for (const Run& run : study.runs)
    for (const ArrayResult& a : (run.*variant.run).arrays)
      if (a.error_m && a.hdop > 0.0) points.points.emplace_back(a.hdop, kCmPerM * *a.error_m);
  figure.curves = {std::move(points)};
  return figure;
}

FigureData tag_distribution(const Study& study, const char* id, std::string heading, std::string caption,
                            std::initializer_list<Method> methods) {
  FigureData figure;
  figure.id = id;
  figure.heading = std::move(heading);
  figure.caption = std::move(caption);
  figure.nothing = "No tag was located.";
  figure.x = "tag error (cm)";
  figure.y = "share of all tags";
  figure.log_x = figure.share = true;
  for (const Method method : methods) {
    Curve c = curve_of(method);
    std::vector<double> errors = all_tag_errors_m(study, method);
    for (double& e : errors) e = std::max(kCmPerM * e, kShownMin_cm);
    c.points = distribution(std::move(errors), all_tags(study));
    figure.curves.push_back(std::move(c));
  }
  return figure;
}

FigureData scale_distribution(const Study& study, const char* id, const char* heading, double ScaleError::*error) {
  const bool relative = error == &ScaleError::relative;
  FigureData figure;
  figure.id = id;
  figure.heading = heading;
  figure.caption =
      relative
          ? "The same, relative to the true scale: what can be compared between odometries."
          : "Eq. (31), over one second instead of one frame (a single frame's ratio is the odometry's noise), in the "
            "unit of the simulated odometry: 0.5 to 3 m, another one in each run. Published: 0.0501 without, "
            "0.0158 with joint optimization, in the unit of theirs.";
  figure.nothing = "No scale was found.";
  figure.x = relative ? "scale error (% of the true scale)" : "scale error (m per unit of the odometry)";
  figure.y = "share of the seconds with a scale";
  figure.log_x = figure.share = true;
  for (const Method method :
       {Method::kPaperSearch, Method::kPaper, Method::kRepairedSearch, Method::kRepaired, Method::kJoint}) {
    Curve c = curve_of(method);
    std::vector<double> values;
    for (const ScaleError& e : all_scale_errors(study, method))
      values.push_back(std::max(relative ? kPercent * e.relative : e.absolute,
                                relative ? kShownMin_percent : 0.01 * kShownMin_percent));
    const std::size_t all = values.size();
    c.points = distribution(std::move(values), all);
    figure.curves.push_back(std::move(c));
  }
  return figure;
}

// The first run in which the paper's estimator has a path, else the first.
const Run* path_run(const Study& study) {
  for (const PaperRun Run::*variant : {&Run::paper, &Run::repaired})
    for (const Run& run : study.runs)
      if (!(run.*variant).path_m.empty()) return &run;
  return study.runs.empty() ? nullptr : &study.runs.front();
}

FigureData fig10(const Study& study) {
  FigureData figure;
  figure.id = "figten";
  figure.heading = "Fig. 10: trajectory";
  figure.nothing = "No path was recovered.";
  figure.x = "forward (m)";
  figure.y = "left (m)";
  figure.equal_axes = true;
  const Run* run = path_run(study);
  if (run == nullptr) return figure;
  figure.caption = fmt::format(
      "Camera path of run {} from above, Eq. (29) for the paper's estimator; not aligned: all begin at the truth.",
      run->seed);
  const auto add = [&](Curve c, const std::vector<Eigen::Vector3d>& path) {
    for (const Eigen::Vector3d& p : path) c.points.emplace_back(p.x(), p.y());
    figure.curves.push_back(std::move(c));
  };
  add(curve("truth", "true path", report::kTruth), run->true_path_m);
  add(curve_of(Method::kPaperSearch), run->paper.search_path_m);
  add(curve_of(Method::kPaper), run->paper.path_m);
  add(curve_of(Method::kRepaired), run->repaired.path_m);
  add(curve_of(Method::kJoint), run->joint_path_m);
  return figure;
}

struct SweepText {
  const char *id, *figure, *x, *published_tag, *published_scale;
};
constexpr SweepText kSweepTexts[] = {
    {"figeleven", "Fig. 11: array size", "L (reads per antenna array)",
     "Published: errors fall from L = 20 to 60, then rise with the odometry's drift.",
     "Published: errors fall from L = 20 to 70, then rise."},
    {"figtwelve", "Fig. 12: angle step", "step of azimuth and elevation (degrees)",
     "Published: worse at 10 degrees without joint optimization, alike with it.", "Published: little effect."},
    {"figthirteen", "Fig. 13: scale step", "step of the scale (of the middle of its range)",
     "Published: smaller is better.", "Published: smaller is better."},
};

using SideValue = std::optional<double> SweepPoint::Side::*;

FigureData sweep_figure(const Sweep& sweep, const SweepText& text, bool scale, std::size_t runs) {
  FigureData figure;
  figure.id = std::string(text.id) + (scale ? "b" : "a");
  figure.heading = fmt::format("{} and {}", text.figure, scale ? "scale error" : "tag error");
  figure.caption = fmt::format("Median over all antenna arrays of {} runs that have an answer. {}", runs,
                               scale ? text.published_scale : text.published_tag);
  figure.nothing = "No antenna array has an answer.";
  figure.x = text.x;
  figure.y = scale ? "scale error (%)" : "tag error (cm)";
  figure.log_y = true;
  figure.height = 280;
  const SideValue value = scale ? &SweepPoint::Side::scale_relative_median : &SweepPoint::Side::tag_error_median_m;
  const auto add = [&](Method method, const std::vector<SweepPoint>& points, SweepPoint::Side SweepPoint::*side) {
    Curve c = curve_of(method);
    c.marks = Curve::Marks::kLineAndPoints;
    for (const SweepPoint& point : points)
      if (const auto& v = (point.*side).*value) c.points.emplace_back(point.value, 100.0 * *v);  // cm, %
    figure.curves.push_back(std::move(c));
  };
  add(Method::kPaperSearch, sweep.paper, &SweepPoint::search);
  add(Method::kPaper, sweep.paper, &SweepPoint::optimized);
  add(Method::kRepairedSearch, sweep.repaired, &SweepPoint::search);
  add(Method::kRepaired, sweep.repaired, &SweepPoint::optimized);
  return figure;
}

}  // namespace

std::vector<FigureData> figures_of(const Results& results) {
  const Study& wall = results.wall;
  std::vector<FigureData> figures{
      fig7_distance(wall),
      fig7_error(wall),
      tag_distribution(wall, "figeightab", "Fig. 8 (a, b): tag error without and with joint optimization",
                       "Published: mean 8.20 cm without, 6.23 cm with it. A curve ends at the share of tags that the "
                       "method locates at all.",
                       {Method::kPaperSearch, Method::kPaper, Method::kRepairedSearch, Method::kRepaired}),
      tag_distribution(
          wall, "figeightc", "Fig. 8 (c): tag error against the baselines",
          "Published: Tagoram 5.41 cm, MobiTagbot 3.64 cm, given the true path and 60 × 60 × 25 cells of 1 "
          "cm around the tag. A position drawn at random from that region is 24 cm off on average. The step at 12 cm "
          "is the "
          "region's height: antennas side by side hardly see it, and a taller region would cost more.",
          {Method::kPaper, Method::kRepaired, Method::kJoint, Method::kTagoram, Method::kMobiTagbot}),
      scale_distribution(wall, "fignine", "Fig. 9: scale error, the paper's unit", &ScaleError::absolute),
      scale_distribution(wall, "fignineb", "Fig. 9: scale error, relative", &ScaleError::relative),
      fig10(wall)};
  for (std::size_t s = 0; s < results.sweeps.size(); ++s)
    for (const bool scale : {false, true})
      figures.push_back(sweep_figure(results.sweeps[s], kSweepTexts[s], scale, results.sweep_runs));
  return figures;
}

std::vector<FigureData> real_frame_figures(const Study& study) {
  return {tag_distribution(study, "realeight", "Real frames: tag error, as Fig. 8",
                           "The product's own odometry on a hand-held camera's images; tags, antennas and reads are "
                           "simulated along the sequence's ground truth.",
                           {Method::kPaperSearch, Method::kPaper, Method::kRepaired, Method::kJoint, Method::kTagoram,
                            Method::kMobiTagbot}),
          scale_distribution(study, "realnine", "Real frames: scale error, as Fig. 9", &ScaleError::relative)};
}

}  // namespace rfmvo::reproduce
