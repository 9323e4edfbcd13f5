#pragma once
// Run-level coding of COMPACT's coefficients (COMPACT.md 5): per channel the number of zeros before each value, and the
// values. Runs and values are separate byte strings because each compresses better alone.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::wire {

/// One or more blocks, run-level coded. A block is one brick of one layer.
struct RunLevels {
  std::string runs;  ///< per block the shift, then per channel the zeros before each value
  std::string levels;  ///< the values shifted right, zigzag varints

  std::size_t bytes() const { return runs.size() + levels.size(); }
};

/// Upper bound of a coded block's size, bytes.
inline constexpr std::size_t kMaxBlockBytes = 1 + 12 * (512 + 1) + 12 * 512 * 4;

/// Appends one block of 12 x 512 coefficients, magnitudes below 2^24. Returns false where all are zero; the block is
/// appended all the same.
bool appendBlock(const std::int32_t* coefficients, RunLevels* out);

/// Reads blocks in the order in which they were appended.
class RunLevelReader {
 public:
  RunLevelReader(std::string_view runs, std::string_view levels) : runs_(runs), levels_(levels) {}

  /// Adds the next block's values to `coefficients` (12 x 512). INVALID_ARGUMENT if bytes are missing, a value lies
  /// beyond the end of its channel, or a sum exceeds kMaxCoefficient.
  Status addBlock(std::int32_t* coefficients);
  /// True when all bytes have been read.
  bool atEnd() const { return runs_.empty() && levels_.empty(); }

 private:
  bool takeRun(int* run);
  bool takeLevel(std::int32_t* level);
  Status addChannel(int shift, std::int32_t* channel);

  std::string_view runs_;
  std::string_view levels_;
};

}  // namespace lpv::wire
