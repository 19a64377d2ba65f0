#include <gtest/gtest.h>

#include "edges/llrp/codec.hpp"
#include "edges/llrp/tag_reports.hpp"
#include "edges/llrp/vendor.hpp"
#include "support/llrp_frames.hpp"

namespace rfmvo::llrp {
namespace {

const ChannelTable kTable{true, 1, {920'625'000, 921'125'000, 924'125'000}};

TagReportData whole_report() {
  TagReportData r;
  r.epc_parameter = EPC_96{{0x30, 0x74, 0x25, 0x7B, 0xF7, 0x19, 0x4E, 0x40, 0, 0, 0x1A, 0x85}};
  r.antenna_id = AntennaID{2};
  r.peak_rssi = PeakRSSI{-53};
  r.channel_index = ChannelIndex{3};
  r.first_seen_timestamp_utc = FirstSeenTimestampUTC{1'700'000'000'000'001};
  r.tag_seen_count = TagSeenCount{1};
  r.customs = {pack(ImpinjRFPhaseAngle{1272}), pack(ImpinjPeakRSSI{-5325}), pack(ImpinjRFDopplerFrequency{-273})};
  return r;
}

TEST(TagReports, GiveAllThatAReadHas) {
  TagReports reports(kTable, PhaseSign::kGrows);
  const auto reported = reports.on(whole_report());
  ASSERT_TRUE(reported.has_value());
  const TagRead& read = reported->read;
  EXPECT_EQ(read.epc.hex(), "3074257BF7194E4000001A85");
  EXPECT_EQ(read.port, 2);
  EXPECT_EQ(read.frequency_hz, 924'125'000u) << "the third entry: indices count from 1";
  EXPECT_EQ(read.reader_time.us(), 1'700'000'000'000'001);
  EXPECT_EQ(read.phase.turn_q16, 1272 * 16) << "4096 counts a turn";
  EXPECT_EQ(read.rssi_cdbm, -5325) << "the finer of the two";
  EXPECT_EQ(read.doppler_hz_q4, -273);
  EXPECT_EQ(read.seen_count, 1);
  EXPECT_EQ(reported->stamp, StampKind::kUtc);
}

TEST(TagReports, TurnThePhaseOfAReaderThatCountsTheOtherWay) {
  TagReports grows(kTable, PhaseSign::kGrows), falls(kTable, PhaseSign::kFalls);
  for (const std::uint16_t raw : {0, 1, 2048, 4095}) {
    TagReportData report = whole_report();
    report.customs = {pack(ImpinjRFPhaseAngle{raw})};
    const std::uint16_t a = grows.on(report)->read.phase.turn_q16, b = falls.on(report)->read.phase.turn_q16;
    EXPECT_EQ(static_cast<std::uint16_t>(a + b), 0) << "opposite angles, modulo a turn";
  }
}

// 0x4000 = 90 degrees.
TEST(TagReports, ReadThePhaseOfZebra) {
  TagReports reports(kTable, PhaseSign::kGrows);
  TagReportData report = whole_report();
  report.customs = {pack(MotoTagPhase{0x4000})};
  EXPECT_EQ(reports.on(report)->read.phase.turn_q16, 65536 / 4);
  report.customs = {pack(MotoTagPhase{-0x4000})};
  EXPECT_EQ(reports.on(report)->read.phase.turn_q16, 65536 * 3 / 4);
  EXPECT_EQ(reports.on(report)->read.rssi_cdbm, -5300) << "the standard's dBm";
}

TEST(TagReports, CarryOverWhatAReportLeavesOut) {
  TagReports reports(kTable, PhaseSign::kGrows);
  (void)reports.on(whole_report());
  TagReportData bare;
  bare.epc_parameter = EPCData{{16, {0xAB, 0xCD}}};
  bare.customs = {pack(ImpinjRFPhaseAngle{4})};
  const auto reported = reports.on(bare);
  ASSERT_TRUE(reported.has_value());
  EXPECT_EQ(reported->read.epc.hex(), "ABCD");
  EXPECT_EQ(reported->read.port, 2);
  EXPECT_EQ(reported->read.frequency_hz, 924'125'000u);
  EXPECT_EQ(reported->read.rssi_cdbm, -5300);
  EXPECT_EQ(reported->read.reader_time.us(), 1'700'000'000'000'001);
  bare.antenna_id = AntennaID{1};
  (void)reports.on(bare);
  bare.antenna_id.reset();
  EXPECT_EQ(reports.on(bare)->read.port, 1) << "the last of its type counts";
}

TEST(TagReports, SayHowManySingulationsAReportSums) {
  TagReports reports(kTable, PhaseSign::kGrows);
  TagReportData report = whole_report();
  report.tag_seen_count = TagSeenCount{7};
  EXPECT_EQ(reports.on(report)->read.seen_count, 7) << "its phase is not used: see the estimators";
}

TEST(TagReports, TakeTheUptimeOfAReaderWithoutAClock) {
  TagReports reports(kTable, PhaseSign::kGrows);
  TagReportData report = whole_report();
  report.first_seen_timestamp_utc.reset();
  report.last_seen_timestamp_uptime = LastSeenTimestampUptime{5'000'000};
  const auto reported = reports.on(report);
  ASSERT_TRUE(reported.has_value());
  EXPECT_EQ(reported->stamp, StampKind::kUptime);
  EXPECT_EQ(reported->read.reader_time.us(), 5'000'000);
}

TEST(TagReports, CountWhatMakesNoRead) {
  TagReports reports(kTable, PhaseSign::kGrows);
  const auto lost_by = [&](auto change) {
    TagReports fresh(kTable, PhaseSign::kGrows);
    TagReportData report = whole_report();
    change(report);
    EXPECT_FALSE(fresh.on(report).has_value());
    return fresh.counts();
  };
  EXPECT_EQ(lost_by([](auto& r) { r.epc_parameter = EPCData{{0, {}}}; }).without_epc, 1u);
  EXPECT_EQ(lost_by([](auto& r) {
              r.epc_parameter = EPCData{{63 * 8, std::vector<std::uint8_t>(63)}};
            }).without_epc,
            1u);
  EXPECT_EQ(lost_by([](auto& r) { r.channel_index = ChannelIndex{4}; }).without_channel, 1u);
  EXPECT_EQ(lost_by([](auto& r) { r.channel_index = ChannelIndex{0}; }).without_channel, 1u);
  EXPECT_EQ(lost_by([](auto& r) { r.channel_index.reset(); }).without_channel, 1u);
  EXPECT_EQ(lost_by([](auto& r) { r.antenna_id = AntennaID{0}; }).without_port, 1u);
  EXPECT_EQ(lost_by([](auto& r) { r.first_seen_timestamp_utc->microseconds = ~0ULL; }).without_time, 1u);
  EXPECT_EQ(lost_by([](auto& r) { r.customs = {pack(ImpinjPeakRSSI{})}; }).without_phase, 1u);
}

GetReaderCapabilitiesResponse capabilities(FrequencyInformation info) {
  GetReaderCapabilitiesResponse c;
  c.regulatory_capabilities.emplace();
  c.regulatory_capabilities->uhf_band_capabilities.emplace().frequency_information = std::move(info);
  return c;
}

TEST(ChannelTableOf, IsTheReadersOwnInItsOrder) {
  const auto table = channel_table(capabilities({true, {{1, {912'750, 926'250, 919'250}}}, {}}), 0);
  ASSERT_TRUE(table.ok());
  EXPECT_EQ(table.value().frequency_hz(2), 926'250'000u);
  EXPECT_FALSE(table.value().frequency_hz(0).has_value());
  EXPECT_FALSE(table.value().frequency_hz(4).has_value());
  const auto fixed = channel_table(capabilities({false, {}, FixedFrequencyTable{{865'700, 866'300}}}), 0);
  ASSERT_TRUE(fixed.ok());
  EXPECT_EQ(fixed.value().frequency_hz(1), 865'700'000u);
}

TEST(ChannelTableOf, RefusesWhatCannotBe) {
  const auto error = [](FrequencyInformation info, std::uint8_t id = 0) {
    const auto table = channel_table(capabilities(std::move(info)), id);
    return table.ok() ? "" : table.error().what;
  };
  EXPECT_EQ(error({true, {{1, {2'293'250}}}, {}}), "a channel of 2293250 kHz is outside 840 to 960 MHz");
  EXPECT_EQ(error({true, {{1, {920'000}}, {2, {921'000}}}, {}}, 3), "the reader has no hop table 3; it has 1 2");
  EXPECT_EQ(error({true, {}, {}}), "the reader hops, but states no hop table");
  EXPECT_EQ(error({true, {{1, {}}}, {}}), "the reader's table of channels is empty");
  EXPECT_EQ(error({false, {}, {}}), "the reader states no frequencies");
}

}  // namespace
}  // namespace rfmvo::llrp
