// One segment of a journal while it is written: whole records only, whatever happens. Written straight to the kernel,
// so that a program that dies loses nothing that it has handed over; sync() makes it outlive a power failure.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "edges/net/fd.hpp"
#include "edges/recorder/journal_names.hpp"

namespace rfmvo {

class SegmentFile {
 public:
  // Errors: kUnwritable; nothing of that name may exist.
  [[nodiscard]] static Result<SegmentFile> create(const SegmentName& name);

  // Appends; a record that does not fit on the disk is taken back whole. Errors: kUnwritable (disk full, card broken).
  [[nodiscard]] Status append(std::span<const std::uint8_t> records);
  [[nodiscard]] Status sync();
  // Sync, then the final name.
  [[nodiscard]] Status finish();
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }
  [[nodiscard]] bool disk_was_full() const { return disk_was_full_; }  // at the last append()
  [[nodiscard]] const SegmentName& name() const { return name_; }

 private:
  SegmentFile(SegmentName name, net::Fd fd) : name_(std::move(name)), fd_(std::move(fd)) {}
  [[nodiscard]] Error trouble(int error) const;

  SegmentName name_;
  net::Fd fd_;
  std::int64_t bytes_ = 0;
  bool disk_was_full_ = false;
};

// The unfinished segments that a program which died left in the folder get their final names, each up to its last whole
// record; one without any goes. Those that another program is writing are left alone. What was done, one line each.
struct Recovered {
  std::string path;
  std::int64_t records = 0, bytes = 0, bytes_cut = 0;
};
[[nodiscard]] std::vector<Recovered> recover_segments(const std::string& folder);

}  // namespace rfmvo
