#include "import/gltf_meshopt.h"

#ifdef LPV_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif

namespace lpv::cli {

#ifdef LPV_HAVE_MESHOPT

namespace {

constexpr std::size_t kMostBytes = std::size_t(1) << 30;

/// Whether meshoptimizer takes these numbers, which it asserts.
bool allowed(const MeshoptView& view) {
  const bool indices = view.stride == 2 || view.stride == 4;
  if (view.stride == 0 || view.stride > 256 || view.count > kMostBytes / view.stride) return false;
  if (view.mode == "ATTRIBUTES") {
    if (view.filter == "OCTAHEDRAL") return view.stride == 4 || view.stride == 8;
    if (view.filter == "QUATERNION") return view.stride == 8;
    return view.stride % 4 == 0 && (view.filter == "NONE" || view.filter == "EXPONENTIAL");
  }
  if (view.filter != "NONE") return false;
  return indices && ((view.mode == "TRIANGLES" && view.count % 3 == 0) || view.mode == "INDICES");
}

int decode(const MeshoptView& view, std::string& out) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(view.bytes.data());
  const std::size_t size = view.bytes.size();
  if (view.mode == "ATTRIBUTES") return meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, bytes, size);
  if (view.mode == "TRIANGLES") return meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, bytes, size);
  return meshopt_decodeIndexSequence(out.data(), view.count, view.stride, bytes, size);
}

}  // namespace

bool meshoptIsBuiltIn() { return true; }

Expected<std::string> decodeMeshopt(const MeshoptView& view) {
  if (!allowed(view)) {
    return invalid("file", "has the mode '" + view.mode + "', the filter '" + view.filter + "', " +
                               std::to_string(view.count) + " elements of " + std::to_string(view.stride) +
                               " bytes, which EXT_meshopt_compression does not allow together");
  }
  std::string out(view.count * view.stride, '\0');
  if (decode(view, out) != 0) {
    return invalid("file", "is damaged: its bytes are not what EXT_meshopt_compression writes; export the file again");
  }
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), view.count, view.stride);
  return out;
}

#else

bool meshoptIsBuiltIn() { return false; }

Expected<std::string> decodeMeshopt(const MeshoptView&) {
  return invalid("file",
                 "is compressed with EXT_meshopt_compression, and this lpvctl was built without libmeshoptimizer; "
                 "export the file without it");
}

#endif

}  // namespace lpv::cli
