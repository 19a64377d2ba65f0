// Where a journal's records end up: segments in a folder with a quota, or a test's.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "edges/recorder/segment_file.hpp"

namespace rfmvo {

class JournalStore {
 public:
  virtual ~JournalStore() = default;
  // The record that every segment begins with, so that each can be read when the older ones have gone: appended here,
  // and again in front of each segment to come.
  [[nodiscard]] virtual Status begin(std::vector<std::uint8_t> preamble) = 0;
  // Whole records; taken back whole if there is no room. Errors: kUnwritable.
  [[nodiscard]] virtual Status append(std::span<const std::uint8_t> records) = 0;
  // What was appended outlives a power failure.
  [[nodiscard]] virtual Status sync() = 0;
  [[nodiscard]] virtual Status close() = 0;
};

// Segments RUN.lcmlog, RUN.0002.lcmlog, ... The folder is a ring: once all journals in it are more than the quota, or
// the disk is full, the oldest segments go, other runs' first, and never the one that is being written.
class SegmentedStore : public JournalStore {
 public:
  struct Limits {
    std::int64_t segment_bytes = 0;
    std::int64_t quota_bytes = 0;  // 0: no limit
  };
  // The first segment is made at once. Errors: kUnwritable.
  [[nodiscard]] static Result<std::unique_ptr<SegmentedStore>> create(const std::string& run, Limits limits);

  [[nodiscard]] Status begin(std::vector<std::uint8_t> preamble) override;
  [[nodiscard]] Status append(std::span<const std::uint8_t> records) override;
  [[nodiscard]] Status sync() override;
  [[nodiscard]] Status close() override;
  [[nodiscard]] std::string first_path() const { return SegmentName{run_, 1, false}.path(); }

 private:
  SegmentedStore(std::string run, Limits limits, SegmentFile first);
  [[nodiscard]] Status next_segment();
  [[nodiscard]] bool remove_oldest();
  void keep_quota();
  [[nodiscard]] Status append_making_room(std::span<const std::uint8_t> records);

  std::string run_;
  Limits limits_;
  std::optional<SegmentFile> file_;  // none: a new one could not be made yet
  int number_ = 1;
  std::vector<std::uint8_t> preamble_;
};

}  // namespace rfmvo
