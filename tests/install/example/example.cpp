// Moves a light of a new session and looks at what it lights: the whole of lpv::client in forty lines.

#include <lpv/blobs.h>
#include <lpv/client.h>
#include <lpv/convert.h>
#include <lpv/editor.h>
#include <lpv/edits.h>

#include <cstdio>

int report(const lpv::Status& status) {
  std::fprintf(stderr, "example: %s\n", status.message().c_str());
  return status.code() == lpv::Code::kUnavailable ? 3 : 1;
}

int main(int argc, char** argv) {
  std::printf("lpv %s\n", lpv::client::version());
  if (argc < 2) return std::puts("usage: example HOST:PORT"), 0;
  auto client = lpv::client::Client::connect({.address = argv[1]});
  if (!client) return report(client.status());
  const auto made = client->createSession({});
  if (!made) return report(made.status());
  auto editor = lpv::client::Editor::join(*client, made->session().name(), "example");
  if (!editor) return report(editor.status());

  lpv::Mesh quad;
  quad.positions = {{-0.5F, 0, -0.5F}, {0.5F, 0, -0.5F}, {0.5F, 0, 0.5F}, {-0.5F, 0, 0.5F}};
  quad.triangles = {{0, 1, 2}, {0, 2, 3}};  // counter-clockwise from below: shines down
  const auto mesh = lpv::client::upload(*client, editor->session(), quad);
  if (!mesh) return report(mesh.status());
  lpv::v1::Light lamp;
  lamp.set_name("Lamp");
  lamp.set_mesh(*mesh);
  *lamp.mutable_radiance() = lpv::client::toProto({10, 8, 6});
  const auto added = editor->apply(lpv::client::editOf({lpv::client::createLight(lamp), lpv::client::fitGrid()}));
  if (!added) return report(added.status());
  const auto moved =
      editor->apply(lpv::client::editOf({lpv::client::moveLight("Lamp", {.translation = {{0, 0.05, 0}}})}));
  if (!moved) return report(moved.status());
  const auto below = client->probe(editor->session(), {{.position = {0, -0.05, 0}, .normal = {0, 1, 0}}});
  if (!below) return report(below.status());
  const glm::dvec3 rgb = below->irradiance[0].rgb;
  std::printf("irradiance %g %g %g W/m^2 at revision %llu\n", rgb.x, rgb.y, rgb.z,
              static_cast<unsigned long long>(below->info.revision()));
  if (lpv::Status gone = client->deleteSession(editor->session()); !gone.ok()) return report(gone);
  return rgb.x > 0.0 ? 0 : 1;
}
