#include "edges/toml_files.hpp"

#include "config/config_table.hpp"
#include "edges/text_file.hpp"
#include "edges/toml_parts.hpp"

namespace rfmvo {
namespace {

using namespace toml_parts;

// Errors of the table name the key; put the place in the text in front.
Error at_line(const std::string& where, const toml::node& node, const Error& error) {
  return {error.code, error.text(), place(where, node)};
}

Result<ConfigValue> value_of(const toml::node& node) {
  if (const auto* x = node.as_floating_point()) return ConfigValue(x->get());
  if (const auto* x = node.as_integer()) return ConfigValue(x->get());
  if (const auto* x = node.as_boolean()) return ConfigValue(x->get());
  if (const auto* x = node.as_string()) return ConfigValue(x->get());
  return Error{ErrorCode::kMalformed, "expects one value, not a list, table or date", ""};
}

Status set_section(Config& config, std::string_view section, const toml::table& table, const std::string& where) {
  for (const auto& [name, node] : table) {
    const std::string key = std::string(section) + "." + std::string(name.str());
    const auto value = value_of(node);
    const bool known = find_row(key) != nullptr;
    if (!value && known) return at_line(where, node, {value.error().code, value.error().what, key});
    const Status set = set_value(config, key, value ? value.value() : ConfigValue(false));
    if (!set) return at_line(where, node, set.error());
  }
  return Done{};
}

}  // namespace

Result<Config> parse_config(std::string_view toml, const std::string& where, const Config& base) {
  auto document = parse_document(toml, where);
  if (!document) return document.error();
  Config config = base;
  for (const auto& [name, node] : document.value()) {
    const toml::table* table = node.as_table();
    const Status set = table != nullptr ? set_section(config, name.str(), *table, where)
                                        : set_value(config, name.str(), false);  // always an unknown key: no section
    if (!set) return table != nullptr ? set.error() : at_line(where, node, set.error());
  }
  if (const Status consistent = check_consistency(config); !consistent)
    return Error{consistent.error().code, consistent.error().text(), where};
  return config;
}

Result<Config> read_config(const std::string& path, const Config& base) {
  auto text = read_text_file(path);
  if (!text) return text.error();
  return parse_config(text.value(), path, base);
}

std::string to_toml(const Config& config) {
  std::string out;
  std::string_view section;
  for (const ConfigRow& row : config_rows()) {
    const std::size_t dot = row.key.find('.');
    if (row.key.substr(0, dot) != section) {
      section = row.key.substr(0, dot);
      out += (out.empty() ? "[" : "\n[") + std::string(section) + "]\n";
    }
    out += "# " + std::string(row.doc) + (row.unit.empty() ? "" : " [" + std::string(row.unit) + "]") + "\n";
    const ConfigValue value = get_value(config, row);
    out += std::string(row.key.substr(dot + 1)) + " = " + std::visit([](const auto& v) { return text_of(v); }, value) +
           "\n";
  }
  return out;
}

}  // namespace rfmvo
