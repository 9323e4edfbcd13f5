#pragma once

#include <string>

namespace lpv::gpu {

/// Writes a text that this driver has compiled to the folder that the environment's LPV_SHADER_RECORD names; nothing
/// where it names none. `file` is the entry point ("transport/gather.comp"): a record is called
/// transport_gather.HASH.comp after it and the text, so that each variant is there once, however many processes compile
/// it. What cannot be written is logged and otherwise ignored.
void recordShader(const std::string& file, const std::string& text);

}  // namespace lpv::gpu
