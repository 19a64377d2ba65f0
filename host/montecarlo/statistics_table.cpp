#include <fmt/format.h>

#include "montecarlo/statistics_text.hpp"

namespace rfmvo::montecarlo {
namespace {

// A dash for what is not known.
std::string number(const std::optional<double>& value, double unit, int digits) {
  return value ? fmt::format("{:.{}f}", *value / unit, digits) : "-";
}

constexpr double kCentimetre = 0.01, kPercent = 0.01;

std::optional<double> part(const std::optional<evaluate::Summary>& s, double evaluate::Summary::*field) {
  return s ? std::optional((*s).*field) : std::nullopt;
}

std::string seed_row(const SeedRun& run) {
  const evaluate::Evaluation& e = run.evaluation;
  const auto& error = e.tags.camera_relative_m;
  std::optional<double> known_rmse_m, bound_m, scale_bound;
  if (run.bound) {
    bound_m = run.bound->rmse_m;
    scale_bound = run.bound->scale_relative;
  }
  if (run.known_path) known_rmse_m = part(run.known_path->tags.camera_relative_m, &evaluate::Summary::rmse);
  return fmt::format("{:>6} {:>6} {:>4}/{:<4} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>7} {:>7} {:>7.2f}\n",
                     run.seed, run.reads, e.tags.located, e.tags.total,
                     number(part(error, &evaluate::Summary::mean), kCentimetre, 1),
                     number(part(error, &evaluate::Summary::rmse), kCentimetre, 1), number(bound_m, kCentimetre, 1),
                     number(part(error, &evaluate::Summary::max), kCentimetre, 1), number(known_rmse_m, kCentimetre, 1),
                     number(e.tags.coverage95, kPercent, 0), number(e.tags.nees_mean, 1.0, 1),
                     number(e.scale.relative_error, kPercent, 2), number(scale_bound, kPercent, 2), run.timing.wall_s);
}

std::string share(std::size_t count, std::size_t of) {
  return fmt::format("{} of {} ({:.1f} %)", count, of,
                     of > 0 ? 100.0 * static_cast<double>(count) / static_cast<double>(of) : 0.0);
}

std::string together(const Statistics& s) {
  using evaluate::Summary;
  std::string text = fmt::format("located         {}", share(s.located, s.tags));
  for (const auto& [status, count] : s.statuses) text += fmt::format(", {} {}", status, count);
  text += fmt::format("\nerror           rms {} cm, mean {}, median {}, max {}\n",
                      number(part(s.error_m, &Summary::rmse), kCentimetre, 2),
                      number(part(s.error_m, &Summary::mean), kCentimetre, 2),
                      number(part(s.error_m, &Summary::median), kCentimetre, 2),
                      number(part(s.error_m, &Summary::max), kCentimetre, 1));
  text += fmt::format("  bound         rms {} cm, median {}; error over bound {}; {} tags without a bound\n",
                      number(s.bound_rmse_m, kCentimetre, 2), number(s.bound_median_m, kCentimetre, 2),
                      number(s.ratio, 1.0, 2), s.unbounded);
  if (s.lobe_bound_rmse_m)
    text += fmt::format("  with lobes    rms {} cm; error over it {}; {} % of the tags at a wrong place\n",
                        number(s.lobe_bound_rmse_m, kCentimetre, 2), number(s.lobe_ratio, 1.0, 2),
                        number(s.lobe_wrong_share, kPercent, 1));
  if (s.known_path_rmse_m)
    text += fmt::format("  path known    rms {} cm, bound {}\n", number(s.known_path_rmse_m, kCentimetre, 2),
                        number(s.known_path_bound_rmse_m, kCentimetre, 2));
  text += fmt::format("inside 95 %     {} %; normalised squared error {} (median {}; 3.0 and 2.4 if honest)\n",
                      number(s.coverage95, kPercent, 1), number(s.nees_mean, 1.0, 2), number(s.nees_median, 1.0, 2));
  text += fmt::format("scale           rms {} % of {} seeds, bound {}\n", number(s.scale_rms_relative, kPercent, 3),
                      s.scales, number(s.scale_bound_rms_relative, kPercent, 3));
  text += fmt::format("unflagged wrong {}; above 25 cm {}\n", share(s.unflagged_wrong, s.tags),
                      s.unflagged_wrong_that_matters);
  if (s.false_alarms) text += fmt::format("false alarms    {}\n", share(*s.false_alarms, s.tags));
  text += fmt::format("sigma < 25 cm   {}\n", share(s.located_sigma25, s.tags));
  text += fmt::format("time            {:.2f} s a run, {:.1f} times real time; 99 % of the reads within {:.3f} ms\n",
                      s.run_s, s.realtime_factor, 1e3 * s.per_read_p99_s);
  return text;
}

}  // namespace

std::string to_table(const std::vector<SeedRun>& runs, const Statistics& statistics) {
  std::string text =
      "  seed  reads  located    mean     rms   bound     max   known  inside   nees   scale   bound    time\n"
      "                            cm      cm  rms cm      cm  rms cm       %             %       %       s\n";
  for (const SeedRun& run : runs) text += seed_row(run);
  return text + "\n" + together(statistics);
}

}  // namespace rfmvo::montecarlo
