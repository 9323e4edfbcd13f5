#pragma once
// One picture to a file: for `frame get` and `render`.

#include <optional>
#include <string>

#include "lpv/client.h"
#include "scene_flags.h"

namespace lpv::cli {

/// By the file's extension; INVALID_ARGUMENT for others than png, jpg, jpeg, exr.
Expected<v1::FrameFormat> frameFormatOf(const std::string& path);

/// Asks for the picture and writes it. Without a camera here and a name in the flags the server chooses one.
Expected<client::FrameResult> getFrame(client::Client& client, const std::string& session, const FrameFlags& flags,
                                       const std::optional<v1::Camera>& camera, const std::string& path);

}  // namespace lpv::cli
