// Estimates on the LCM bus: what other programs on the robot subscribe to.
#pragma once

#include <memory>
#include <string>

#include "edges/event_io.hpp"
#include "edges/lcm_codec.hpp"

namespace rfmvo {

class LcmBus : public EstimateSink {
 public:
  // url: as of LCM ("udpm://239.255.76.67:7667?ttl=0", "file:///path?mode=w", "memq://"). Errors:
  // kUnsupported naming the url; "no multicast route" if the machine cannot reach a udpm group.
  [[nodiscard]] static Result<std::unique_ptr<LcmBus>> create(const std::string& url, const std::string& prefix);
  ~LcmBus() override;

  // Errors: kUnwritable; the bus stays usable.
  [[nodiscard]] Status publish(const Estimate& estimate) override;
  [[nodiscard]] Status publish(const LcmMessage& message);

 private:
  struct Impl;
  explicit LcmBus(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rfmvo
