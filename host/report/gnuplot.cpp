#include "report/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "commands/whole_file.hpp"
#include "report/html.hpp"

extern char** environ;  // NOLINT: POSIX

namespace rfmvo::report {
namespace {

namespace fs = std::filesystem;

// A private folder that goes away with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string name = fs::temp_directory_path(error) / "rfmvo_report_XXXXXX";
    if (!error && ::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// What gnuplot complained about, on one line.
std::string first_words(const fs::path& log) {
  constexpr std::size_t kMaxLength = 300;
  const auto said = read_whole_file(log);
  if (!said) return "no message";
  std::string words = said.value().substr(0, kMaxLength);
  std::replace(words.begin(), words.end(), '\n', ' ');
  return words;
}

// -d: the user's own settings would change the page.
Status run_gnuplot(const fs::path& script, const fs::path& log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::string program = "gnuplot", defaults = "-d", file = script.string();
  char* arguments[] = {program.data(), defaults.data(), file.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return Error{ErrorCode::kNotFound, "not installed (Debian package gnuplot-nox)", "gnuplot"};
  if (error != 0) return Error{ErrorCode::kUnsupported, std::strerror(error), "gnuplot"};

  int state = 0;
  while (::waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return Done{};
  return Error{ErrorCode::kUnsupported, "failed: " + first_words(log), "gnuplot"};
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

std::string inline_svg(const std::string& svg_file, const Plot& plot) {
  const std::size_t begin = svg_file.find("<svg");
  const std::size_t body = begin == std::string::npos ? begin : svg_file.find('>', begin);
  if (body == std::string::npos) return "";
  std::string svg = svg_file.substr(body + 1);

  // gnuplot's own title and description say nothing about the plot.
  for (const char* element : {"title", "desc"}) {
    const std::size_t open = svg.find(fmt::format("<{}>", element));
    const std::string closing = fmt::format("</{}>", element);
    const std::size_t close = svg.find(closing);
    if (open != std::string::npos && close != std::string::npos && open < close && close < 500) {
      svg.erase(open, close + closing.size() - open);
    }
  }
  // Tooltips with the numbers of the layers.
  const std::string layer_title = "<title>" + plot.name + "_plot_";
  for (std::size_t at = 0; (at = svg.find(layer_title, at)) != std::string::npos;) {
    const std::size_t close = svg.find("</title>", at);
    if (close == std::string::npos) break;
    svg.erase(at, close + 8 - at);  // 8: the length of "</title>"
  }
  // Every file has the same ids; in one page they must differ.
  replace_all(svg, " id='", " id='" + plot.name + "_");
  replace_all(svg, " id=\"", " id=\"" + plot.name + "_");
  replace_all(svg, "'#", "'#" + plot.name + "_");
  replace_all(svg, "url(#", "url(#" + plot.name + "_");
  for (const PlotColour& colour : {kInk, kGrid, kPath, kGood, kDoubt, kStale, kTruth}) {
    replace_all(svg, colour.svg, colour.css);
    replace_all(svg, colour.svg_text, colour.css);
  }
  return fmt::format(
      "<svg class=\"plot\" role=\"img\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\" "
      "xmlns:xlink=\"http://www.w3.org/1999/xlink\"><title>{}</title>{}",
      plot.width, plot.height, escape(plot.title), svg);
}

Result<std::string> draw(const Plot& plot) {
  const TemporaryFolder folder;
  if (folder.path().empty()) {
    return Error{ErrorCode::kUnwritable, "no temporary folder can be made", "TMPDIR"};
  }
  const fs::path script = folder.path() / "plot.gp", svg = folder.path() / "plot.svg";
  const std::string head = fmt::format(
      "set encoding utf8\nset terminal svg size {},{} noenhanced font 'sans-serif,13' name '{}'\nset output '{}'\n",
      plot.width, plot.height, plot.name, svg.string());
  if (Status s = write_whole_file(script, head + plot.script + "\nunset output\n"); !s) return s.error();
  if (Status s = run_gnuplot(script, folder.path() / "log"); !s) return s.error();
  const auto file = read_whole_file(svg);
  if (!file) return Error{ErrorCode::kUnsupported, "wrote no SVG", "gnuplot"};
  std::string page = inline_svg(file.value(), plot);
  if (page.empty()) return Error{ErrorCode::kUnsupported, "wrote no SVG", "gnuplot"};
  return page;
}

}  // namespace rfmvo::report
