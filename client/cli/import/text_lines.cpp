#include "import/text_lines.h"

#include <algorithm>

namespace lpv::cli {

std::string_view withoutByteOrderMark(std::string_view text) {
  return text.substr(0, 3) == "\xef\xbb\xbf" ? text.substr(3) : text;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t\r\n", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r\n", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool looksLikeNumber(std::string_view word) {
  if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.remove_prefix(1);
  const std::string_view begin = word.substr(0, 3);
  for (const char* special : {"nan", "NaN", "NAN", "inf", "Inf", "INF"}) {
    if (begin == special) return true;
  }
  return word.find_first_not_of("0123456789.,eE+-") == std::string_view::npos &&
         word.find_first_of("0123456789") != std::string_view::npos;
}

std::size_t countNumbers(const std::vector<std::string_view>& words, std::size_t first, std::size_t most) {
  std::size_t count = 0;
  while (count < most && first + count < words.size() && looksLikeNumber(words[first + count])) ++count;
  return count;
}

bool Lines::next(std::string_view& line) {
  if (at_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  line = text_.substr(at_, end - at_);
  at_ = end + (text_.substr(end, 2) == "\r\n" ? 2 : 1);
  at_ = std::min(at_, text_.size());
  ++number_;
  return true;
}

}  // namespace lpv::cli
