#pragma once
// What a stage made, and what it made it from: a stage runs where its inputs differ from those.

#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

namespace lpv {

/// One making of something. A stage's inputs name what other stages made by its stamp, so that comparing them takes as
/// long as there are lights, not cells. 0: not made.
using Stamp = std::uint64_t;

/// Another one each time in this process: stamps of different things differ, too.
inline Stamp nextStamp() {
  static std::atomic<Stamp> last{0};
  return ++last;
}

/// A product with the inputs that it was made from; without `Product`, what is known of memory that is kept elsewhere.
/// `Inputs` is a plain struct with a defaulted ==.
template <typename Inputs, typename Product = std::monostate>
class Cached {
 public:
  bool madeFrom(const Inputs& inputs) const { return inputs_ && *inputs_ == inputs; }

  /// The same; a product of other inputs is let go of. A stage asks before it runs: where it is abandoned half-way,
  /// nothing counts as made.
  bool holds(const Inputs& inputs) {
    if (madeFrom(inputs)) return true;
    forget();
    return false;
  }

  /// The stage has run.
  void set(Inputs inputs, Product product = {}) {
    inputs_ = std::move(inputs);
    product_ = std::move(product);
    stamp_ = nextStamp();
  }

  void forget() {
    inputs_.reset();
    product_ = {};
    stamp_ = 0;
  }

  Product& product() { return product_; }
  const Product& product() const { return product_; }
  Stamp stamp() const { return stamp_; }

 private:
  std::optional<Inputs> inputs_;
  Product product_{};
  Stamp stamp_ = 0;
};

}  // namespace lpv
