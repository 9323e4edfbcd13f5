// Short texts of strangers: trace headers, access tokens, names, and what of them comes into the log.
//
// Seen to find a trace id whose digits are not looked at (isId in ops/trace.cpp).

#include <fuzzer/FuzzedDataProvider.h>
#include <google/protobuf/stubs/logging.h>
#include <spdlog/details/log_msg.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "convert/session.h"
#include "fuzz/check.h"
#include "fuzz/world.h"
#include "ops/log_lines.h"
#include "ops/log_scope.h"
#include "ops/trace.h"
#include "scene/edits.h"

namespace lpv::fuzz {
namespace {

void traces(const std::string& header) {
  const std::string id = ops::traceIdOf(header);
  check(id.empty() || id.size() == 32, "a trace id has 32 digits");
  check(id.find_first_not_of("0123456789abcdef") == std::string::npos, "a trace id is hexadecimal: " + id);
  check(id.empty() || header.find(id) == 3, "a trace id is the header's");
}

constexpr char kAdminToken[] = "an admin's token of this test";

/// Nobody gets in with a token that was not given out.
void tokens(const std::string& text) {
  static Access access(machinery().journal, machinery().timers);
  static const MintedToken minted = [] {
    check(access.require(kAdminToken).ok(), "the admin token is taken");
    return *access.mint("room", Role::kViewer, std::chrono::hours(1));
  }();
  const Expected<Grant> grant = access.verify(text);
  check(grant.ok() == (text == kAdminToken || text == minted.token), "only a token that was given out lets anybody in");
  if (!grant) checkRefusal(grant.status());
  for (const std::string& near : {minted.token + text, minted.token.substr(0, text.size() % minted.token.size())}) {
    check(near == minted.token || !access.verify(near).ok(), "a token is compared whole");
  }
}

/// Of proto3 strings: the door has seen that they are UTF-8.
void names(const std::string& text) {
  if (!isUtf8(text)) return;
  for (const Status& status : {checkName(text), checkGroup("group", text), api::sessionId("name", text).status(),
                               api::sessionId("name", "sessions/" + text).status()}) {
    if (!status.ok()) checkRefusal(status);
  }
}

/// Whatever it is about, an event is one line, and JSON where that is asked for.
void lines(FuzzedDataProvider& in) {
  const ops::LogFormat format = in.ConsumeBool() ? ops::LogFormat::kJson : ops::LogFormat::kText;
  const ops::LogScope scope(
      {in.ConsumeRandomLengthString(40), in.ConsumeRandomLengthString(40), in.ConsumeRandomLengthString(40)});
  const ops::LogFields fields = {{"why", in.ConsumeRandomLengthString(100)}};
  const std::string message = in.ConsumeRemainingBytesAsString();
  const ops::EventScope event(fields);
  spdlog::memory_buf_t buffer;
  ops::lineFormatter(format)->format(spdlog::details::log_msg("lpvd", spdlog::level::info, message), buffer);
  const std::string line = fmt::to_string(buffer);
  check(std::count(line.begin(), line.end(), '\n') == 1 && line.back() == '\n', "an event is one line");
  check(line.find_first_of(std::string("\r\0\x1b", 3)) == std::string::npos, "a line has no control characters");
  if (format != ops::LogFormat::kJson) return;
  const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  check(object.is_object(), "a line of JSON is an object: " + line);
}

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider in(data, size);
  switch (in.ConsumeIntegralInRange(0, 3)) {
    case 0:
      lpv::fuzz::traces(in.ConsumeRemainingBytesAsString());
      break;
    case 1:
      lpv::fuzz::tokens(in.ConsumeRemainingBytesAsString());
      break;
    case 2:
      lpv::fuzz::names(in.ConsumeRemainingBytesAsString());
      break;
    default:
      lpv::fuzz::lines(in);
  }
  return 0;
}
