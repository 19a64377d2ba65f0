// A file in the MCAP format, version 0 (specification: mcap.dev/spec), as viewers such as Foxglove open it: messages
// as JSON in chunks without compression, each chunk with its CRC and index, and a summary at the end so that a viewer
// finds its way without reading everything.
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace rfmvo::mcap {

class McapWriter {
 public:
  // Writes PATH.tmp, which becomes PATH when close() succeeds and is removed otherwise. Errors: kUnwritable.
  [[nodiscard]] static Result<std::unique_ptr<McapWriter>> create(const std::string& path);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  // schema: a JSON Schema. The same schema name twice: the first text counts.
  std::uint16_t add_channel(std::string_view topic, std::string_view schema_name, std::string_view schema);
  // Times: nanoseconds since 1970; they need not increase.
  [[nodiscard]] Status write(std::uint16_t channel, std::int64_t time_ns, std::string_view json);
  [[nodiscard]] Status close();
  [[nodiscard]] std::uint64_t messages() const { return statistics_.messages; }

 private:
  struct Channel {
    std::uint16_t schema = 0;
    std::uint64_t messages = 0;
    std::string record;  // as it stands in the file
  };
  struct Chunk {
    std::string records;
    std::uint64_t first_ns = 0, last_ns = 0;
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index;  // time, offset in the records
  };
  struct Statistics {
    std::uint64_t messages = 0, first_ns = 0, last_ns = 0;
    std::uint32_t chunks = 0;
  };

  McapWriter(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  [[nodiscard]] Status put(std::string_view bytes);
  [[nodiscard]] Status put_chunk();
  [[nodiscard]] Status put_summary();
  [[nodiscard]] std::string statistics_record() const;

  std::string path_;
  std::FILE* file_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  // of everything so far
  std::map<std::string, std::uint16_t, std::less<>> schema_ids_;
  std::vector<std::string> schemas_;  // records
  std::vector<Channel> channels_;
  std::vector<std::string> chunk_indexes_;  // records
  Chunk chunk_;
  Statistics statistics_;
};

}  // namespace rfmvo::mcap
