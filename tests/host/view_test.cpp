// rfmvo view: tags in the picture, what the page is told, who may have it.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>
#include <random>

#include "edges/lcm_codec.hpp"
#include "host/host_command.hpp"
#include "host/real_bus.hpp"
#include "support/evaluate_world.hpp"
#include "view/image_overlay.hpp"
#include "view/page.hpp"
#include "view/view_model.hpp"
#include "view/web_server.hpp"

namespace rfmvo {
namespace {

using testing::Background;
using testing::expect_one_line;
using ::testing::HasSubstr;
using testing::in_quotes;
using ::testing::Not;
using testing::TemporaryFolder;
using Json = nlohmann::json;

CameraModel lens(Distortion distortion) {
  CameraModel camera{640, 480, 520.0, 515.0, 325.0, 236.0, {-0.2, 0.05, 0.001, -0.0005, 0.0}};
  camera.distortion = distortion;
  camera.equidistant = {-0.02, 0.01, -0.003, 0.0005};
  return camera;
}

// Points drawn from the tag's distribution and projected one by one: 95 % of them lie in the ellipse.
TEST(InPicture, EllipseHoldsTheShareThatItSays) {
  std::mt19937_64 random(3);
  for (const Distortion distortion : {Distortion::kRadtan, Distortion::kEquidistant}) {
    const CameraModel camera = lens(distortion);
    for (int trial = 0; trial < 5; ++trial) {
      const Rigid3 T_W_C{so3_exp({0.2 * trial, -0.4, 1.0 + trial}), {1.0, -2.0, 0.5 * trial}};
      const Eigen::Vector3d p_W = T_W_C * Eigen::Vector3d(0.4 - 0.2 * trial, 0.1 * trial, 2.5);
      Eigen::Matrix3d covariance;
      covariance << 9e-4, 4e-4, -2e-4, 4e-4, 16e-4, 1e-4, -2e-4, 1e-4, 4e-4;
      const auto ellipse = view::in_picture(camera, T_W_C, p_W, covariance);
      ASSERT_TRUE(ellipse);
      int inside = 0;
      constexpr int kSamples = 4000;
      const Eigen::Rotation2Dd to_axes(-ellipse->angle_rad);
      for (int k = 0; k < kSamples; ++k) {
        const Eigen::Vector3d p = T_W_C.inverse() * (p_W + testing::sample(covariance, random));
        const Eigen::Vector2d off = to_axes * (project(camera, p.head<2>() / p.z()) - ellipse->centre_px);
        inside += std::hypot(off.x() / ellipse->major_px, off.y() / ellipse->minor_px) < 1.0 ? 1 : 0;
      }
      // 4 sigma of the binomial, and what the second order of the projection leaves: at 2 cm in 2.5 m below 1 %.
      EXPECT_NEAR(inside / double{kSamples}, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / kSamples) + 0.01);
    }
  }
}

TEST(InPicture, WhatIsBehindTheCameraIsNotInIt) {
  const CameraModel camera = lens(Distortion::kRadtan);
  const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  EXPECT_FALSE(view::in_picture(camera, {}, {0, 0, -2}, covariance));
  EXPECT_FALSE(view::in_picture(camera, {}, {0, 0, 0.05}, covariance));
  EXPECT_FALSE(view::in_picture(camera, {}, {30, 0, 1}, covariance));
  EXPECT_TRUE(view::in_picture(camera, {}, {0, 0, 2}, covariance));
}

TEST(ViewModel, TellsThePageWhatWasHeard) {
  view::ViewModel model("RFMVO_");
  EXPECT_EQ(model.picture(), "");
  const auto hear = [&](const LcmMessage& m) { model.on({m.channel, m.data}, 0); };
  for (const Event& event : testing::one_of_each_event()) hear(encode(event, "RFMVO_"));
  for (const Estimate& estimate : testing::one_of_each_estimate())
    for (const LcmMessage& m : encode(estimate, "RFMVO_")) hear(m);
  EXPECT_EQ(model.picture().substr(0, 2), "\xFF\xD8") << "a JPEG of the grey frame";
  const Json overlay = Json::parse(model.overlay()), map = Json::parse(model.map()),
             status = Json::parse(model.status({}));
  EXPECT_EQ(overlay.at("width"), 640);
  EXPECT_TRUE(overlay.contains("camera"));
  EXPECT_EQ(map.at("paths").at(0).size(), 2u);
  EXPECT_EQ(map.at("tags").at(0).at("other").size(), 1u);
  EXPECT_EQ(status.at("box").at("well"), false);
  EXPECT_EQ(status.at("box").at("problems").at(0), "odometry LOST");
}

TEST(ViewModel, VersionsCountOnlyWhatChanged) {
  view::ViewModel model("RFMVO_");
  const auto events = testing::one_of_each_event();
  const auto hear = [&](const LcmMessage& m) { model.on({m.channel, m.data}, 0); };
  hear(encode(events[1], "RFMVO_"));  // a frame
  EXPECT_EQ(model.picture_version(), 1u);
  EXPECT_EQ(model.map_version(), 0u);
  hear(encode(events[3], "RFMVO_"));  // a read: nothing to see
  EXPECT_EQ(model.picture_version(), 1u);
  EXPECT_EQ(model.overlay_version(), 1u);
}

TEST(Page, AsksNothingFromElsewhere) {
  const std::string page = view::kPage;
  EXPECT_THAT(page, Not(HasSubstr("http://")));
  EXPECT_THAT(page, Not(HasSubstr("https://")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("innerHTML"))) << "what a tag says must not become markup";
}

TEST(Loopback, IsThisMachineAlone) {
  for (const char* here : {"127.0.0.1", "127.1.2.3", "localhost", "::1", "[::1]"}) EXPECT_TRUE(view::is_loopback(here));
  for (const char* there : {"0.0.0.0", "192.168.1.2", "127.0.0.1.evil.org", "evil.localhost", ""})
    EXPECT_FALSE(view::is_loopback(there));
}

// `rfmvo view` as it runs, and a client that says what it likes.
class ViewServer : public ::testing::Test {
 protected:
  void start(const std::string& more = "") {
    testing::write_journal(folder_ / "run.lcmlog", testing::short_run(5));
    server_ =
        std::make_unique<Background>(RFMVO_COMMAND " view " + in_quotes(folder_ / "run.lcmlog") + " --port 0 " + more,
                                     folder_ / "out", folder_ / "err");
    ASSERT_TRUE(server_->said("\n")) << server_->err();
    const std::string url = server_->out();
    port_ = std::stoi(url.substr(url.find(':', 7) + 1));
    if (const auto at = url.find("token="); at != std::string::npos)
      token_ = url.substr(at + 6, url.find('\n') - at - 6);
  }
  // The answer's beginning: until the peer closes, or `enough` stands in it.
  std::string ask(const std::string& request, const std::string& enough = "</html>") {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::send(fd, request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
    std::string answer;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 1; n > 0 && answer.find(enough) == std::string::npos;) {
      n = ::recv(fd, buffer.data(), buffer.size(), 0);
      if (n > 0) answer.append(buffer.data(), static_cast<std::size_t>(n));
    }
    ::close(fd);
    return answer;
  }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  std::string page(const std::string& path, const std::string& host_header) {
    return ask("GET " + path + " HTTP/1.1\r\nHost: " + host_header + "\r\nConnection: close\r\n\r\n");
  }
  std::string socket(const std::string& path, const std::string& origin, const std::string& enough) {
    return ask("GET " + path + " HTTP/1.1\r\nHost: " + host() + "\r\nOrigin: " + origin +
                   "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Protocol: rfmvo\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
               enough);
  }
  TemporaryFolder folder_;
  std::unique_ptr<Background> server_;
  std::string token_;
  int port_ = 0;
};

TEST_F(ViewServer, GivesThePageAndTheMessages) {
  start();
  const std::string answer = page("/", host());
  EXPECT_THAT(answer, HasSubstr("200 OK"));
  EXPECT_THAT(answer, HasSubstr("content-security-policy"));
  EXPECT_THAT(answer, HasSubstr(view::kPage));
  EXPECT_THAT(page("/other", host()), HasSubstr("404"));
  const std::string messages = socket("/", "http://" + host(), "\"type\":\"status\"");
  EXPECT_THAT(messages, HasSubstr("101 Switching Protocols"));
  EXPECT_THAT(messages, HasSubstr("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=")) << "RFC 6455, section 1.3";
  EXPECT_THAT(messages, HasSubstr("\"type\":\"status\""));
  EXPECT_EQ(server_->end(SIGTERM), 0) << server_->err();
}

TEST_F(ViewServer, RefusesOtherNamesAndOtherOrigins) {
  start();
  EXPECT_THAT(page("/", "evil.example:" + std::to_string(port_)), HasSubstr("403"));
  EXPECT_THAT(socket("/", "http://evil.example", "\"type\""), Not(HasSubstr("101 ")));
}

TEST_F(ViewServer, BeyondThisMachineNeedsTheToken) {
  start("--listen 0.0.0.0");
  ASSERT_EQ(token_.size(), 32u) << server_->out();
  EXPECT_THAT(page("/", host()), HasSubstr("403"));
  EXPECT_THAT(page("/?token=00000000000000000000000000000000", host()), HasSubstr("403"));
  EXPECT_THAT(socket("/", "http://" + host(), "\"type\""), Not(HasSubstr("101 ")));
  EXPECT_THAT(page("/?token=" + token_, "box.local:80"), HasSubstr("200 OK"));
  EXPECT_THAT(socket("/?token=" + token_, "http://box.local", "\"type\":\"status\""), HasSubstr("101 "));
}

TEST(ViewCommand, BadInputIsOneLine) {
  expect_one_line(testing::rfmvo("view /nowhere/x.lcmlog"), "/nowhere/x.lcmlog: no such file");
  expect_one_line(testing::rfmvo("view --url udpm://1.2.3.4:5"), "not a multicast address");
  expect_one_line(testing::rfmvo("view --url memq:// --listen 203.0.113.1 --port 0"),
                  "203.0.113.1:0: cannot be listened on");
  expect_one_line(testing::rfmvo("view --speed 2"), "--speed", 2);
}

}  // namespace
}  // namespace rfmvo
