#pragma once
// 128-bit integers, an extension every compiler we build with has; named once so that -Wpedantic stays on.

namespace lpv::reference {

__extension__ using Int128 = __int128;

}  // namespace lpv::reference
