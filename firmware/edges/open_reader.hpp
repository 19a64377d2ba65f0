// The reader that the configuration names.
#pragma once

#include <memory>
#include <optional>

#include "config/calibration.hpp"
#include "config/config.hpp"
#include "edges/device_clock.hpp"
#include "edges/reader.hpp"

namespace rfmvo {

// Errors: a list of antennas that is none, TLS files, a backend that this program was built without. A reader that
// does not answer is none. `calibration`: for the antennas.
[[nodiscard]] Result<std::unique_ptr<Reader>> open_reader(const Config& config,
                                                          const std::optional<Calibration>& calibration,
                                                          DeviceClockFunction clock);

}  // namespace rfmvo
