#pragma once
// Coefficients as bytes: for each plane how many zeros stand before the next value, and the values, kept apart so that
// each has statistics of its own when the whole is compressed.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::wire {

/// The two kinds of bytes of one or many (brick, layer) blocks.
struct RunLevels {
  std::string runs;
  std::string levels;

  std::size_t bytes() const { return runs.size() + levels.size(); }
};

/// Bytes of one block at most.
inline constexpr std::size_t kMaxBlockBytes = 1 + 12 * (512 + 1) + 12 * 512 * 4;

/// Appends one block of 12 x 512 coefficients, magnitudes below 2^24. Returns false where all are zero; the block is
/// appended all the same.
bool appendBlock(const std::int32_t* coefficients, RunLevels* out);

/// Reads blocks one after another.
class TokenReader {
 public:
  TokenReader(std::string_view runs, std::string_view levels) : runs_(runs), levels_(levels) {}

  /// Adds one block's values to `coefficients`. INVALID_ARGUMENT where bytes are missing, a value stands outside its
  /// plane, or a sum is beyond kMaxCoefficient.
  Status addBlock(std::int32_t* coefficients);
  /// Nothing is left over.
  bool atEnd() const { return runs_.empty() && levels_.empty(); }

 private:
  bool takeRun(int* run);
  bool takeLevel(std::int32_t* level);
  Status addPlane(int shift, std::int32_t* plane);

  std::string_view runs_;
  std::string_view levels_;
};

}  // namespace lpv::wire
