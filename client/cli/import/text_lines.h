#pragma once
// Lines and words of text files.

#include <cstddef>
#include <string_view>
#include <vector>

namespace lpv::cli {

std::string_view withoutByteOrderMark(std::string_view text);

/// Without spaces, tabs and line ends at both sides.
std::string_view trimmed(std::string_view text);

/// The words between spaces and tabs.
std::vector<std::string_view> wordsOf(std::string_view line);

/// Whether a word is written as a number, decimal comma and nan included.
bool looksLikeNumber(std::string_view word);

/// Number of leading words from `first` on that look like numbers, at most `most`.
std::size_t countNumbers(const std::vector<std::string_view>& words, std::size_t first, std::size_t most);

/// Takes lines off a text: they end with \n, \r\n or \r.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}
  /// False at the end of the text.
  bool next(std::string_view& line);
  std::size_t number() const { return number_; }  ///< of the last line taken, from 1
  std::size_t position() const { return at_; }    ///< in the text, after that line

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
};

}  // namespace lpv::cli
