// Texts of strangers in messages.

#include "base/text.h"

#include <gtest/gtest.h>

namespace lpv {
namespace {

TEST(Shortened, TextsAreWholeWhereTheyFit) {
  EXPECT_EQ(truncatedUtf8(""), "");
  EXPECT_EQ(truncatedUtf8(std::string(80, 'x')), std::string(80, 'x'));
  EXPECT_EQ(truncatedUtf8(std::string(81, 'x')), std::string(80, 'x'));
}

// Seen to fail when the text is cut after so many bytes: half a character is no UTF-8, and proto3 clients refuse the
// whole message.
TEST(Shortened, NoCharacterIsCut) {
  const std::string umlauts = "x\u00e4\u00f6\u00fc";  // 1 + 3 * 2 bytes
  EXPECT_EQ(truncatedUtf8(umlauts, 7), umlauts);
  EXPECT_EQ(truncatedUtf8(umlauts, 6), "x\u00e4\u00f6");
  EXPECT_EQ(truncatedUtf8(umlauts, 5), "x\u00e4\u00f6");
  EXPECT_EQ(truncatedUtf8(umlauts, 1), "x");
  EXPECT_EQ(truncatedUtf8("\U0001F4A1 lamp", 3), "");
  EXPECT_EQ(truncatedUtf8("\U0001F4A1 lamp", 4), "\U0001F4A1");
}

}  // namespace
}  // namespace lpv
