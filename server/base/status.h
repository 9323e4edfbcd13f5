#pragma once
// Errors as values. The codes are gRPC's canonical ones, so that a door maps them without a table of opinions,
// but no layer below the doors knows gRPC.

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "base/reason.h"

namespace lpv {

/// Canonical error codes; the numbers equal google.rpc.Code.
enum class Code {
  kOk = 0,
  kCancelled = 1,
  kInvalidArgument = 3,
  kDeadlineExceeded = 4,
  kNotFound = 5,
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,
  kFailedPrecondition = 9,
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,
  kInternal = 13,
  kUnavailable = 14,
  kDataLoss = 15,
  kUnauthenticated = 16,
};

/// The result of something that can fail: a code, a reason for programs (kNone where the code says all), and a sentence
/// for people that names the field, the value given, the limit and the way out. `field` is the proto path of the
/// offending field ("light.radiance"), empty where there is none.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Code code, std::string message, std::string field = {})
      : Status(code, Reason::kNone, std::move(message), std::move(field)) {}
  Status(Code code, Reason reason, std::string message, std::string field = {})
      : code_(code), reason_(reason), message_(std::move(message)), field_(std::move(field)) {}

  bool ok() const { return code_ == Code::kOk; }
  Code code() const { return code_; }
  Reason reason() const { return reason_; }
  const std::string& message() const { return message_; }
  const std::string& field() const { return field_; }
  /// After which pause repeating may help; 0 where that is not known.
  std::chrono::milliseconds retryAfter() const { return retryAfter_; }

  /// The same error, which may be gone after a pause.
  Status retriedAfter(std::chrono::milliseconds pause) const {
    Status out = *this;
    out.retryAfter_ = pause;
    return out;
  }
  /// The same error seen from an enclosing message: "radiance" within "light" becomes "light.radiance".
  Status within(const std::string& parent) const {
    if (ok()) return *this;
    return Status(code_, reason_, message_, field_.empty() ? parent : parent + "." + field_).retriedAfter(retryAfter_);
  }

 private:
  Code code_ = Code::kOk;
  Reason reason_ = Reason::kNone;
  std::string message_;
  std::string field_;
  std::chrono::milliseconds retryAfter_{0};
};

/// INVALID_ARGUMENT at `field`.
inline Status invalid(std::string field, std::string message) {
  return Status(Code::kInvalidArgument, std::move(message), std::move(field));
}

/// RESOURCE_EXHAUSTED at `field`: the limit that `reason` names. The message begins with its name in lower case.
inline Status exhausted(Reason reason, std::string field, std::string message) {
  return Status(Code::kResourceExhausted, reason, std::move(message), std::move(field));
}

/// RESOURCE_EXHAUSTED at `field`: memory, or what the device can do.
inline Status exhausted(std::string field, std::string message) {
  return Status(Code::kResourceExhausted, std::move(message), std::move(field));
}

/// A value or the Status that says why there is none.
template <typename T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : state_(std::move(value)) {}  // NOLINT(google-explicit-constructor): reads as a value
  Expected(Status status) : state_(std::move(status)) {}  // NOLINT(google-explicit-constructor): reads as an error

  bool ok() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return ok(); }
  T& operator*() { return std::get<T>(state_); }
  const T& operator*() const { return std::get<T>(state_); }
  T* operator->() { return &std::get<T>(state_); }
  const T* operator->() const { return &std::get<T>(state_); }
  Status status() const { return ok() ? Status() : std::get<Status>(state_); }

 private:
  std::variant<T, Status> state_;
};

}  // namespace lpv
