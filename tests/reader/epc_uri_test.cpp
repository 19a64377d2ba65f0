#include "rf/epc_uri.hpp"

#include <gtest/gtest.h>

namespace rfmvo {
namespace {

std::string uri_of(const std::string& hex) { return epc_tag_uri(Epc::from_hex(hex).value()).value_or("none"); }

// GS1 EPC Tag Data Standard 1.13, appendix E.3, "Summary of examples of all EPC schemes".
TEST(EpcUri, SpeaksTheExamplesOfTheTagDataStandard) {
  EXPECT_EQ(uri_of("3074257BF7194E4000001A85"), "urn:epc:tag:sgtin-96:3.0614141.812345.6789");
  EXPECT_EQ(uri_of("3174257BF4499602D2000000"), "urn:epc:tag:sscc-96:3.0614141.1234567890");
  EXPECT_EQ(uri_of("3274257BF46072000000162E"), "urn:epc:tag:sgln-96:3.0614141.12345.5678");
  EXPECT_EQ(uri_of("3374257BF40C0E400000162E"), "urn:epc:tag:grai-96:3.0614141.12345.5678");
  EXPECT_EQ(uri_of("3474257BF40000000000162E"), "urn:epc:tag:giai-96:3.0614141.5678");
}

// A company prefix of twelve digits leaves none for a place or an asset type.
TEST(EpcUri, LeavesTheReferenceEmptyWhereThePrefixTakesAllDigits) {
  // filter 0, partition 0, company 000000000001 in 40 bits, location 0 in 1 bit, extension 5 in 41 bits
  EXPECT_EQ(uri_of("320000000000040000000005"), "urn:epc:tag:sgln-96:0.000000000001..5");
}

TEST(EpcUri, DoesNotGuess) {
  EXPECT_EQ(uri_of("E28011602000600D3CA80AE1"), "none") << "header of no GS1 scheme";
  EXPECT_EQ(uri_of("3074257BF7194E4000001A"), "none") << "88 bits";
  EXPECT_EQ(uri_of("3074257BF7194E4000001A850000"), "none") << "112 bits";
  EXPECT_EQ(uri_of("307C257BF7194E4000001A85"), "none") << "partition 7";
  EXPECT_EQ(uri_of("3174257BF4499602D2000001"), "none") << "SSCC with something in its reserved bits";
  EXPECT_EQ(uri_of("3077FFFFF7194E4000001A85"), "none") << "a company prefix of more than seven digits";
}

}  // namespace
}  // namespace rfmvo
