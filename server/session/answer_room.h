#pragma once
// Memory that answers in progress hold: pixels and volumes on their way to a reader, and what is encoded and not yet
// taken. An answer takes its room before anything of it is made, gives back what it turns out not to need, and the rest
// when its last part is taken or its reader has gone.

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "base/mutex.h"
#include "base/status.h"
#include "session/limits.h"

namespace lpv {

class AnswerRoom;

/// What one answer holds; given back when it goes. Thread-safe. May outlive the room's owner, not the room's books.
class AnswerHold {
 public:
  ~AnswerHold() { shrinkTo(0); }
  AnswerHold(const AnswerHold&) = delete;
  AnswerHold& operator=(const AnswerHold&) = delete;

  /// The answer holds no more than that from now on.
  void shrinkTo(std::int64_t bytes);

 private:
  friend class AnswerRoom;
  struct Books;
  AnswerHold(std::shared_ptr<Books> books, std::string session, std::int64_t bytes)
      : books_(std::move(books)), session_(std::move(session)), bytes_(bytes) {}

  const std::shared_ptr<Books> books_;
  const std::string session_;
  std::int64_t bytes_;  ///< guarded by the books' mutex
};
using AnswerHoldPtr = std::shared_ptr<AnswerHold>;

/// The room of one server. Thread-safe; acquires no other lock.
class AnswerRoom {
 public:
  AnswerRoom();

  /// Room for an answer of `session` that holds at most `bytes`. RESOURCE_EXHAUSTED, max_answer_bytes or
  /// max_answer_bytes_per_session, with a pause to retry after, or without one where it can never be made. What is
  /// larger than a session's share by itself is made while the session has no other answer.
  Expected<AnswerHoldPtr> take(const std::string& session, std::int64_t bytes, const Limits& limits);

  /// Bytes held now, and the most that ever were.
  std::int64_t held() const;
  std::int64_t peak() const;

 private:
  std::shared_ptr<AnswerHold::Books> books_;
};

}  // namespace lpv
