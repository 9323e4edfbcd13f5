#include "import/obj_text.h"

#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>

#include "import/text_lines.h"

namespace lpv::cli {
namespace {

/// What the index of a face's corner counts, in the order in which a corner gives them.
struct Kind {
  const char* one;
  const char* many;
  std::int64_t count = 0;        ///< so far
  std::int64_t largest = 0;      ///< positive index seen; may point to what comes later
  std::size_t largestLine = 0;
};

/// Inserts the 0 that Assimp 5.2 needs before a decimal point.
void appendNumbers(std::string& out, std::string_view line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool begins =
        i > 0 && (line[i - 1] == ' ' || line[i - 1] == '\t' || line[i - 1] == '-' || line[i - 1] == '+');
    if (line[i] == '.' && begins) out += '0';
    out += line[i];
  }
}

class ObjText {
 public:
  Status add(std::string_view line, std::size_t number) {
    const std::string_view keyword = line.substr(0, line.find_first_of(" \t"));
    const bool numbers = keyword == "v" || keyword == "vn" || keyword == "vt";
    const bool element = keyword == "f" || keyword == "l" || keyword == "p";
    if (numbers || element) line = trimmed(line.substr(0, line.find('#')));
    if (keyword == "v" && countNumbers(wordsOf(line), 1, 3) < 3) return halfVertex(line, number);
    if (keyword == "v") ++kinds_[0].count;
    if (keyword == "vt") ++kinds_[1].count;
    if (keyword == "vn") ++kinds_[2].count;
    if (element) return addElement(line, number);
    appendNumbersOrText(line, numbers);
    return {};
  }

  Expected<std::string> take() {
    for (const Kind& kind : kinds_) {
      if (kind.largest > kind.count) return outOfRange(kind, kind.largest, kind.largestLine);
    }
    if (faces_ == 0) {
      return invalid("file", "the file has no face ('f' line), only " + std::to_string(kinds_[0].count) +
                                 " vertices; export it with faces");
    }
    return std::move(out_);
  }

 private:
  void appendNumbersOrText(std::string_view line, bool numbers) {
    if (numbers) {
      appendNumbers(out_, line);
    } else {
      out_ += line;
    }
    out_ += '\n';
  }

  static Status outOfRange(const Kind& kind, std::int64_t index, std::size_t line) {
    return invalid("file", "line " + std::to_string(line) + ": " + kind.one + " " + std::to_string(index) +
                               " is out of range; the file has " + std::to_string(kind.count) + " " + kind.many +
                               ", which are numbered from 1 or from -1 backwards; export it again");
  }

  Status addElement(std::string_view line, std::size_t number) {
    const std::vector<std::string_view> words = wordsOf(line);
    const bool face = words[0] == "f";
    if (face && words.size() > 3) ++faces_;
    if (!face || words.size() > 3) appendNumbersOrText(line, false);  // a face of less than 3 corners shows nothing
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (Status status = addCorner(words[i], number); !status.ok()) return status;
    }
    return {};
  }

  Status addCorner(std::string_view corner, std::size_t line) {
    std::string_view rest = corner;
    for (std::size_t i = 0; i < kinds_.size() && !rest.empty(); ++i) {
      const std::size_t slash = rest.find('/');
      const std::string_view word = rest.substr(0, slash);
      rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
      if (word.empty() && i > 0) continue;
      std::int64_t index = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
      if (error != std::errc() || end != word.data() + word.size()) return malformed(corner, line);
      if (index == 0 || index < -kinds_[i].count) return outOfRange(kinds_[i], index, line);
      if (index > kinds_[i].largest) {
        kinds_[i].largest = index;
        kinds_[i].largestLine = line;
      }
    }
    return rest.empty() ? Status() : malformed(corner, line);
  }

  static Status halfVertex(std::string_view line, std::size_t number) {
    return invalid("file", "line " + std::to_string(number) + ": the vertex '" + std::string(line.substr(0, 60)) +
                               "' does not have the 3 numbers that it needs; export the file again");
  }

  static Status malformed(std::string_view corner, std::size_t line) {
    return invalid("file", "line " + std::to_string(line) + ": '" + std::string(corner) +
                               "' is no corner of a face; write whole numbers as v, v/vt, v//vn or v/vt/vn");
  }

  std::string out_;
  std::size_t faces_ = 0;
  std::array<Kind, 3> kinds_{
      {{"vertex", "vertices"}, {"texture coordinate", "texture coordinates"}, {"normal", "normals"}}};
};

}  // namespace

Expected<std::string> plainObj(std::string_view text) {
  if (text.substr(0, 2) == "\xff\xfe" || text.substr(0, 2) == "\xfe\xff") {
    return invalid("file", "the file is UTF-16 text; save it as UTF-8");
  }
  ObjText out;
  Lines lines(withoutByteOrderMark(text));
  std::string whole;
  for (std::string_view line; lines.next(line);) {
    const std::size_t number = lines.number();
    whole = trimmed(line);
    while (!whole.empty() && whole.back() == '\\') {
      whole.back() = ' ';
      if (lines.next(line)) whole += trimmed(line);
    }
    if (Status status = out.add(trimmed(whole), number); !status.ok()) return status;
  }
  return out.take();
}

std::string plainMtl(std::string_view text) {
  std::string out;
  Lines lines(withoutByteOrderMark(text));
  for (std::string_view line; lines.next(line); out += '\n') out += trimmed(line);
  return out;
}

}  // namespace lpv::cli
