#include "import/gltf_nodes.h"

#include <optional>
#include <utility>

namespace lpv::cli {
namespace {

using nlohmann::json;

constexpr std::size_t kDeepest = 1000;  // Assimp visits a tree by recursion

/// Nodes that are nobody's children.
std::vector<std::size_t> orphans(const JsonPlace& nodes) {
  std::vector<bool> child(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const JsonPlace children = nodes.at(i).at("children");
    for (std::size_t k = 0; k < children.size(); ++k) {
      if (const auto index = children.at(k).index(child.size(), "nodes")) child[*index] = true;
    }
  }
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < child.size(); ++i) {
    if (!child[i]) out.push_back(i);
  }
  return out;
}

std::vector<std::size_t> listed(const JsonPlace& list, std::size_t nodes) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (const auto index = list.at(i).index(nodes, "nodes")) out.push_back(*index);
  }
  return out;
}

void checkTree(const JsonPlace& nodes, const std::vector<std::size_t>& roots) {
  std::vector<bool> reached(nodes.size());
  std::vector<std::pair<std::size_t, std::size_t>> open;  // node, depth
  for (const std::size_t root : roots) open.emplace_back(root, 1);
  while (!open.empty()) {
    const auto [node, depth] = open.back();
    open.pop_back();
    const JsonPlace place = nodes.at(node);
    if (reached[node])
      return place.refuse("is reached twice in the tree of nodes; a node has one parent: export it again");
    if (depth > kDeepest) return place.refuse("is deeper than " + std::to_string(kDeepest) + " levels of nodes");
    reached[node] = true;
    for (const std::size_t child : listed(place.at("children"), reached.size())) open.emplace_back(child, depth + 1);
  }
}

}  // namespace

std::vector<std::size_t> rootNodes(const JsonPlace& root) {
  const JsonPlace nodes = root.at("nodes");
  const JsonPlace scenes = root.at("scenes");
  const auto scene = scenes.size() == 0 ? std::nullopt : root.at("scene").index(scenes.size(), "scenes");
  std::vector<std::size_t> roots =
      scenes.size() == 0 ? orphans(nodes) : listed(scenes.at(scene.value_or(0)).at("nodes"), nodes.size());
  checkTree(nodes, roots);
  return roots;
}

json plainNodes(const JsonPlace& root) {
  json out = json::array();
  const JsonPlace nodes = root.at("nodes");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const JsonPlace node = nodes.at(i);
    json& to = out.emplace_back(json::object());
    if (node.at("name").present()) to["name"] = node.at("name").text();
    if (const auto mesh = node.at("mesh").index(root.at("meshes").size(), "meshes")) to["mesh"] = *mesh;
    if (const auto camera = node.at("camera").index(root.at("cameras").size(), "cameras")) to["camera"] = *camera;
    const std::vector<std::size_t> children = listed(node.at("children"), nodes.size());
    if (!children.empty()) to["children"] = children;
    copyNumbers(node, "matrix", 16, to);
    copyNumbers(node, "translation", 3, to);
    copyNumbers(node, "rotation", 4, to);
    copyNumbers(node, "scale", 3, to);
  }
  return out;
}

}  // namespace lpv::cli
