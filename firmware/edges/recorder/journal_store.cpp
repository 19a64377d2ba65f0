#include "edges/recorder/journal_store.hpp"

#include <algorithm>
#include <filesystem>

namespace rfmvo {
namespace {

namespace fs = std::filesystem;

struct Segment {
  SegmentName name;
  std::int64_t bytes = 0;
};

// All segments in the folder, the oldest first: the present run's are younger than any other's, whatever the clock
// said when those were named.
std::vector<Segment> segments_of(const std::string& run) {
  std::vector<Segment> segments;
  std::error_code ignored;
  const fs::path parent = fs::path(run).parent_path();
  for (fs::directory_iterator entry(parent.empty() ? "." : parent, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    auto name = segment_name((parent / entry->path().filename()).string());
    std::error_code no_size;
    const auto size = static_cast<std::int64_t>(fs::file_size(entry->path(), no_size));
    if (name && !no_size) segments.push_back({*std::move(name), size});
  }
  std::sort(segments.begin(), segments.end(), [&](const Segment& a, const Segment& b) {
    const bool a_is_own = a.name.run == run, b_is_own = b.name.run == run;
    return a_is_own != b_is_own ? b_is_own : a.name < b.name;
  });
  return segments;
}

}  // namespace

SegmentedStore::SegmentedStore(std::string run, Limits limits, SegmentFile first)
    : run_(std::move(run)), limits_(limits), file_(std::move(first)) {}

Result<std::unique_ptr<SegmentedStore>> SegmentedStore::create(const std::string& run, Limits limits) {
  auto first = SegmentFile::create({run, 1, true});
  if (!first) return first.error();
  auto store = std::unique_ptr<SegmentedStore>(new SegmentedStore(run, limits, std::move(first).value()));
  store->keep_quota();
  return store;
}

bool SegmentedStore::remove_oldest() {
  for (const Segment& segment : segments_of(run_)) {
    if (segment.name.unfinished) continue;  // being written, by us or by another program
    std::error_code error;
    if (fs::remove(segment.name.path_on_disk(), error)) return true;
  }
  return false;
}

void SegmentedStore::keep_quota() {
  if (limits_.quota_bytes == 0) return;
  const auto used = [&] {
    std::int64_t bytes = limits_.segment_bytes;  // the one that begins will grow
    for (const Segment& segment : segments_of(run_)) bytes += segment.name.unfinished ? 0 : segment.bytes;
    return bytes;
  };
  while (used() > limits_.quota_bytes && remove_oldest()) {
  }
}

Status SegmentedStore::next_segment() {
  if (file_) {
    if (const Status s = file_->finish(); !s) return s;
    ++number_;
    file_.reset();
  }
  keep_quota();
  auto next = SegmentFile::create({run_, number_, true});
  if (!next) return next.error();
  file_ = std::move(next).value();
  return Done{};
}

Status SegmentedStore::begin(std::vector<std::uint8_t> preamble) {
  preamble_ = std::move(preamble);
  // A new segment begins with it by itself.
  return file_ && (file_->bytes() > 0 || number_ == 1) ? append_making_room(preamble_) : append({});
}

// A full disk is a smaller quota.
Status SegmentedStore::append_making_room(std::span<const std::uint8_t> records) {
  Status appended = file_->append(records);
  while (!appended && file_->disk_was_full() && remove_oldest()) appended = file_->append(records);
  return appended;
}

Status SegmentedStore::append(std::span<const std::uint8_t> records) {
  const bool full =
      file_ && file_->bytes() > 0 && file_->bytes() + static_cast<std::int64_t>(records.size()) > limits_.segment_bytes;
  if (!file_ || full)
    if (const Status s = next_segment(); !s) return s;
  if (file_->bytes() == 0 && number_ > 1)
    if (const Status s = append_making_room(preamble_); !s) return s;
  return append_making_room(records);
}

Status SegmentedStore::sync() { return file_ ? file_->sync() : Status(Done{}); }

Status SegmentedStore::close() {
  if (!file_) return Done{};
  const Status finished = file_->finish();
  file_.reset();
  return finished;
}

}  // namespace rfmvo
