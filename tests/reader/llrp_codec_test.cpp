#include <gtest/gtest.h>

#include <map>

#include "edges/llrp/codec.hpp"
#include "edges/llrp/frame_splitter.hpp"
#include "edges/llrp/vendor.hpp"
#include "support/llrp_frames.hpp"

namespace rfmvo::llrp {
namespace {

using testing::Frame;
using testing::from_hex;
using testing::llrp_data;

bool has_data() { return std::filesystem::exists(llrp_data("")); }
#define RFMVO_NEEDS_LLRP_DATA() \
  if (!has_data()) GTEST_SKIP() << "no LLRP frames in " << llrp_data("")

std::string decode_error(const Frame& frame) {
  const auto decoded = decode(frame);
  return decoded ? "" : decoded.error().text();
}

// LLRP Toolkit's golden frames: all of them decode, and what holds nothing unknown is written back as it was.
TEST(LlrpCodec, TakesTheToolkitsFramesAndWritesThemBackByteForByte) {
  RFMVO_NEEDS_LLRP_DATA();
  for (const auto& [name, count] : std::map<std::string, std::size_t>{{"ltk_vectors/dx101_a.bin", 934},
                                                                      {"ltk_vectors/dx101_b.bin", 24},
                                                                      {"ltk_vectors/dx101_c.bin", 11},
                                                                      {"ltk_vectors/dx101_e.bin", 750},
                                                                      {"golden/impinj_phase_reports.bin", 4},
                                                                      {"edgex_R420_fw5.14_frames.bin", 15}}) {
    const std::vector<Frame> frames = testing::frames_of(llrp_data(name));
    EXPECT_EQ(frames.size(), count) << name;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const auto decoded = decode(frames[k]);
      ASSERT_TRUE(decoded.ok()) << name << " frame " << k << ": " << decoded.error().text();
      EXPECT_TRUE(decoded.value().skipped.empty()) << name << " frame " << k << ": " << decoded.value().skipped[0];
      ASSERT_TRUE(encode(decoded.value().message) == frames[k]) << name << " frame " << k;
    }
  }
}

TEST(LlrpCodec, TakesTheBodiesOfARealR420) {
  RFMVO_NEEDS_LLRP_DATA();
  const std::map<std::string, std::uint16_t> types{
      {"CloseConnectionResponse", 4},  {"GetAccessSpecsResponse", 54},
      {"GetROSpecsResponse", 36},      {"GetReaderCapabilitiesResponse", 11},
      {"GetReaderConfigResponse", 12}, {"ReaderEventNotification", 63},
      {"ROAccessReport", 61}};
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(llrp_data("edgex"))) {
    if (entry.path().extension() != ".bytes") continue;
    const std::string name = entry.path().stem().string();
    const Frame body = testing::bytes_of(entry.path());
    const Frame frame = encode({7, RawMessage{types.at(name.substr(0, name.find('-'))), body}});
    const auto decoded = decode(frame);
    ASSERT_TRUE(decoded.ok()) << entry.path() << ": " << decoded.error().text();
    EXPECT_TRUE(encode(decoded.value().message) == frame) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 6u);
}

// What the capabilities of that reader say (edgex, JSON beside the frames).
TEST(LlrpCodec, ReadsWhatAnR420SaysOfItself) {
  RFMVO_NEEDS_LLRP_DATA();
  const Frame body = testing::bytes_of(llrp_data("edgex/GetReaderCapabilitiesResponse-000.bytes"));
  const auto decoded = decode(encode({1, RawMessage{11, body}}));
  ASSERT_TRUE(decoded.ok());
  const auto& response = std::get<GetReaderCapabilitiesResponse>(decoded.value().message.body);
  ASSERT_TRUE(response.general_device_capabilities && response.regulatory_capabilities);
  EXPECT_EQ(response.general_device_capabilities->device_manufacturer_name, kImpinj);
  EXPECT_EQ(response.general_device_capabilities->max_number_of_antenna_supported, 4);
  EXPECT_TRUE(response.general_device_capabilities->has_utc_clock_capability);
  EXPECT_EQ(response.general_device_capabilities->reader_firmware_version, "5.14.0.240");
  const auto& band = response.regulatory_capabilities->uhf_band_capabilities;
  ASSERT_TRUE(band.has_value());
  EXPECT_TRUE(band->frequency_information.hopping);
  ASSERT_EQ(band->frequency_information.frequency_hop_tables.size(), 1u);
  EXPECT_EQ(band->frequency_information.frequency_hop_tables[0].frequency.size(), 50u) << "FCC: fifty channels";
}

// 4 reports, 7 tags; values from the XML beside the frames.
TEST(LlrpCodec, ReadsTheExtensionsOfImpinj) {
  RFMVO_NEEDS_LLRP_DATA();
  const auto frames = testing::frames_of(llrp_data("golden/impinj_phase_reports.bin"));
  ASSERT_FALSE(frames.empty());
  const auto decoded = decode(frames[0]);
  ASSERT_TRUE(decoded.ok());
  const auto& tags = std::get<RoAccessReport>(decoded.value().message.body).tag_report_data;
  ASSERT_EQ(tags.size(), 1u);
  EXPECT_EQ(unpack<ImpinjRFPhaseAngle>(tags[0].customs)->phase, 1272);
  EXPECT_EQ(unpack<ImpinjPeakRSSI>(tags[0].customs)->rssi_cdbm, -5300);
  EXPECT_EQ(unpack<ImpinjRFDopplerFrequency>(tags[0].customs)->doppler_hz_q4, 273);
  EXPECT_FALSE(unpack<MotoTagPhase>(tags[0].customs).has_value());
}

TEST(LlrpCodec, GivesOneClearErrorForEachBrokenFrame) {
  RFMVO_NEEDS_LLRP_DATA();
  const std::map<std::string, std::string> expected{
      {"bad_type", "header: LLRP has no message type 999"},
      {"child_len_too_long", "RO_ACCESS_REPORT.TagReportData: Custom: length 20 does not fit into the 14 bytes left"},
      {"child_len_too_short", "RO_ACCESS_REPORT.TagReportData: ends within a parameter's header"},
      {"missing_status", "ADD_ROSPEC_RESPONSE: LLRPStatus is missing"},
      {"tag_without_epc", "RO_ACCESS_REPORT.TagReportData: EPCData or EPC_96 is missing"},
      {"tlv_len_3",
       "RO_ACCESS_REPORT.TagReportData: TagReportContentSelector: length 3 does not fit into the 4 bytes left"},
      {"trunc_addrospec", "ADD_ROSPEC.ROSpec: ROBoundarySpec is missing"},
      {"unknown_tv", "RO_ACCESS_REPORT.TagReportData: unknown TV parameter 127"},
      {"wrong_param_in_message", "RO_ACCESS_REPORT: ROSpec has no place here"},
      {"unknown_tlv", ""},  // passed over
      {"ver2", ""},         // LLRP 1.1
      {"ok", ""}};
  for (const auto& [name, error] : expected)
    EXPECT_EQ(decode_error(testing::bytes_of(llrp_data("malformed/neg_" + name + ".bin"))), error) << name;
}

TEST(LlrpCodec, PassesOverUnknownParametersAndNamesThem) {
  const auto decoded = decode(from_hex("043d 00000023 00000001 00f00019 8d000102030405060708090a0b 0384000861626364"));
  ASSERT_TRUE(decoded.ok()) << decoded.error().text();
  EXPECT_EQ(decoded.value().skipped, std::vector<std::string>{"TagReportData: unknown parameter 900"});
  EXPECT_EQ(std::get<RoAccessReport>(decoded.value().message.body).tag_report_data.size(), 1u);
}

TEST(LlrpCodec, RefusesAParameterThatComesTwice) {
  EXPECT_EQ(decode_error(from_hex("043d 00000021 00000001 00f00017 8d000102030405060708090a0b 810001 810002")),
            "RO_ACCESS_REPORT.TagReportData: AntennaID appears twice");
}

TEST(LlrpCodec, RefusesErrorsWithinErrorsWithoutEnd) {
  Frame nested;  // ParameterError in ParameterError ...
  for (int depth = 0; depth < 100; ++depth) {
    const std::size_t size = nested.size() + 8;
    Frame outer = {0x01, 0x21, static_cast<std::uint8_t>(size >> 8), static_cast<std::uint8_t>(size), 0, 1, 0, 100};
    outer.insert(outer.end(), nested.begin(), nested.end());
    nested = outer;
  }
  const std::size_t size = nested.size() + 8;
  Frame status = {0x01, 0x1f, static_cast<std::uint8_t>(size >> 8), static_cast<std::uint8_t>(size), 0, 100, 0, 0};
  status.insert(status.end(), nested.begin(), nested.end());
  const std::string error = decode_error(encode({1, RawMessage{100, status}}));
  EXPECT_NE(error.find("nested too deep"), std::string::npos) << error;
}

// No prefix of a frame passes for a frame, whatever its header claims; nothing is read past its end (ASan).
TEST(LlrpCodec, RefusesEveryTruncatedFrame) {
  RFMVO_NEEDS_LLRP_DATA();
  for (const Frame& frame : testing::frames_of(llrp_data("edgex_R420_fw5.14_frames.bin"))) {
    for (std::size_t size = kHeaderBytes; size < frame.size(); ++size) {
      Frame cut(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(decode(cut).ok());
    }
  }
}

TEST(LlrpCodec, SaysWhatAStatusMeans) {
  LLRPStatus status{100, "Failed", std::nullopt, ParameterError{177, 200, std::nullopt, {}}};
  status.parameter_error->parameter_error.push_back(ParameterError{1023, 209, FieldError{3, 301}, {}});
  EXPECT_EQ(
      status_text(status),
      "M_ParameterError: ROSpec (P_ParameterError) in it Custom (P_UnsupportedParameter), field 3 (A_OutOfRange): "
      "Failed");
}

TEST(FrameSplitter, GivesTheSameFramesHoweverTheStreamIsCut) {
  const Frame first = encode({1, Keepalive{}}), second = encode({2, DeleteRoSpec{{5}}}),
              third = encode({3, Keepalive{}});
  Frame stream = first;
  stream.insert(stream.end(), second.begin(), second.end());
  stream.insert(stream.end(), third.begin(), third.end());
  for (std::size_t a = 0; a <= stream.size(); ++a)
    for (std::size_t b = a; b <= stream.size(); ++b) {
      FrameSplitter splitter;
      std::vector<Frame> frames;
      const auto feed = [&](std::size_t from, std::size_t to) {
        splitter.feed(std::span(stream).subspan(from, to - from));
        for (auto next = splitter.next(); next.ok() && next.value(); next = splitter.next())
          frames.emplace_back(next.value()->begin(), next.value()->end());
      };
      feed(0, a), feed(a, b), feed(b, stream.size());
      ASSERT_EQ(frames, (std::vector<Frame>{first, second, third})) << a << " " << b;
      EXPECT_TRUE(splitter.empty());
    }
}

TEST(FrameSplitter, StopsAtWhatIsNoHeader) {
  FrameSplitter splitter;
  splitter.feed(from_hex("48545450 2f312e31 2034 3034"));  // a web server
  const auto next = splitter.next();
  ASSERT_FALSE(next.ok());
  splitter = FrameSplitter();
  splitter.feed(from_hex("043d 7fffffff 00000001"));
  EXPECT_EQ(splitter.next().error().text(), "header: a frame of 2147483647 bytes is too long");
}

}  // namespace
}  // namespace rfmvo::llrp
