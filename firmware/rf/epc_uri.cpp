#include "rf/epc_uri.hpp"

#include <array>
#include <string_view>

namespace rfmvo {
namespace {

constexpr int kHeaderBits = 8, kFilterBits = 3, kPartitionBits = 3;
constexpr int kEpcBits = 96;
constexpr std::size_t kPartitions = 7;

// The company prefix by partition: the same in all schemes.
constexpr std::array<int, kPartitions> kCompanyBits{40, 37, 34, 30, 27, 24, 20};
constexpr int kMaxCompanyDigits = 12;  // less the partition

struct Scheme {
  std::uint8_t header;
  std::string_view name;
  int reference_bits;    // of company prefix and reference together
  int reference_digits;  // likewise; 0: a plain number without leading zeros
  int serial_bits;       // 0: none
};
// Tables 14-2 (SGTIN), 14-5 (SSCC), 14-7 (SGLN), 14-10 (GRAI), 14-13 (GIAI).
constexpr Scheme kSchemes[] = {{0x30, "sgtin-96", 44, 13, 38},
                               {0x31, "sscc-96", 58, 17, 0},
                               {0x32, "sgln-96", 41, 12, 41},
                               {0x33, "grai-96", 44, 12, 38},
                               {0x34, "giai-96", 82, 0, 0}};

// Reads numbers off the front, most significant bit first.
class Bits {
 public:
  explicit Bits(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  [[nodiscard]] int left() const { return kEpcBits - position_; }
  std::uint64_t take(int count) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i, ++position_)
      value = value << 1 | (bytes_[static_cast<std::size_t>(position_ / 8)] >> (7 - position_ % 8) & 1U);
    return value;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  int position_ = 0;
};

// With leading zeros; nothing if the number has more digits.
std::optional<std::string> digits_of(std::uint64_t value, int digits) {
  std::string text = digits == 0 && value == 0 ? "" : std::to_string(value);
  const auto wanted = static_cast<std::size_t>(digits);
  if (text.size() > wanted) return std::nullopt;
  return std::string(wanted - text.size(), '0') + text;
}

std::optional<std::string> uri_of(const Scheme& scheme, Bits bits) {
  (void)bits.take(kHeaderBits);
  const std::uint64_t filter = bits.take(kFilterBits), partition = bits.take(kPartitionBits);
  if (partition >= kPartitions) return std::nullopt;
  const int company_bits = kCompanyBits[partition], company_digits = kMaxCompanyDigits - static_cast<int>(partition);
  const auto company = digits_of(bits.take(company_bits), company_digits);
  const std::uint64_t number = bits.take(scheme.reference_bits - company_bits);
  const auto reference = scheme.reference_digits == 0 ? std::optional(std::to_string(number))
                                                      : digits_of(number, scheme.reference_digits - company_digits);
  if (!company || !reference) return std::nullopt;
  std::string uri =
      "urn:epc:tag:" + std::string(scheme.name) + ":" + std::to_string(filter) + "." + *company + "." + *reference;
  if (scheme.serial_bits > 0) uri += "." + std::to_string(bits.take(scheme.serial_bits));
  if (bits.take(bits.left()) != 0) return std::nullopt;  // SSCC-96 ends in 24 zeros
  return uri;
}

}  // namespace

std::optional<std::string> epc_tag_uri(const Epc& epc) {
  if (epc.bytes().size() != kEpcBits / 8) return std::nullopt;
  for (const Scheme& scheme : kSchemes)
    if (scheme.header == epc.bytes()[0]) return uri_of(scheme, Bits(epc.bytes()));
  return std::nullopt;
}

}  // namespace rfmvo
