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

std::string hiddenIn(const std::string& text) {
  const auto found = findHiddenCharacter(text);
  return found ? found->name() + "@" + std::to_string(found->at) : "none";
}

// Each list of ranges was seen to be needed: with one left out, its line is "none".
TEST(Hidden, AreCharactersThatPeopleDoNotSee) {
  EXPECT_EQ(hiddenIn("a\x1b[2J"), "U+001B@1");
  EXPECT_EQ(hiddenIn("\x7f"), "U+007F@0");
  EXPECT_EQ(hiddenIn("\u0085"), "U+0085@0");
  EXPECT_EQ(hiddenIn("soft\u00adhyphen"), "U+00AD@4");
  EXPECT_EQ(hiddenIn("lamp\u202egnp"), "U+202E@4");
  EXPECT_EQ(hiddenIn("\u2066x"), "U+2066@0");
  EXPECT_EQ(hiddenIn("\u200fx"), "U+200F@0");
  EXPECT_EQ(hiddenIn("x\u200b"), "U+200B@1");
  EXPECT_EQ(hiddenIn("x\u2028y"), "U+2028@1");
  EXPECT_EQ(hiddenIn("\ufeffx"), "U+FEFF@0");
  EXPECT_EQ(hiddenIn("x\u3164"), "U+3164@1");
  EXPECT_EQ(hiddenIn("x\U000E0041"), "U+E0041@1");
  EXPECT_EQ(hiddenIn("lamp\u200d"), "U+200D@4") << "a joiner after a letter makes two names look the same";
  for (const char* broken : {"\xff", "\xc0\xaf", "\xed\xa0\x80", "\xe2\x82"})
    EXPECT_EQ(hiddenIn(broken).substr(0, 2), "U+") << broken;
}

TEST(Hidden, AreNotLettersSymbolsAndWhatEmojiAreMadeOf) {
  for (const char* shown : {"Lamp 1", "L\u00e4mpchen", "\u706f", "\u0644\u0645\u0628\u0629", "\U0001F4A1",
                            "\u2600\ufe0f", "\U0001F468\u200d\U0001F680", "\u2764\ufe0f\u200d\U0001F525"})
    EXPECT_EQ(hiddenIn(shown), "none") << shown;
}

TEST(Hidden, AreEscapedAsJsonReadsThem) {
  EXPECT_EQ(withHiddenEscaped("a\u202eb\x1b\n\t", "\t"), "a\\u202eb\\u001b\\u000a\t");
  EXPECT_EQ(withHiddenEscaped("\U000E0041"), "\\udb40\\udc41");
  EXPECT_EQ(withHiddenEscaped("\xffok"), "\\ufffdok");
  EXPECT_EQ(withHiddenEscaped("plain"), "plain");
}

}  // namespace
}  // namespace lpv
