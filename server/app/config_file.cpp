#include "app/config_file.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>

#include "base/text.h"

namespace lpv::app {
namespace {

constexpr std::string_view kSpace = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

bool endsHere(std::string_view rest) { return trimmed(rest).empty() || trimmed(rest).front() == '#'; }

bool isPlain(const std::string& value) {
  if (value == "true" || value == "false") return true;
  double number = 0.0;
  const char* const end = value.data() + value.size();
  const auto [rest, error] = std::from_chars(value.data(), end, number);
  return error == std::errc() && rest == end;
}

/// What stands between quotes at the front of `text`; nothing where it does not end, or has an escape but \" and \\.
std::optional<std::string> quotedText(std::string_view text) {
  const char quote = text.front();
  std::string out;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == quote) return endsHere(text.substr(i + 1)) ? std::optional(out) : std::nullopt;
    if (text[i] == '\\' && quote == '"') {
      if (++i == text.size() || (text[i] != '"' && text[i] != '\\')) return std::nullopt;
    }
    out += text[i];
  }
  return std::nullopt;
}

std::optional<std::string> valueOf(std::string_view text) {
  if (text.empty()) return std::nullopt;
  if (text.front() == '"' || text.front() == '\'') return quotedText(text);
  std::string plain(trimmed(text.substr(0, text.find('#'))));
  return isPlain(plain) ? std::optional(plain) : std::nullopt;
}

bool isName(std::string_view name) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && std::all_of(name.begin(), name.end(), allowed);
}

Status wrong(const std::string& where, const std::string& what) { return invalid("config", where + ": " + what); }

Expected<ConfigEntry> entryOf(std::string_view line, const std::string& where) {
  if (line.front() == '[') return wrong(where, "sections are not taken; write NAME = VALUE without them");
  const std::size_t equals = line.find('=');
  const std::string_view name = trimmed(line.substr(0, equals));
  if (equals == std::string_view::npos || !isName(name)) {
    return wrong(where, "\"" + truncatedUtf8(std::string(line)) + "\" is not of the form NAME = VALUE");
  }
  const std::optional<std::string> value = valueOf(trimmed(line.substr(equals + 1)));
  if (!value) {
    return wrong(where, "the value of " + std::string(name) +
                            " cannot be read: give a number, true, false, or text in quotes, and nothing behind it");
  }
  return ConfigEntry{withDashes(std::string(name)), *value, where};
}

}  // namespace

std::string withDashes(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

Expected<std::vector<ConfigEntry>> readConfigFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) return invalid("config", "--config " + path + ": cannot be read");
  std::vector<ConfigEntry> out;
  std::set<std::string> seen;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string where = path + ":" + std::to_string(++number);
    if (endsHere(line)) continue;
    Expected<ConfigEntry> entry = entryOf(trimmed(line), where);
    if (!entry) return entry.status();
    if (!seen.insert(entry->name).second) return wrong(where, entry->name + " is given for the second time");
    out.push_back(std::move(*entry));
  }
  if (file.bad()) return invalid("config", "--config " + path + ": cannot be read");
  return out;
}

std::string configLine(const std::string& name, const std::string& value) {
  if (isPlain(value)) return name + "=" + value;
  std::string quoted = "\"";
  for (const char c : value) quoted += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return name + "=" + quoted + "\"";
}

}  // namespace lpv::app
