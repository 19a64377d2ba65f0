// rfmvod: the program on the box. Reads its command line; the work is service.cpp's.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "daemon/service.hpp"
#include "edges/box/self_test.hpp"
#include "edges/toml_files.hpp"

namespace rfmvo {
namespace {

int complain(const Error& error) {
  std::fprintf(stderr, "rfmvod: %s\n", error.text().c_str());
  return 1;
}

int print_config(const Options& options) {
  const auto config = load_config(options);
  if (!config) return complain(config.error());
  std::fputs(to_toml(config.value()).c_str(), stdout);
  return 0;
}

// Every part in a line; the exit code says whether all is well.
int test_box(const Options& options) {
  const auto config = load_config(options);
  if (!config) return complain(config.error());
  bool well = true;
  for (const Check& check : self_test(config.value())) {
    std::printf("%-8s %-6s %s\n", check.part.c_str(), check.ok ? "ok" : "WRONG", check.text.c_str());
    well = well && check.ok;
  }
  return well ? 0 : 1;
}

}  // namespace
}  // namespace rfmvo

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("rfmvod"));
  spdlog::set_pattern("rfmvod: %l: %v");
  CLI::App app("Locates RFID tags in 3D and the metric scale of its camera's path; publishes both over LCM", "rfmvod");
  app.set_version_flag("--version", "rfmvod " RFMVO_VERSION);
  rfmvo::Options options;
  bool self_test = false, print_config = false;
  app.add_option("--config", options.config, "Configuration (TOML)")->required();
  app.add_option("--journal", options.journal, "Folder for the journal, instead of journal.directory");
  app.add_option("--result", options.result, "Write what is published to this log, too");
  app.add_option("--set", options.settings, "One setting over the configuration: section.key=value")
      ->allow_extra_args(false);
  app.add_option("--settings", options.settings_file,
                 "What is set at run time is kept in this file, over the configuration");
  app.add_flag("--print-config", print_config, "Print every setting with its value, unit and meaning; then end");
  app.add_flag("--self-test", self_test, "Say in words what works: clock, bus, journal, camera, reader; then end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "rfmvod: %s\n", error.what());
    return 2;
  }
  if (print_config) return rfmvo::print_config(options);
  if (self_test) return rfmvo::test_box(options);
  const rfmvo::Status status = rfmvo::serve(options);
  return status ? 0 : rfmvo::complain(status.error());
}
