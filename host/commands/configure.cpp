#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "commands/commands.hpp"
#include "config/config.hpp"
#include "edges/box/config_client.hpp"

namespace rfmvo {
namespace {

struct Options {
  std::string url = LcmConfig{}.url, prefix = LcmConfig{}.prefix;
  std::string key_file, key, value;
};

void print(const Setting& setting) {
  fmt::print("{} = {}{}{}\n", setting.key, setting.value, setting.unit.empty() ? "" : " ", setting.unit);
}

Status list(ConfigClient& box, const Options&) {
  const auto settings = box.list();
  if (!settings) return settings.error();
  for (const Setting& setting : settings.value()) print(setting);
  return Done{};
}

Status get(ConfigClient& box, const Options& options) {
  const auto setting = box.get(options.key);
  if (!setting) return setting.error();
  print(setting.value());
  fmt::print("# {}{}\n", setting.value().doc, setting.value().live ? "; changes take effect at once" : "");
  return Done{};
}

Status set(ConfigClient& box, const Options& options) {
  const auto seal = read_key(options.key_file);
  if (!seal) return seal.error();
  const auto setting = box.set(seal.value(), options.key, options.value);
  if (!setting) return setting.error();
  print(setting.value());
  return Done{};
}

}  // namespace

void add_configure_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("configure", "Read and change the settings of a running box, over LCM");
  command->add_option("--url", options->url, "LCM url of the box")->capture_default_str();
  command->add_option("--prefix", options->prefix, "Prefix of the LCM channels")->capture_default_str();
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* doc, Status (*run)(ConfigClient&, const Options&)) {
    CLI::App* verb = command->add_subcommand(name, doc);
    verb->callback([options, &exit_code, run] {
      auto box = ConfigClient::open(options->url, options->prefix);
      const Status status = box ? run(*box.value(), *options) : Status(box.error());
      if (status) return;
      fmt::print(stderr, "rfmvo configure: {}\n", status.error().text());
      exit_code = 1;
    });
    return verb;
  };
  add("list", "All settings", list);
  CLI::App* getting = add("get", "One setting, with its meaning", get);
  getting->add_option("key", options->key, "section.name")->required();
  CLI::App* setting = add("set", "Change one setting; what the box has read back is printed", set);
  setting->add_option("key", options->key, "section.name")->required();
  setting->add_option("value", options->value, "Its new value")->required();
  setting->add_option("--key-file", options->key_file, "The key that the box has, too (daemon.key_file)")->required();
}

}  // namespace rfmvo
