#include "import/gltf_draco.h"

#include <algorithm>

#ifdef LPV_HAVE_DRACO
#include <draco/compression/decode.h>
#endif

namespace lpv::cli {

#ifdef LPV_HAVE_DRACO

namespace {

/// The largest value of a type of whole numbers; 1 for others.
float largestOf(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return 127.0F;
    case draco::DT_UINT8:
      return 255.0F;
    case draco::DT_INT16:
      return 32767.0F;
    case draco::DT_UINT16:
      return 65535.0F;
    default:
      return 1.0F;
  }
}

/// The accessor decides whether whole numbers are normalised, whatever the compressed mesh says.
Expected<Floats> floatsOf(const draco::Mesh& mesh, const draco::PointAttribute& attribute, bool normalised) {
  Floats out;
  out.components = unsigned(attribute.num_components());
  out.values.resize(std::size_t(mesh.num_points()) * out.components);
  for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
    float* to = out.values.data() + std::size_t(i.value()) * out.components;
    if (!attribute.ConvertValue<float>(attribute.mapped_index(i), std::int8_t(out.components), to)) {
      return invalid("file", "has a type of number that cannot be converted");
    }
  }
  if (normalised == attribute.normalized()) return out;
  const float largest = largestOf(attribute.data_type());
  for (float& value : out.values) value = normalised ? std::max(value / largest, -1.0F) : value * largest;
  return out;
}

}  // namespace

bool dracoIsBuiltIn() { return true; }

Expected<DracoMesh> decodeDraco(std::string_view bytes, const std::map<std::string, DracoAttribute>& wanted) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    return invalid("file",
                   "is damaged: its bytes are not what KHR_draco_mesh_compression writes; export the file again");
  }
  const draco::Mesh& mesh = *decoded.value();
  DracoMesh out;
  for (draco::FaceIndex i(0); i < mesh.num_faces(); ++i) {
    for (const draco::PointIndex& corner : mesh.face(i)) out.indices.push_back(corner.value());
  }
  for (const auto& [name, attributeWanted] : wanted) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(attributeWanted.id);
    if (attribute == nullptr) {
      return invalid("file", "says that " + name + " is attribute " + std::to_string(attributeWanted.id) +
                                 " of the compressed mesh, which has none of this number; export the file again");
    }
    Expected<Floats> floats = floatsOf(mesh, *attribute, attributeWanted.normalised);
    if (!floats) return floats.status();
    out.attributes[name] = std::move(*floats);
  }
  return out;
}

#else

bool dracoIsBuiltIn() { return false; }

Expected<DracoMesh> decodeDraco(std::string_view, const std::map<std::string, DracoAttribute>&) {
  return invalid("file",
                 "is compressed with KHR_draco_mesh_compression, and this lpvctl was built without libdraco; export "
                 "the file without it");
}

#endif

}  // namespace lpv::cli
