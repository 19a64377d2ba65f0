#include "mcap/mcap_writer.hpp"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "mcap/mcap_record.hpp"

namespace rfmvo::mcap {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;  // a viewer reads that much at a time

std::uint32_t crc_of(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

Error unwritable(const std::string& path) {
  return {ErrorCode::kUnwritable, std::string("cannot be written: ") + std::strerror(errno), path};
}

std::string temporary_of(const std::string& path) { return path + ".tmp"; }

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::string& path) {
  std::FILE* file = std::fopen(temporary_of(path).c_str(), "wbe");
  if (file == nullptr) return unwritable(path);
  std::unique_ptr<McapWriter> writer(new McapWriter(path, file));
  Content header;
  header.text("").text("rfmvo " RFMVO_VERSION);  // no profile
  if (Status s = writer->put(std::string(kMagic) + record(Opcode::kHeader, header)); !s) return s.error();
  return writer;
}

McapWriter::~McapWriter() {
  if (file_ == nullptr) return;
  (void)std::fclose(file_);
  (void)::unlink(temporary_of(path_).c_str());
}

Status McapWriter::put(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) return unwritable(path_);
  crc_ = crc_of(crc_, bytes);
  offset_ += bytes.size();
  return Done{};
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view schema_name, std::string_view schema) {
  auto known = schema_ids_.find(schema_name);
  if (known == schema_ids_.end()) {
    const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);  // 0 means: no schema
    known = schema_ids_.emplace(std::string(schema_name), id).first;
    schemas_.push_back(record(Opcode::kSchema, Content().u16(id).text(schema_name).text("jsonschema").text(schema)));
    chunk_.records += schemas_.back();
  }
  const auto id = static_cast<std::uint16_t>(channels_.size());
  Channel channel{known->second, 0, {}};
  channel.record =
      record(Opcode::kChannel, Content().u16(id).u16(channel.schema).text(topic).text("json").list(Content()));
  chunk_.records += channel.record;
  channels_.push_back(std::move(channel));
  return id;
}

Status McapWriter::write(std::uint16_t channel, std::int64_t time_ns, std::string_view json) {
  RFMVO_ASSERT(file_ != nullptr && channel < channels_.size());
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
  const auto sequence = static_cast<std::uint32_t>(channels_[channel].messages++);
  const bool first = chunk_.index.empty();
  chunk_.first_ns = first ? time : std::min(chunk_.first_ns, time);
  chunk_.last_ns = first ? time : std::max(chunk_.last_ns, time);
  chunk_.index[channel].emplace_back(time, chunk_.records.size());
  chunk_.records += record(Opcode::kMessage, Content().u16(channel).u32(sequence).u64(time).u64(time).raw(json));
  statistics_.first_ns = statistics_.messages == 0 ? time : std::min(statistics_.first_ns, time);
  statistics_.last_ns = std::max(statistics_.last_ns, time);
  ++statistics_.messages;
  return chunk_.records.size() >= kChunkBytes ? put_chunk() : Status(Done{});
}

Status McapWriter::put_chunk() {
  if (chunk_.records.empty()) return Done{};
  const std::uint64_t size = chunk_.records.size(), begin = offset_;
  Content head;
  head.u64(chunk_.first_ns).u64(chunk_.last_ns).u64(size).u32(crc_of(0, chunk_.records)).text("").u64(size);
  Content frame;
  frame.u8(static_cast<std::uint8_t>(Opcode::kChunk)).u64(head.bytes().size() + size);
  for (const std::string_view part :
       {std::string_view(frame.bytes()), std::string_view(head.bytes()), std::string_view(chunk_.records)})
    if (Status s = put(part); !s) return s;
  const std::uint64_t chunk_length = offset_ - begin, index_begin = offset_;
  Content offsets;
  for (auto& [channel, entries] : chunk_.index) {
    std::stable_sort(entries.begin(), entries.end());
    offsets.u16(channel).u64(offset_);
    Content list;
    for (const auto& [time, offset] : entries) list.u64(time).u64(offset);
    if (Status s = put(record(Opcode::kMessageIndex, Content().u16(channel).list(list))); !s) return s;
  }
  chunk_indexes_.push_back(record(Opcode::kChunkIndex, Content()
                                                           .u64(chunk_.first_ns)
                                                           .u64(chunk_.last_ns)
                                                           .u64(begin)
                                                           .u64(chunk_length)
                                                           .list(offsets)
                                                           .u64(offset_ - index_begin)
                                                           .text("")
                                                           .u64(size)
                                                           .u64(size)));
  ++statistics_.chunks;
  chunk_ = {};
  return Done{};
}

std::string McapWriter::statistics_record() const {
  Content counts;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    counts.u16(static_cast<std::uint16_t>(i)).u64(channels_[i].messages);
  constexpr std::uint32_t kAttachments = 0, kMetadata = 0;
  return record(Opcode::kStatistics, Content()
                                         .u64(statistics_.messages)
                                         .u16(static_cast<std::uint16_t>(schemas_.size()))
                                         .u32(static_cast<std::uint32_t>(channels_.size()))
                                         .u32(kAttachments)
                                         .u32(kMetadata)
                                         .u32(statistics_.chunks)
                                         .u64(statistics_.first_ns)
                                         .u64(statistics_.last_ns)
                                         .list(counts));
}

// Groups of records, where each begins, then the footer with the CRC from here on.
Status McapWriter::put_summary() {
  const std::uint64_t summary = offset_;
  crc_ = 0;
  std::string offsets;
  const auto group = [&](Opcode opcode, const auto& records) -> Status {
    const std::uint64_t begin = offset_;
    for (const auto& one : records)
      if (Status s = put(one); !s) return s;
    if (offset_ > begin)
      offsets += record(Opcode::kSummaryOffset,
                        Content().u8(static_cast<std::uint8_t>(opcode)).u64(begin).u64(offset_ - begin));
    return Done{};
  };
  std::vector<std::string> channels;
  for (const Channel& channel : channels_) channels.push_back(channel.record);
  if (Status s = group(Opcode::kSchema, schemas_); !s) return s;
  if (Status s = group(Opcode::kChannel, channels); !s) return s;
  if (Status s = group(Opcode::kStatistics, std::vector{statistics_record()}); !s) return s;
  if (Status s = group(Opcode::kChunkIndex, chunk_indexes_); !s) return s;
  const std::uint64_t summary_offsets = offset_;
  if (Status s = put(offsets); !s) return s;
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  Content footer;
  footer.u8(static_cast<std::uint8_t>(Opcode::kFooter)).u64(kFooterBytes).u64(summary).u64(summary_offsets);
  if (Status s = put(footer.bytes()); !s) return s;
  if (Status s = put(Content().u32(crc_).bytes()); !s) return s;
  return put(kMagic);
}

Status McapWriter::close() {
  RFMVO_ASSERT(file_ != nullptr);
  if (Status s = put_chunk(); !s) return s;
  if (Status s = put(record(Opcode::kDataEnd, Content().u32(crc_))); !s) return s;
  if (Status s = put_summary(); !s) return s;
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0 ||
      std::rename(temporary_of(path_).c_str(), path_.c_str()) != 0)
    return unwritable(path_);
  (void)std::fclose(file_);
  file_ = nullptr;
  return Done{};
}

}  // namespace rfmvo::mcap
