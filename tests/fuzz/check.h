#pragma once
// What every fuzzer uses.

#include <string>

#include "base/status.h"

namespace lpv::fuzz {

/// Ends the process with a message where a promise was broken: libFuzzer keeps the input.
void check(bool kept, const std::string& promise);

/// A refusal says why, in text that a proto3 client can read.
void checkRefusal(const Status& status);

/// True for valid UTF-8, in the opinion of the library that clients read it with.
bool isUtf8(const std::string& text);

}  // namespace lpv::fuzz
