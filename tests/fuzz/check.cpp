#include "fuzz/check.h"

#include <cstdio>
#include <cstdlib>

#include "lpv/v1/scene.pb.h"

namespace lpv::fuzz {

void check(bool kept, const std::string& promise) {
  if (kept) return;
  std::fprintf(stderr, "broken: %s\n", promise.c_str());
  std::abort();
}

bool isUtf8(const std::string& text) {
  lpv::v1::FieldViolation message;
  message.set_field(text);
  return lpv::v1::FieldViolation().ParseFromString(message.SerializeAsString());
}

void checkRefusal(const Status& status) {
  check(!status.ok(), "a refusal has a code");
  check(!status.message().empty(), "a refusal says why; its field is \"" + status.field() + "\"");
  check(isUtf8(status.message()), "a refusal is UTF-8: " + status.message());
  check(isUtf8(status.field()), "the field of a refusal is UTF-8: " + status.field());
}

}  // namespace lpv::fuzz
