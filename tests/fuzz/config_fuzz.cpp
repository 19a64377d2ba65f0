// Any text as a configuration and as a calibration: an error that says something, or a value that is written to a
// text which reads back to the same.
#include <cstdlib>
#include <string_view>

#include "edges/toml_files.hpp"

using namespace rfmvo;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto config = parse_config(text, "fuzz");
  require(config.ok() || !config.error().text().empty());
  if (config) {
    const std::string written = to_toml(config.value());
    const auto again = parse_config(written, "again");
    require(again.ok() && to_toml(again.value()) == written);
  }
  const auto calibration = parse_calibration(text, "fuzz");
  require(calibration.ok() || !calibration.error().text().empty());
  return 0;
}
