// Log lines: one event is one line, whatever names and messages contain, and JSON ones are JSON.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "ops/audit.h"
#include "ops/log.h"
#include "ops/log_lines.h"
#include "ops/log_scope.h"

namespace lpv::ops {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

/// What people, and those who are none, put into names and messages.
const std::vector<std::string> kHostile = {"\"quoted\", \\ and \\\"",
                                           "two\nlines\r\nand a\ttab",
                                           "\"}\n{\"level\":\"info\",\"event\":\"delete\"}",
                                           "invalid UTF-8: \xff\xfe \xc3( \xe2\x82",
                                           std::string("a NUL \0 within", 14),
                                           "\x1b[31mred\x1b[0m \x7f",
                                           "žluťoučký kůň 照明 \xe2\x80\xa8 line separator",
                                           " session=another trace=00",
                                           "%s {} {0} %n"};

class LogLines : public testing::TestWithParam<LogFormat> {
 protected:
  LogLines() { sink_->set_formatter(lineFormatter(GetParam())); }
  void say(const std::string& message) { spdlog::logger("lpvd", sink_).info("{}", message); }
  /// What has been written since the last time.
  std::vector<std::string> lines() {
    std::vector<std::string> out;
    std::string line;
    while (std::getline(text_, line)) out.push_back(line);
    text_.clear();
    text_.str({});
    return out;
  }

  std::stringstream text_;
  std::shared_ptr<spdlog::sinks::ostream_sink_st> sink_ = std::make_shared<spdlog::sinks::ostream_sink_st>(text_);
};
INSTANTIATE_TEST_SUITE_P(Formats, LogLines, testing::Values(LogFormat::kText, LogFormat::kJson));

TEST_P(LogLines, AnEventIsOneLine) {
  startAudit({sink_});
  for (const std::string& hostile : kHostile) {
    const LogScope scope({hostile, hostile, hostile});
    say(hostile);
    EXPECT_EQ(lines().size(), 1U) << hostile;
    audit(hostile, {{"name", hostile}});
    EXPECT_EQ(lines().size(), 1U) << hostile;
  }
}

class JsonLines : public LogLines {
 protected:
  json only() {
    const std::vector<std::string> all = lines();
    EXPECT_EQ(all.size(), 1U);
    return all.empty() ? json() : json::parse(all[0]);
  }
};
INSTANTIATE_TEST_SUITE_P(Json, JsonLines, testing::Values(LogFormat::kJson));

TEST_P(JsonLines, SayWhatWasSaid) {
  for (const std::string& hostile : kHostile) {
    const LogScope scope({hostile, "t", "p"});
    say(hostile);
    const json line = only();
    EXPECT_EQ(line["level"], "info");
    EXPECT_EQ(line["trace"], "t");
    EXPECT_FALSE(line.contains("peer")) << "addresses are the audit log's";
    EXPECT_THAT(line["time"].get<std::string>(),
                testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z"));
    if (hostile.find('\xff') != std::string::npos) {
      EXPECT_THAT(line["message"].get<std::string>(), testing::StartsWith("invalid UTF-8: \xef\xbf\xbd"));
    } else {
      EXPECT_EQ(line["message"], hostile);
      EXPECT_EQ(line["session"], hostile);
    }
  }
}

TEST_P(JsonLines, OfTheAuditLogHaveTheirFields) {
  startAudit({sink_});
  const LogScope scope({"room", "", "ipv4:127.0.0.1:5"});
  audit("share", {{"role", "viewer"}, {"name", "\"a\"\nb"}, {"level", "forged"}});
  const json line = only();
  EXPECT_EQ(line["logger"], "audit");
  EXPECT_EQ(line["event"], "share");
  EXPECT_EQ(line["level"], "info") << "a field cannot take the place of what a line is";
  EXPECT_EQ(line["session"], "room");
  EXPECT_EQ(line["peer"], "ipv4:127.0.0.1:5");
  EXPECT_EQ(line["role"], "viewer");
  EXPECT_EQ(line["name"], "\"a\"\nb");
  EXPECT_FALSE(line.contains("trace")) << "not known";
  audit("delete", {{"session", "another"}});
  EXPECT_EQ(only()["session"], "another") << "what the event says wins";
  say("afterwards");
  EXPECT_FALSE(only().contains("event"));
}

class TextLines : public LogLines {};
INSTANTIATE_TEST_SUITE_P(Text, TextLines, testing::Values(LogFormat::kText));

TEST_P(TextLines, EndInWhomTheyAreAbout) {
  startAudit({sink_});
  {
    const LogScope outer({"room", "4bf9", "ipv4:127.0.0.1:5"});
    say("first");
    {
      const LogScope inner({"hall", "", ""});
      say("second");
    }
    say("third \"quoted\"\nand on");
    audit("import", {{"name", "two words"}, {"empty", ""}});
  }
  say("fourth");
  EXPECT_THAT(
      lines(),
      ElementsAre(EndsWith(" info first session=room trace=4bf9"), EndsWith(" info second session=hall"),
                  EndsWith(" info third \"quoted\"\\nand on session=room trace=4bf9"),
                  EndsWith(" info audit import session=room trace=4bf9 peer=ipv4:127.0.0.1:5 name=\"two words\""),
                  EndsWith(" info fourth")));
}

/// Twenty a second at most, and nothing is forgotten: the lines and what they say was left out add up.
TEST_P(TextLines, OfRefusalsInALoopAreFew) {
  startAudit({sink_});
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  constexpr int kAtOnce = 2000;
  for (int i = 0; i < kAtOnce; ++i) auditRefusal({{"method", "CreateSession"}});
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - begin).count();
  std::vector<std::string> written = lines();
  EXPECT_LE(std::ssize(written), kMostRefusals * (seconds + 2));
  int refusals = kAtOnce;
  while (written.empty() || written.back().find("left_out=") == std::string::npos) {
    ASSERT_LT(Clock::now() - begin, std::chrono::seconds(60));
    auditRefusal({{"method", "CreateSession"}});
    ++refusals;
    for (const std::string& line : lines()) written.push_back(line);
  }
  std::int64_t counted = std::ssize(written);
  for (const std::string& line : written) {
    const std::size_t at = line.find("left_out=");
    if (at != std::string::npos) counted += std::stoll(line.substr(at + 9));
  }
  EXPECT_EQ(counted, refusals);
}

TEST(StartLog, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(startLog("loud", "text").field(), "log-level");
  const Status format = startLog("info", "xml");
  EXPECT_EQ(format.field(), "log-format");
  EXPECT_THAT(format.message(), HasSubstr("json"));
}

}  // namespace
}  // namespace lpv::ops
