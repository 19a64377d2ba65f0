#include "edges/box/config_seal.hpp"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>
#include <sys/stat.h>

#include <algorithm>

#include "edges/text_file.hpp"

namespace rfmvo {
namespace {

constexpr std::string_view kPurpose = "rfmvo configuration change 1";
constexpr std::size_t kTimeBytes = 8;

void append_number(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (int shift = 56; shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void append_text(std::vector<std::uint8_t>& out, std::string_view text) {
  append_number(out, text.size());
  out.insert(out.end(), text.begin(), text.end());
}

std::int64_t time_in(const Challenge& challenge) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < kTimeBytes; ++i) value = value << 8 | challenge[i];
  return static_cast<std::int64_t>(value);
}

}  // namespace

Result<Key> read_key(const std::string& path) {
  auto text = read_text_file(path);
  if (!text) return text.error();
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && (info.st_mode & (S_IROTH | S_IWOTH)) != 0)
    return Error{ErrorCode::kMalformed, "everybody may read or write it; chmod o-rw", path};
  const std::string line = text.value().substr(0, text.value().find_first_of("\r\n"));
  if (line.size() < kMinKeyBytes)
    return Error{ErrorCode::kMalformed, "the key is shorter than 16 bytes; openssl rand -hex 32 makes one", path};
  return Key(line.begin(), line.end());
}

Mac hmac_sha256(std::span<const std::uint8_t> key, std::span<const std::uint8_t> bytes) {
  Mac mac{};
  unsigned size = mac.size();
  const unsigned char* made =
      ::HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), bytes.data(), bytes.size(), mac.data(), &size);
  RFMVO_ASSERT(made != nullptr && size == mac.size());
  return mac;
}

Mac seal_change(std::span<const std::uint8_t> key, const Challenge& challenge, std::string_view name,
                std::string_view value) {
  std::vector<std::uint8_t> bytes;
  append_text(bytes, kPurpose);
  bytes.insert(bytes.end(), challenge.begin(), challenge.end());
  append_text(bytes, name);
  append_text(bytes, value);
  return hmac_sha256(key, bytes);
}

Challenge ChallengeBook::made_at(std::int64_t ns) const {
  std::vector<std::uint8_t> time;
  append_number(time, static_cast<std::uint64_t>(ns));
  const Mac seal = hmac_sha256(secret_, time);
  Challenge challenge{};
  std::copy(time.begin(), time.end(), challenge.begin());
  std::copy_n(seal.begin(), challenge.size() - kTimeBytes, challenge.begin() + kTimeBytes);
  return challenge;
}

Challenge ChallengeBook::make(DeviceTime now) {
  last_ns_ = std::max(now.ns, last_ns_ + 1);  // no two alike
  return made_at(last_ns_);
}

bool ChallengeBook::use(const Challenge& challenge, DeviceTime now) {
  const std::int64_t ns = time_in(challenge);
  if (!same_bytes(challenge, made_at(ns))) return false;  // not ours
  const Duration age = now - DeviceTime{ns};
  if (age > kChallengeLives) return false;
  std::erase_if(used_ns_, [&](std::int64_t used) { return now - DeviceTime{used} > kChallengeLives; });
  if (std::find(used_ns_.begin(), used_ns_.end(), ns) != used_ns_.end()) return false;
  used_ns_.push_back(ns);
  return true;
}

bool same_bytes(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  return a.size() == b.size() && ::CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

Result<Key> random_bytes(std::size_t count) {
  Key bytes(count);
  if (::RAND_bytes(bytes.data(), static_cast<int>(count)) != 1)
    return Error{ErrorCode::kUnsupported, "has no random numbers", "OpenSSL"};
  return bytes;
}

}  // namespace rfmvo
