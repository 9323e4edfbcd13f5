#pragma once
// The meshes of a glTF file, with plain numbers instead of quantised, sparse or compressed ones.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "import/gltf_data.h"
#include "import/gltf_materials.h"

namespace lpv::cli {

/// Writes the members meshes and accessors: positions, normals, tangents, texture coordinates and colours as floats,
/// indices as uint32 below the number of vertices. An attribute that has another number of vertices than the positions
/// is left out with a warning.
class GltfMeshWriter {
 public:
  GltfMeshWriter(const JsonPlace& root, GltfData& data, AddView addView, nlohmann::json& out,
                 std::vector<std::string>& warnings);
  void addMeshes();
  bool anyTriangle() const { return anyTriangle_; }

 private:
  struct Stored {
    std::size_t accessor = 0;  ///< in the rewritten file
    std::size_t count = 0;
    unsigned components = 1;
    std::uint32_t largest = 0;     ///< of indices
    std::size_t largestAt = 0;
  };
  using Attributes = std::map<std::string, Stored>;

  nlohmann::json primitive(const JsonPlace& place);
  bool addDraco(const JsonPlace& place, const JsonPlace& compressed, nlohmann::json& out);
  void addPlain(const JsonPlace& place, nlohmann::json& out);
  void addAttributes(const JsonPlace& place, const Attributes& given, nlohmann::json& out);
  Attributes readAttributes(const JsonPlace& place);
  void addIndices(const JsonPlace& place, const Stored& indices, std::size_t vertices, nlohmann::json& out);
  const Stored* storedFloats(const JsonPlace& index);
  const Stored* storedIndices(const JsonPlace& index);
  Stored store(const Floats& floats);
  Stored store(const std::vector<std::uint32_t>& indices);

  const JsonPlace& root_;
  GltfData& data_;
  AddView addView_;
  nlohmann::json& out_;
  std::vector<std::string>& warnings_;
  std::map<std::size_t, Stored> floats_;   ///< by the accessor in the file
  std::map<std::size_t, Stored> indices_;
  bool anyTriangle_ = false;
};

}  // namespace lpv::cli
