#pragma once
// Shader sources: embedded at build time, or read from the source tree in development builds.

#include <string>
#include <utility>
#include <vector>

namespace lpv::gpu {

/// One file of shaders/ as generated into the binary; the table ends with a null name.
struct EmbeddedShader {
  const char* name;
  const char* text;
};
extern const EmbeddedShader kEmbeddedShaders[];

/// Explicit defines of one variant, in order: {"LPV_CHANNELS", "1"}.
using Defines = std::vector<std::pair<std::string, std::string>>;

/// What every shader that this thread assembles from now on is told of its device, before its own defines. Returns what
/// it was before.
Defines defineForDevice(Defines defines);

/// A complete GLSL text and the files it came from; #line directives count files in this order.
struct ShaderSource {
  std::string text;
  std::vector<std::string> files;
};

/// `file` with #version 450, the defines, and every #include "x" of shaders/ expanded once (an include guard is
/// implied). Throws Failure (INTERNAL) naming a file that does not exist.
ShaderSource assembleShader(const std::string& file, const Defines& defines);

/// The same for a source text that is not in a file.
ShaderSource assembleText(const std::string& name, const std::string& text, const Defines& defines);

/// A number that changes when any of the files changes on disk; constant where sources are embedded.
std::size_t sourceStamp(const std::vector<std::string>& files);

}  // namespace lpv::gpu
