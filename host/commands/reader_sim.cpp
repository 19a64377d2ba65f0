// rfmvo reader-sim: a simulated LLRP reader on a TCP port, driven by the physics of `rfmvo simulate`.
#include <cmath>
#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "commands/simulation_options.hpp"
#include "commands/whole_file.hpp"
#include "edges/stop_signal.hpp"
#include "reader_sim/reader_server.hpp"
#include "simulate/radio_run.hpp"
#include "simulate/reader.hpp"

namespace rfmvo {
namespace {

struct Arguments {
  simulate::Options scene;
  reader_sim::ServerSettings server;
  reader_sim::Troubles troubles;
  double chunk_gap_s = 0.0;
  double start_at_s = 0.0;  // since 1970; 0: when reading starts
  bool loop = false;
  std::string truth;
};

Result<reader_sim::ReaderModel> model_of(const Arguments& arguments) {
  auto scene = simulate::make_scene(arguments.scene);
  if (!scene) return scene.error();
  reader_sim::ReaderModel model;
  const simulate::ChannelPlan channels(arguments.scene.seed);
  for (const double hz : channels.hops_hz())
    model.channels_khz.push_back(static_cast<std::uint32_t>(std::lround(hz / 1e3)));
  const Duration begin = Duration::from_seconds(scene.value().start_s());
  model.reads = simulate::make_reads(scene.value(), arguments.scene, DeviceTime{} - begin);
  model.loop = arguments.loop;
  model.troubles = arguments.troubles;
  if (arguments.start_at_s > 0.0) model.start = DeviceTime{Duration::from_seconds(arguments.start_at_s).ns};
  return model;
}

// As reported: the wire's own counts and the reader's own clock.
Status write_truth(const std::string& path, const std::vector<TagRead>& reads) {
  if (path.empty()) return Done{};
  std::string text = "epc,port,phase_q16,frequency_hz,rssi_cdbm,doppler_hz_q4,seen_count,reader_us\n";
  for (const TagRead& r : reads)
    text += r.epc.hex() + "," + std::to_string(r.port) + "," + std::to_string(r.phase.turn_q16) + "," +
            std::to_string(r.frequency_hz) + "," + std::to_string(r.rssi_cdbm) + "," + std::to_string(r.doppler_hz_q4) +
            "," + std::to_string(r.seen_count) + "," + std::to_string(r.reader_time.us()) + "\n";
  return write_whole_file(path, text);
}

// Until a signal comes.
Status serve(const Arguments& arguments) {
  auto model = model_of(arguments);
  if (!model) return model.error();
  const std::size_t reads = model.value().reads.size();
  auto made = reader_sim::ReaderServer::create(arguments.server, std::move(model).value(), device_clock());
  if (!made) return made.error();
  reader_sim::ReaderServer& server = *made.value();
  catch_stop_signals();
  std::printf("reader on %s port %u, %zu reads\n", arguments.server.host.c_str(), server.port(), reads);
  std::fflush(stdout);
  while (!stop_requested()) server.poll(Duration{100'000'000});
  return write_truth(arguments.truth, server.reader().reported());
}

void add_trouble_options(CLI::App& command, Arguments& a) {
  reader_sim::Troubles& t = a.troubles;
  reader_sim::Delivery& d = a.server.delivery;
  command.add_flag("--year-2000", t.year_2000, "The reader's clock was never set");
  command.add_flag("--uptime-only", t.uptime_only, "The reader has no clock but its uptime");
  command.add_option("--accumulate", t.accumulate, "Singulations of a tag in one report")->check(CLI::Range(1, 1000));
  command.add_flag("--omit-unchanged", t.omit_unchanged, "Parameters as in the report before are left out");
  command.add_flag("--long-epc", t.long_epc, "EPCs of 128 bits");
  command.add_flag("--no-keepalives", t.no_keepalives, "Keepalives are never sent");
  command.add_flag("--no-phase", t.no_phase, "The reader refuses extensions");
  command.add_option("--silent-after-s", t.silent_after_s, "Not a byte from then on");
  command.add_option("--overflow-after-s", t.overflow_after_s, "The report buffer overflows");
  command.add_option("--antenna-lost-after-s", t.antenna_lost_after_s, "Antenna 1 is disconnected");
  command.add_option("--chunk-bytes", d.chunk_bytes, "Send this many bytes at a time, cutting frames anywhere");
  command.add_option("--chunk-gap-s", a.chunk_gap_s, "Wait between two such chunks")->check(CLI::Range(0.0, 60.0));
  command.add_option("--reset-after-bytes", d.reset_after_bytes, "RST after so many bytes, be it in mid-frame; once");
}

}  // namespace

void add_reader_sim_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("reader-sim", "Be an LLRP reader that reads the tags of a simulated scene");
  add_simulation_options(*command, arguments->scene);
  command->add_option("--seed", arguments->scene.seed, "Same seed, same reads")->capture_default_str();
  command->add_option("--host", arguments->server.host, "Address to listen on")->capture_default_str();
  command->add_option("--port", arguments->server.port, "TCP port; 0: any free one")->capture_default_str();
  auto* certificate = command->add_option("--tls-cert", arguments->server.tls_certificate, "TLS: certificate (PEM)");
  auto* key = command->add_option("--tls-key", arguments->server.tls_key, "TLS: private key (PEM)");
  certificate->needs(key);
  key->needs(certificate);
  command->add_option("--start-at", arguments->start_at_s,
                      "When the scene starts, seconds since 1970; default: when reading starts");
  command->add_flag("--loop", arguments->loop, "Begin the scene again at its end");
  command->add_option("--truth", arguments->truth, "At the end, write what was reported to this file (CSV)");
  add_trouble_options(*command, *arguments);
  command->callback([arguments, &exit_code] {
    arguments->server.delivery.chunk_gap = Duration::from_seconds(arguments->chunk_gap_s);
    const Status status = serve(*arguments);
    if (!status.ok()) std::fprintf(stderr, "rfmvo reader-sim: %s\n", status.error().text().c_str());
    exit_code = status.ok() ? 0 : 1;
  });
}

}  // namespace rfmvo
