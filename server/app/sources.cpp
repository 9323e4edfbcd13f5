#include "app/sources.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string_view>

namespace lpv::app {
namespace {

constexpr std::string_view kPrefix = "LPVD_";
constexpr const char* kConfig = "config";

/// "--max_sessions=7" is "max-sessions"; empty for what is no flag.
std::string nameOf(const std::string& argument) {
  if (!argument.starts_with("--") || argument.size() == 2) return {};
  return withDashes(argument.substr(2, argument.find('=') - 2));
}

std::vector<std::string> flagsOf(int argc, char** argv) {
  std::vector<std::string> out;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string name = nameOf(argument);
    const std::size_t equals = argument.find('=');
    out.push_back(name.empty() ? argument : "--" + name + (equals == std::string::npos ? "" : argument.substr(equals)));
  }
  return out;
}

/// The value of a flag on the command line; empty where it is not there.
std::string valueOf(const std::vector<std::string>& flags, const std::string& name) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (nameOf(flags[i]) != name) continue;
    if (const std::size_t equals = flags[i].find('='); equals != std::string::npos) return flags[i].substr(equals + 1);
    return i + 1 < flags.size() ? flags[i + 1] : std::string();
  }
  return {};
}

std::string optionOf(std::string_view variable) {
  std::string name(variable.substr(kPrefix.size()));
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return withDashes(name);
}

/// LPVD_* by the name of what they would set.
std::map<std::string, ConfigEntry> variables() {
  std::map<std::string, ConfigEntry> out;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view text = *each;
    const std::size_t equals = text.find('=');
    if (!text.starts_with(kPrefix) || equals == std::string_view::npos) continue;
    const std::string variable(text.substr(0, equals));
    out[optionOf(variable)] = {optionOf(variable), std::string(text.substr(equals + 1)), variable};
  }
  return out;
}

Status unknown(const ConfigEntry& entry) {
  return invalid("config", entry.where + ": there is no option \"" + entry.name + "\"; lpvd --help lists them");
}

}  // namespace

std::vector<std::string> Sources::arguments() const {
  std::vector<std::string> out;
  for (const ConfigEntry& entry : entries) out.push_back("--" + entry.name + "=" + entry.value);
  out.insert(out.end(), flags.begin(), flags.end());
  return out;
}

std::string Sources::placeOf(const std::string& name) const {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const ConfigEntry& entry) { return entry.name == name; });
  return found == entries.end() ? std::string() : found->where;
}

Expected<Sources> gatherSources(int argc, char** argv, const std::function<bool(const std::string&)>& known) {
  Sources out;
  out.flags = flagsOf(argc, argv);
  std::set<std::string> given;
  for (const std::string& flag : out.flags) given.insert(nameOf(flag));
  std::string file = valueOf(out.flags, kConfig);
  for (auto& [name, entry] : variables()) {
    if (name == kConfig && !given.contains(kConfig)) file = entry.value;
    if (name != kConfig && !known(name)) out.ignored += (out.ignored.empty() ? "" : ", ") + entry.where;
    if (known(name) && !entry.value.empty() && given.insert(name).second) out.entries.push_back(std::move(entry));
  }
  if (file.empty()) return out;
  Expected<std::vector<ConfigEntry>> lines = readConfigFile(file);
  if (!lines) return lines.status();
  for (ConfigEntry& entry : *lines) {
    if (!known(entry.name)) return unknown(entry);
    if (!entry.value.empty() && given.insert(entry.name).second) out.entries.push_back(std::move(entry));
  }
  return out;
}

std::string variableOf(const std::string& name) {
  std::string out = std::string(kPrefix) + name;
  for (char& c : out) c = c == '-' ? '_' : char(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace lpv::app
