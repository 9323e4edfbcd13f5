#include "ops/trace.h"

#include <algorithm>
#include <cstddef>

namespace lpv::ops {
namespace {

// version "-" trace-id "-" parent-id "-" flags
constexpr std::size_t kTraceAt = 3;
constexpr std::size_t kTraceDigits = 32;
constexpr std::size_t kParentAt = 36;
constexpr std::size_t kParentDigits = 16;
constexpr std::size_t kFlagsAt = 53;
constexpr std::size_t kLength = 55;

bool isHex(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool isId(std::string_view text) { return isHex(text) && text.find_first_not_of('0') != std::string_view::npos; }

}  // namespace

std::string traceIdOf(std::string_view traceparent) {
  if (traceparent.size() < kLength) return {};
  const std::string_view version = traceparent.substr(0, 2);
  if (!isHex(version) || version == "ff") return {};
  // Later versions may add fields after the flags.
  if (traceparent.size() > kLength && (version == "00" || traceparent[kLength] != '-')) return {};
  for (const std::size_t dash : {kTraceAt - 1, kParentAt - 1, kFlagsAt - 1}) {
    if (traceparent[dash] != '-') return {};
  }
  const std::string_view trace = traceparent.substr(kTraceAt, kTraceDigits);
  if (!isId(trace) || !isId(traceparent.substr(kParentAt, kParentDigits)) || !isHex(traceparent.substr(kFlagsAt, 2)))
    return {};
  return std::string(trace);
}

}  // namespace lpv::ops
