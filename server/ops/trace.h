#pragma once

#include <string>
#include <string_view>

namespace lpv::ops {

/// The trace id, 32 hexadecimal digits, of a `traceparent` header (W3C Trace Context, section 3.2); empty where the
/// header is malformed, which callers then take for none.
std::string traceIdOf(std::string_view traceparent);

}  // namespace lpv::ops
