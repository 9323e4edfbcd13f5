#include "import/scene_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>

#include "import/assimp_mesh.h"
#include "import/file_check.h"
#include "import/gltf_extras.h"
#include "import/materials.h"
#include "import/names.h"
#include "import/prepared_file.h"

namespace Assimp {

/// Debian's Assimp is built with assertions, which would end the process for some malformed files, and does not export
/// the setter of their handler. This definition overrides the library's and turns a failed assertion into an error.
void aiAssertViolation(const char* expression, const char* file, int line);
void aiAssertViolation(const char* expression, const char*, int) {
  throw std::runtime_error(std::string("malformed: not ") + expression);
}

}  // namespace Assimp

namespace lpv::cli {
namespace {

/// worldFromFile: scales to metres and turns +Y up.
glm::dmat4 worldFromFile(const ImportOptions& options) {
  glm::dmat4 matrix(options.scale);
  if (options.zUp) {
    matrix[1] = glm::dvec4(0.0, 0.0, -options.scale, 0.0);  // the file's +Y points away: -Z
    matrix[2] = glm::dvec4(0.0, options.scale, 0.0, 0.0);   // its +Z is up: +Y
  }
  matrix[3] = glm::dvec4(0.0, 0.0, 0.0, 1.0);
  return matrix;
}

/// Null for a file that Assimp refuses. Its messages name none of the file's places: prepareFile has said what it can.
const aiScene* parse(const PreparedFile& file, unsigned flags, Assimp::Importer& importer) {
  importer.SetIOHandler(new PreparedFileSystem(file));  // the importer deletes it
  try {
    return importer.ReadFile(file.name, flags);
  } catch (const std::exception&) {
    return nullptr;
  }
}

/// What a file without normals gets. Triangles of glTF share vertices, each of which would get the normal of one of
/// them: such meshes go without, and the server shades each triangle by its own.
unsigned normalsFor(const std::string& extension) {
  if (extension == "gltf" || extension == "glb") return 0;
  return extension == "ply" ? aiProcess_GenSmoothNormals : aiProcess_GenNormals;
}

Status readFile(const std::string& path, const PreparedFile& file, const ImportOptions& options,
                Assimp::Importer& importer) {
  unsigned flags = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_FlipUVs | aiProcess_ValidateDataStructure;
  if (!options.keepVertices) {  // flat normals would duplicate vertices too
    flags |= aiProcess_JoinIdenticalVertices | normalsFor(extensionOf(path));
  }
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = parse(file, flags, importer);
  if (scene == nullptr) {
    return invalid("file", path + ": the file cannot be read as " + extensionOf(path) +
                               ", or has no triangle; open it in the program that made it and export it again");
  }
  if (scene->mRootNode == nullptr || scene->mNumMeshes == 0) {
    return invalid("file", path + ": the file has no triangle");
  }
  return {};
}

/// Calls visit(node, worldFromNode) for every node, parents first.
void forEachNode(const aiScene& scene, const glm::dmat4& root,
                 const std::function<void(const aiNode&, const glm::dmat4&)>& visit) {
  std::vector<std::pair<const aiNode*, glm::dmat4>> open{{scene.mRootNode, root}};
  while (!open.empty()) {
    const auto [node, parent] = open.back();
    open.pop_back();
    const glm::dmat4 world = parent * matrixFrom(node->mTransformation);
    visit(*node, world);
    for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], world);
  }
}

/// Builds lights and surfaces from (node, mesh) pairs.
class SceneBuilder {
 public:
  SceneBuilder(const aiScene& scene, const std::string& path, const PreparedFile& file, const ImportOptions& options)
      : scene_(scene),
        stem_(std::filesystem::path(path).stem().string()),
        extras_(file.extras),
        materials_(scene, path, extras_, options) {
    out_.warnings = file.warnings;
  }

  Status addNode(const aiNode& node, const glm::dmat4& world) {
    worldFromNode_[node.mName.C_Str()] = world;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (Status status = addObject(node, node.mMeshes[i], world); !status.ok()) return status;
    }
    return {};
  }

  void addCameras() {
    for (unsigned i = 0; i < scene_.mNumCameras; ++i) addCamera(*scene_.mCameras[i]);
  }

  ImportedScene take() {
    std::vector<std::string> more = materials_.takeWarnings();
    out_.warnings.insert(out_.warnings.end(), more.begin(), more.end());
    return std::move(out_);
  }

 private:
  Status addObject(const aiNode& node, unsigned meshIndex, const glm::dmat4& world) {
    const aiMesh& source = *scene_.mMeshes[meshIndex];
    const Material& material = materials_.at(source.mMaterialIndex);
    const std::string name = objectName(node.mName.C_Str(), source.mName.C_Str(), stem_);
    Expected<MeshPtr> mesh = sharedMesh(meshIndex, material.uvChannel);
    if (!mesh) return faulty(name, mesh.status());
    const Expected<Transform> transform = transformFromMatrix(world);
    if (!transform) {  // a Transform cannot shear: bake the matrix into the vertices
      Expected<Mesh> flat = baked(**mesh, world);
      if (!flat) return faulty(name, flat.status());
      mesh = std::make_shared<const Mesh>(std::move(*flat));
    }
    const TexturePtr texture = (*mesh)->uvs.empty() ? nullptr : material.texture;
    if (!texture && material.texture)
      out_.warnings.push_back(name + " has a texture but no texture coordinates: ignored it");
    addMaterialised(name, *mesh, transform ? *transform : Transform(), material, texture);
    return {};
  }

  /// What is wrong with a mesh, with the object that has it.
  static Status faulty(const std::string& object, const Status& status) {
    return invalid(object, "object '" + object + "': " + status.message() + "; mend it and export the file again");
  }

  void addMaterialised(const std::string& name, const MeshPtr& mesh, const Transform& transform,
                       const Material& material, const TexturePtr& texture) {
    if (material.emits()) {
      Light light;
      light.name = name;
      light.mesh = mesh;
      light.transform = transform;
      light.radiance = material.radiance;
      light.texture = texture;
      light.twoSided = material.doubleSided;
      out_.lights.push_back(std::move(light));
      return;
    }
    Surface surface;
    surface.name = name;
    surface.mesh = mesh;
    surface.transform = transform;
    surface.albedo = material.albedo;
    surface.albedoTexture = texture;
    if (!mesh->uvs.empty()) {
      surface.normalTexture = material.normals;
      surface.glossTexture = material.gloss;
    }
    surface.normalScale = material.normalScale;
    surface.roughness = material.roughness;
    surface.metalness = material.metalness;
    surface.twoSided = !material.oneSidedSurface;
    surface.alphaMode = material.alphaMode;
    surface.alphaCutoff = material.alphaCutoff;
    surface.opacity = material.opacity;
    surface.transmission = material.transmission;
    if (!material.passes.empty() &&
        std::find(out_.assumed.begin(), out_.assumed.end(), material.passes) == out_.assumed.end())
      out_.assumed.push_back(material.passes);
    out_.surfaces.push_back(std::move(surface));
  }

  Expected<MeshPtr> sharedMesh(unsigned index, unsigned uvChannel) {
    MeshPtr& known = meshes_[{index, uvChannel}];
    if (!known) {
      Expected<Mesh> mesh = meshFrom(*scene_.mMeshes[index], uvChannel);
      if (!mesh) return mesh.status();
      known = std::make_shared<const Mesh>(std::move(*mesh));
    }
    return known;
  }

  void addCamera(const aiCamera& source) {
    const auto node = worldFromNode_.find(source.mName.C_Str());
    const glm::dmat4 world = node == worldFromNode_.end() ? glm::dmat4(1.0) : node->second;
    // A glTF camera is at its node's origin and looks along -z; no other format here has cameras.
    Camera camera;
    camera.eye = glm::dvec3(world[3]);
    camera.target = camera.eye - glm::dvec3(world[2]);
    camera.up = glm::dvec3(world[1]);
    const auto fov = extras_.verticalFov.find(source.mName.C_Str());
    if (fov != extras_.verticalFov.end()) camera.fovDegrees = glm::degrees(fov->second);
    camera.near = std::max(double(source.mClipPlaneNear), 1e-4);
    camera.far = source.mClipPlaneFar > camera.near ? source.mClipPlaneFar : camera.near + 1000.0;
    const std::string name = objectName(source.mName.C_Str(), "camera", stem_);
    if (const Status status = checkCamera(camera); !status.ok()) {
      out_.warnings.push_back("ignored camera " + name + ": " + status.message());
      return;
    }
    out_.cameras.emplace_back(name, camera);
  }

  const aiScene& scene_;
  std::string stem_;
  const GltfExtras& extras_;
  Materials materials_;
  std::map<std::pair<unsigned, unsigned>, MeshPtr> meshes_;
  std::map<std::string, glm::dmat4> worldFromNode_;
  ImportedScene out_;
};

}  // namespace

Expected<ImportedScene> importScene(const std::string& path, const ImportOptions& options) {
  const Expected<PreparedFile> file = prepareFile(path);
  if (!file) return file.status();
  Assimp::Importer importer;
  if (Status status = readFile(path, *file, options, importer); !status.ok()) return status;
  const aiScene& scene = *importer.GetScene();
  SceneBuilder builder(scene, path, *file, options);
  Status status;
  forEachNode(scene, worldFromFile(options), [&](const aiNode& node, const glm::dmat4& world) {
    if (status.ok()) status = builder.addNode(node, world);
  });
  if (!status.ok()) return Status(status.code(), path + ": " + status.message(), status.field());
  builder.addCameras();
  ImportedScene out = builder.take();
  if (out.lights.empty() && out.surfaces.empty()) return invalid("file", path + ": the file has no triangle");
  return out;
}

Expected<Mesh> importMesh(const std::string& path, const ImportOptions& options) {
  const Expected<PreparedFile> file = prepareFile(path);
  if (!file) return file.status();
  Assimp::Importer importer;
  if (Status status = readFile(path, *file, options, importer); !status.ok()) return status;
  const aiScene& scene = *importer.GetScene();
  Mesh all;
  Status status;
  forEachNode(scene, worldFromFile(options), [&](const aiNode& node, const glm::dmat4& world) {
    for (unsigned i = 0; i < node.mNumMeshes && status.ok(); ++i) {
      Expected<Mesh> mesh = meshFrom(*scene.mMeshes[node.mMeshes[i]], 0);
      if (mesh) mesh = baked(std::move(*mesh), world);
      if (mesh) append(all, *mesh);
      status = mesh.status();
    }
  });
  if (!status.ok()) return Status(status.code(), path + ": " + status.message(), status.field());
  if (all.triangles.empty()) return invalid("file", path + ": the file has no triangle");
  return all;
}

Bounds boundsOf(const ImportedScene& scene) {
  Bounds bounds;
  for (const Light& light : scene.lights) bounds.add(light.mesh->bounds.transformed(light.transform.worldFromObject()));
  for (const Surface& s : scene.surfaces) bounds.add(s.mesh->bounds.transformed(s.transform.worldFromObject()));
  return bounds;
}

}  // namespace lpv::cli
