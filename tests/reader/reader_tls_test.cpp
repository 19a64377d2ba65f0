// The reader by TLS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "support/reader_bench.hpp"
#include "support/sample_events.hpp"

namespace rfmvo {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ReaderBench;
using testing::run_command;
using testing::sample_model;
using testing::TemporaryFolder;

class ReaderTls : public ::testing::Test {
 protected:
  void SetUp() override {
    std::signal(SIGPIPE, SIG_IGN);  // as the daemon does
    const auto made = run_command(
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 "
        "-subj /CN=reader -addext subjectAltName=IP:127.0.0.1 -keyout '" +
        key_ + "' -out '" + certificate_ + "'");
    ASSERT_EQ(made.exit_code, 0) << made.err;
    server_.tls_certificate = certificate_;
    server_.tls_key = key_;
    client_.tls = true;
  }
  TemporaryFolder folder_;
  const std::string key_ = folder_ / "key.pem", certificate_ = folder_ / "certificate.pem";
  reader_sim::ServerSettings server_;
  llrp::ReaderSettings client_;
};

TEST_F(ReaderTls, ReadsAndTrustsTheCertificateItWasGiven) {
  client_.tls_ca = certificate_;
  ReaderBench bench(sample_model(200, 0.005), {}, client_, server_);
  ASSERT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 2.0)) << bench.faults().size();
  bench.run(2.0);
  EXPECT_THAT(bench.faults(), IsEmpty());
  EXPECT_EQ(bench.all<TagRead>().size(), 200u);
}

TEST_F(ReaderTls, TakesAnyCertificateIfItWasGivenNone) {
  ReaderBench bench(sample_model(), {3, Duration{0}, {}}, client_, server_);
  EXPECT_TRUE(bench.run_until([&] { return bench.link->session().reading(); }, 4.0));
}

TEST_F(ReaderTls, RefusesAReaderThatAnotherCertificateVouchesFor) {
  const std::string other = folder_ / "other.pem";
  ASSERT_EQ(run_command("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj "
                        "/CN=other -keyout '" +
                        (folder_ / "other.key") + "' -out '" + other + "'")
                .exit_code,
            0);
  client_.tls_ca = other;
  ReaderBench bench(sample_model(), {}, client_, server_);
  bench.run(1.0);
  EXPECT_FALSE(bench.link->session().reading());
  EXPECT_THAT(bench.faults(), ElementsAre(HasSubstr("certificate verify failed")));
}

TEST_F(ReaderTls, SaysThatAPlainReaderSpeaksNoTls) {
  ReaderBench bench(sample_model(), {}, client_);
  bench.run(12.0, 0.05);
  EXPECT_FALSE(bench.link->session().reading());
  EXPECT_THAT(bench.faults(), Contains(HasSubstr("TLS")));
}

}  // namespace
}  // namespace rfmvo
