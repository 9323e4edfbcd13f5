#pragma once
// Renders one frame into a file, for `frame get` and `render`.

#include <optional>
#include <string>

#include "lpv/client.h"
#include "scene_flags.h"

namespace lpv::cli {

/// Image format by the file's extension. INVALID_ARGUMENT unless it is png, jpg, jpeg or exr.
Expected<v1::FrameFormat> frameFormatOf(const std::string& path);

/// Requests the frame and writes it. The server's default view is used when neither `camera` nor the flags name one.
Expected<client::FrameResult> getFrame(client::Client& client, const std::string& session, const FrameFlags& flags,
                                       const std::optional<v1::Camera>& camera, const std::string& path);

}  // namespace lpv::cli
