// Who may change a box's configuration from afar: who has its key. HMAC-SHA-256 over the request and a challenge that
// the box made, which is good for half a minute and for one change; so a recorded request is worth nothing.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "base/time.hpp"

namespace rfmvo {

using Mac = std::array<std::uint8_t, 32>;
using Challenge = std::array<std::uint8_t, 24>;  // when it was made (8 bytes), and the box's own seal on that (16)
using Key = std::vector<std::uint8_t>;

inline constexpr std::size_t kMinKeyBytes = 16;
inline constexpr Duration kChallengeLives{30'000'000'000};

// The first line of the file. Errors: shorter than 16 bytes; readable or writable by everybody.
[[nodiscard]] Result<Key> read_key(const std::string& path);

[[nodiscard]] Mac hmac_sha256(std::span<const std::uint8_t> key, std::span<const std::uint8_t> bytes);
// Of a change. The lengths of the parts are sealed too: no two changes have the same bytes.
[[nodiscard]] Mac seal_change(std::span<const std::uint8_t> key, const Challenge& challenge, std::string_view name,
                              std::string_view value);

class ChallengeBook {
 public:
  // secret: random bytes of this run, nobody else's.
  explicit ChallengeBook(Key secret) : secret_(std::move(secret)) {}

  // Costs no memory: whoever asks for thousands keeps nobody from theirs.
  [[nodiscard]] Challenge make(DeviceTime now);
  // Made here, young enough, not used before. To be asked only once the change's seal is known to be good: it is used
  // up by that.
  [[nodiscard]] bool use(const Challenge& challenge, DeviceTime now);

 private:
  [[nodiscard]] Challenge made_at(std::int64_t ns) const;

  Key secret_;
  std::int64_t last_ns_ = 0;
  std::deque<std::int64_t> used_ns_;  // of the last half minute
};

// Takes as long for any two of the same length.
[[nodiscard]] bool same_bytes(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);
// Of the operating system. Errors: it has none to give.
[[nodiscard]] Result<Key> random_bytes(std::size_t count);

}  // namespace rfmvo
