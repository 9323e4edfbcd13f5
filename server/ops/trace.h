#pragma once

#include <string>
#include <string_view>

namespace lpv::ops {

/// The trace id, 32 hexadecimal digits, of a `traceparent` header (W3C Trace Context, section 3.2); empty if the header
/// is malformed, which counts as no header.
std::string traceIdOf(std::string_view traceparent);

}  // namespace lpv::ops
