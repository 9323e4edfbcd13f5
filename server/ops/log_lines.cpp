#include "ops/log_lines.h"

#include <spdlog/details/log_msg.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string_view>

#include "ops/log_scope.h"

namespace lpv::ops {
namespace {

using Json = nlohmann::ordered_json;

/// Fields of the audit event that this thread is writing; null: none.
const LogFields*& eventFields() {
  thread_local const LogFields* fields = nullptr;
  return fields;
}

std::string_view view(spdlog::string_view_t text) { return {text.data(), text.size()}; }

/// Replaces bytes that are not UTF-8 with U+FFFD.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string timeOf(spdlog::log_clock::time_point when, bool utc) {
  const std::time_t seconds = spdlog::log_clock::to_time_t(when);
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(when.time_since_epoch()).count() % 1000;
  std::tm parts{};
  if (utc) {
    gmtime_r(&seconds, &parts);
  } else {
    localtime_r(&seconds, &parts);
  }
  std::array<char, 32> day{};
  const std::size_t length = std::strftime(day.data(), day.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::array<char, 8> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%03d", int(milliseconds));
  return std::string(day.data(), length) + fraction.data() + (utc ? "Z" : "");
}

/// All fields of a line: the context, then an event's fields, which replace fields of the context with the same name.
LogFields knownFields() {
  const LogContext& context = LogScope::now();
  LogFields out;
  const auto add = [&out](const std::string& name, const std::string& value) {
    if (value.empty()) return;
    for (auto& [known, old] : out) {
      if (known == name) {
        old = value;
        return;
      }
    }
    out.emplace_back(name, value);
  };
  add("session", context.session);
  add("trace", context.trace);
  if (const LogFields* fields = eventFields()) {
    add("peer", context.peer);
    for (const auto& [name, value] : *fields) add(name, value);
  }
  return out;
}

/// A value as it is if it has only unambiguous characters, else quoted as in JSON.
std::string quoted(const std::string& value) {
  static constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._:/+-%[]@,";
  return value.find_first_not_of(kPlain) == std::string::npos ? value : dumped(value);
}

/// Escapes control characters as in JSON; other characters, quotes included, are copied.
std::string oneLine(std::string_view message) {
  std::string out;
  for (const char c : message) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F) {
      out += c;
    } else {
      const std::string escaped = dumped(std::string(1, c));
      out += byte == 0x7F ? "\\u007f" : escaped.substr(1, escaped.size() - 2);
    }
  }
  return out;
}

class Lines final : public spdlog::formatter {
 public:
  explicit Lines(LogFormat format) : format_(format) {}

  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    const auto append = [&out](std::string_view text) { out.append(text.data(), text.data() + text.size()); };
    if (format_ == LogFormat::kJson) {
      append(json(message));
      append("\n");
      return;
    }
    append(timeOf(message.time, false) + " ");
    message.color_range_start = out.size();
    append(view(spdlog::level::to_string_view(message.level)));
    message.color_range_end = out.size();
    append((eventFields() ? " audit " : " ") + oneLine(view(message.payload)));
    for (const auto& [name, value] : knownFields()) append(" " + name + "=" + quoted(value));
    append("\n");
  }

  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<Lines>(format_); }

 private:
  static std::string json(const spdlog::details::log_msg& message) {
    Json line;
    line["time"] = timeOf(message.time, true);
    line["level"] = view(spdlog::level::to_string_view(message.level));
    if (eventFields()) line["logger"] = "audit";
    line[eventFields() ? "event" : "message"] = view(message.payload);
    for (const auto& [name, value] : knownFields()) {
      if (!line.contains(name)) line[name] = value;
    }
    return dumped(line);
  }

  LogFormat format_;
};

}  // namespace

std::unique_ptr<spdlog::formatter> lineFormatter(LogFormat format) { return std::make_unique<Lines>(format); }

EventScope::EventScope(const LogFields& fields) { eventFields() = &fields; }

EventScope::~EventScope() { eventFields() = nullptr; }

}  // namespace lpv::ops
