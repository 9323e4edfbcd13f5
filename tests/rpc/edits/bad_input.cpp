#include "rpc/edits/bad_input.h"

#include <limits>

namespace lpv::rpc {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// 120,000 bytes, no letter of them ASCII.
std::string endless() {
  std::string out;
  for (int i = 0; i < 60'000; ++i) out += "\u00fc";
  return out;
}

/// A light or surface with a mesh spoilt in one way.
Row meshRow(const std::string& name, const std::function<void(pb::Mesh*)>& spoil, const std::string& field,
            const std::string& text) {
  return {"Mesh" + name,
          [spoil](World& w) {
            pb::Mesh mesh = quad();
            spoil(&mesh);
            return tryEdit(w.stubs, w.session, client::editOf({client::createLight(light("Bad", mesh))}));
          },
          StatusCode::INVALID_ARGUMENT, "edit.operations[0].create_light.inline_mesh." + field, text};
}

/// The same mesh as a blob.
Row blobRow(const std::string& name, const std::function<void(pb::Mesh*)>& spoil, const std::string& field,
            const std::string& text) {
  return {"Blob" + name,
          [spoil](World& w) {
            pb::Mesh mesh = quad();
            spoil(&mesh);
            return upload(w.stubs, w.session, pb::BLOB_KIND_MESH, mesh.SerializeAsString());
          },
          StatusCode::INVALID_ARGUMENT, field, text};
}

Row lightRow(const std::string& name, const std::function<void(pb::Light*)>& spoil, const std::string& field,
             const std::string& text) {
  return {"Light" + name,
          [spoil](World& w) {
            pb::Light bad = light("Bad");
            spoil(&bad);
            return tryEdit(w.stubs, w.session, client::editOf({client::createLight(bad)}));
          },
          StatusCode::INVALID_ARGUMENT, "edit.operations[0].create_light" + field, text};
}

Row surfaceRow(const std::string& name, const std::function<void(pb::Surface*)>& spoil, const std::string& field,
               const std::string& text) {
  return {"Surface" + name,
          [spoil](World& w) {
            pb::Surface bad = surface("Bad");
            spoil(&bad);
            return tryEdit(w.stubs, w.session, client::editOf({client::createSurface(bad)}));
          },
          StatusCode::INVALID_ARGUMENT, "edit.operations[0].create_surface" + field, text};
}

/// An update of the light that is there.
Row updateRow(const std::string& name, const std::string& path, const std::function<void(pb::Light*)>& spoil,
              const std::string& field, const std::string& text) {
  return {"Update" + name,
          [path, spoil](World& w) {
            pb::Light bad;
            bad.set_name("Lamp");
            spoil(&bad);
            return tryEdit(w.stubs, w.session, client::editOf({client::updateLight(bad, {path})}));
          },
          StatusCode::INVALID_ARGUMENT, "edit.operations[0].update_light.light." + field, text};
}

Row gridRow(const std::string& name, const std::function<void(pb::GridSettings*)>& spoil, const std::string& field,
            const std::string& text) {
  return {"Grid" + name,
          [spoil](World& w) {
            pb::CreateSessionRequest request;
            *request.mutable_settings() = settings();
            spoil(request.mutable_settings()->mutable_grid());
            pb::CreateSessionResponse response;
            return w.stubs.session->CreateSession(Call(), request, &response);
          },
          StatusCode::INVALID_ARGUMENT, "settings.grid." + field, text};
}

grpc::Status getFrame(World& w, const pb::GetFrameRequest& request) {
  Call call;
  const auto reader = w.stubs.result->GetFrame(call, request);
  pb::GetFrameResponse part;
  while (reader->Read(&part)) {
  }
  return reader->Finish();
}

Row frameRow(const std::string& name, const std::function<void(pb::GetFrameRequest*)>& spoil, const std::string& field,
             const std::string& text) {
  return {"Frame" + name,
          [spoil](World& w) {
            pb::GetFrameRequest request;
            request.set_session(w.session);
            *request.mutable_camera() = camera({0, 0, 1}, {0, 0, 0});
            request.set_width(32);
            request.set_height(32);
            spoil(&request);
            return getFrame(w, request);
          },
          StatusCode::INVALID_ARGUMENT, field, text};
}

Row probeRow(const std::string& name, const std::string& points, const std::string& text) {
  return {"Probe" + name,
          [points](World& w) {
            pb::ProbeRequest request;
            request.set_session(w.session);
            request.set_points(points);
            pb::ProbeResponse response;
            return w.stubs.result->Probe(Call(), request, &response);
          },
          StatusCode::INVALID_ARGUMENT, "points", text};
}

std::vector<Row> meshRows() {
  const auto nan = [](pb::Mesh* m) { m->set_positions(packed<float>({0, 0, 0, kNan, 0, 0, 0, 1, 0, 1, 1, 0})); };
  const auto inf = [](pb::Mesh* m) { m->set_positions(packed<float>({0, 0, 0, 1, -kInf, 0, 0, 1, 0, 1, 1, 0})); };
  const auto index = [](pb::Mesh* m) { m->set_indices(packed<std::uint32_t>({0, 1, 4})); };
  const auto huge = [](pb::Mesh* m) { m->set_indices(packed<std::uint32_t>({0, 1, 0xFFFFFFFFU})); };
  const auto empty = [](pb::Mesh* m) { m->Clear(); };
  const auto two = [](pb::Mesh* m) {
    m->set_positions(packed<float>({0, 0, 0, 1, 0, 0}));
    m->set_indices(packed<std::uint32_t>({0, 1, 1}));
  };
  const auto noTriangle = [](pb::Mesh* m) { m->clear_indices(); };
  const auto odd = [](pb::Mesh* m) { *m->mutable_positions() += "x"; };
  const auto oddIndices = [](pb::Mesh* m) { m->mutable_indices()->resize(20); };
  const auto normals = [](pb::Mesh* m) { m->set_normals(packed<float>({0, 0, 1, 0, 0, 1, 0, 0, 1})); };
  const auto uvs = [](pb::Mesh* m) { m->set_uvs(packed<float>({0, 0, 1, 0, 1, 1, 0, 1, 0, 0})); };
  const auto uvNan = [](pb::Mesh* m) { m->set_uvs(packed<float>({0, 0, 1, kNan, 1, 1, 0, 1})); };
  std::vector<Row> rows;
  for (const auto& make : {meshRow, blobRow}) {
    rows.push_back(make("NanVertex", nan, "positions", "positions[1]"));
    rows.push_back(make("InfiniteVertex", inf, "positions", "positions[1]"));
    rows.push_back(make("IndexOutOfRange", index, "indices", "0..3"));
    rows.push_back(make("IndexAtTheEndOfTheWorld", huge, "indices", "4294967295"));
    rows.push_back(make("Empty", empty, "positions", "at least 3"));
    rows.push_back(make("TwoVertices", two, "positions", "at least 3"));
    rows.push_back(make("NoTriangle", noTriangle, "indices", "at least 1"));
    rows.push_back(make("OddPositions", odd, "positions", "multiple of 12"));
    rows.push_back(make("OddIndices", oddIndices, "indices", "multiple of 12"));
    rows.push_back(make("MissingNormal", normals, "normals", "4 positions"));
    rows.push_back(make("ExtraUv", uvs, "uvs", "4 positions"));
    rows.push_back(make("NanUv", uvNan, "uvs", "uvs[1]"));
  }
  for (Row& row : rows) {
    if (row.name == "BlobEmpty") {  // nothing is no blob
      row.field = "header.size";
      row.text = "at least 1";
    }
  }
  return rows;
}

std::vector<Row> transformRows() {
  return {
      lightRow(
          "ZeroScale", [](auto* l) { *l->mutable_transform()->mutable_scale() = vec3(1, 0, 1); }, ".transform.scale",
          "singular"),
      lightRow(
          "NanTranslation", [](auto* l) { *l->mutable_transform()->mutable_translation() = vec3(0, kNan, 0); },
          ".transform.translation", "finite"),
      lightRow(
          "NanScale", [](auto* l) { *l->mutable_transform()->mutable_scale() = vec3(kNan, 1, 1); }, ".transform.scale",
          "finite"),
      lightRow(
          "LongQuaternion", [](auto* l) { l->mutable_transform()->mutable_rotation()->set_w(2.0); },
          ".transform.rotation", "unit quaternion"),
      lightRow(
          "NoQuaternion", [](auto* l) { l->mutable_transform()->mutable_rotation(); }, ".transform.rotation",
          "unit quaternion"),
      lightRow(
          "NanQuaternion", [](auto* l) { l->mutable_transform()->mutable_rotation()->set_x(kNan); },
          ".transform.rotation", "unit quaternion"),
      lightRow(
          "ShortMatrix", [](auto* l) { l->mutable_transform()->add_matrix(1.0); }, ".transform.matrix", "16"),
      lightRow(
          "SingularMatrix",
          [](auto* l) {
            for (int i = 0; i < 16; ++i) l->mutable_transform()->add_matrix(i == 15 ? 1.0 : 0.0);
          },
          ".transform.matrix", "singular"),
      lightRow(
          "NanMatrix",
          [](auto* l) {
            for (int i = 0; i < 16; ++i) l->mutable_transform()->add_matrix(i % 5 == 0 ? 1.0 : 0.0);
            l->mutable_transform()->set_matrix(12, kNan);
          },
          ".transform.matrix", "finite"),
      updateRow(
          "ZeroScale", "transform.scale", [](auto* l) { *l->mutable_transform()->mutable_scale() = vec3(0, 0, 0); },
          "transform.scale", "singular"),
      updateRow(
          "NanTranslation", "transform.translation",
          [](auto* l) { *l->mutable_transform()->mutable_translation() = vec3(kInf, 0, 0); }, "transform.translation",
          "finite"),
      updateRow(
          "BrokenMesh", "inline_mesh", [](auto* l) { *l->mutable_inline_mesh() = pb::Mesh(); }, "inline_mesh.positions",
          "at least 3"),
  };
}

std::vector<Row> valueRows() {
  const std::string longName(300, 'n');
  return {
      lightRow(
          "NegativeRadiance", [](auto* l) { *l->mutable_radiance() = vec3(1, -1, 1); }, ".radiance", "1000000000"),
      lightRow(
          "NanRadiance", [](auto* l) { *l->mutable_radiance() = vec3(kNan, 1, 1); }, ".radiance", "1000000000"),
      lightRow(
          "HugeRadiance", [](auto* l) { *l->mutable_radiance() = vec3(1, 1, 1e12); }, ".radiance", "1000000000"),
      lightRow(
          "NanPower", [](auto* l) { *l->mutable_power() = vec3(1, kNan, 1); }, ".power", "1000000000"),
      lightRow(
          "NoName", [](auto* l) { l->clear_name(); }, ".name", "1 to 200"),
      lightRow(
          "SlashName", [](auto* l) { l->set_name("a/b"); }, ".name", "'/'"),
      lightRow(
          "LongName", [longName](auto* l) { l->set_name(longName); }, ".name", "1 to 200"),
      lightRow(
          "ControlName", [](auto* l) { l->set_name("a\nb"); }, ".name", "control"),
      lightRow(
          "NoMesh", [](auto* l) { l->clear_inline_mesh(); }, ".mesh", "inline_mesh"),
      lightRow(
          "TwoMeshes", [](auto* l) { l->set_mesh(std::string(64, '0')); }, ".mesh", "give one"),
      lightRow(
          "PowerOfTheSky",
          [](auto* l) {
            l->set_distant(true);
            *l->mutable_power() = vec3(1, 1, 1);
          },
          ".power", "give its radiance"),
      surfaceRow(
          "BrightAlbedo", [](auto* s) { *s->mutable_albedo() = vec3(0.5, 1.5, 0.5); }, ".albedo", "0 to 1"),
      surfaceRow(
          "NanAlbedo", [](auto* s) { *s->mutable_albedo() = vec3(kNan, 0, 0); }, ".albedo", "0 to 1"),
      surfaceRow(
          "Roughness", [](auto* s) { s->set_roughness(-0.1); }, ".roughness", "0 to 1"),
      surfaceRow(
          "Metalness", [](auto* s) { s->set_metalness(kNan); }, ".metalness", "0 to 1"),
      surfaceRow(
          "SlashName", [](auto* s) { s->set_name("/"); }, ".name", "'/'"),
      {"EditEmpty", [](World& w) { return tryEdit(w.stubs, w.session, pb::Edit()); }, StatusCode::INVALID_ARGUMENT,
       "edit.operations", "1 to 1000"},
      {"EditOperationNotSet", [](World& w) { return tryEdit(w.stubs, w.session, client::editOf({pb::Operation()})); },
       StatusCode::INVALID_ARGUMENT, "edit.operations[0]", "not set"},
      // What a message repeats of a text without a limit still fits into the trailers.
      {"EndlessName",
       [](World& w) { return tryEdit(w.stubs, w.session, client::editOf({client::deleteLight(endless())})); },
       StatusCode::NOT_FOUND, "edit.operations[0].delete_light", "there is no light"},
      {"EndlessPath",
       [](World& w) {
         return tryEdit(w.stubs, w.session, client::editOf({client::updateLight(light("Lamp"), {endless()})}));
       },
       StatusCode::INVALID_ARGUMENT, "edit.operations[0].update_light.update_mask", "unknown path"},
  };
}

std::vector<Row> gridRows() {
  const auto box = [](pb::GridSettings* g, const pb::Vec3& low, const pb::Vec3& high) {
    *g->mutable_bounds()->mutable_min() = low;
    *g->mutable_bounds()->mutable_max() = high;
  };
  const auto dims = [](int x, int y, int z) {
    return [=](pb::GridSettings* g) {
      g->mutable_dims()->set_x(x);
      g->mutable_dims()->set_y(y);
      g->mutable_dims()->set_z(z);
    };
  };
  return {
      gridRow(
          "Zero", [](auto* g) { g->set_longest(0); }, "longest", "1..128"),
      gridRow(
          "Huge", [](auto* g) { g->set_longest(4096); }, "longest", "1..128"),
      gridRow(
          "Negative", [](auto* g) { g->set_longest(-1); }, "longest", "1..128"),
      gridRow("DimsZero", dims(0, 0, 0), "dims", "1..128"),
      gridRow("DimsOneZero", dims(8, 0, 8), "dims.y", "1..128"),
      gridRow("DimsHuge", dims(8, 8, 4096), "dims.z", "1..128"),
      gridRow("DimsNegative", dims(-8, 8, 8), "dims.x", "1..128"),
      gridRow(
          "InsideOut", [box](auto* g) { box(g, vec3(1, -1, -1), vec3(-1, 1, 1)); }, "bounds", "inside out"),
      gridRow(
          "NanBounds", [box](auto* g) { box(g, vec3(-1, kNan, -1), vec3(1, 1, 1)); }, "bounds", "finite"),
      gridRow(
          "EmptyBounds", [box](auto* g) { box(g, vec3(1, 1, 1), vec3(1, 1, 1)); }, "bounds", "1e-6"),
      gridRow(
          "EndlessBounds", [box](auto* g) { box(g, vec3(-kInf, 0, 0), vec3(kInf, 1, 1)); }, "bounds", "finite"),
      gridRow(
          "UnsetBounds", [](auto* g) { g->mutable_bounds()->Clear(); }, "bounds", "1e-6"),
  };
}

std::vector<Row> frameRows() {
  return {
      frameRow(
          "NoWidth", [](auto* r) { r->set_width(0); }, "width", "16 to 4096"),
      frameRow(
          "Narrow", [](auto* r) { r->set_width(15); }, "width", "16 to 4096"),
      frameRow(
          "TooHigh", [](auto* r) { r->set_height(5000); }, "height", "16 to 4096"),
      frameRow(
          "NegativeHeight", [](auto* r) { r->set_height(-32); }, "height", "16 to 4096"),
      frameRow(
          "Quality", [](auto* r) { r->set_quality(101); }, "quality", "1 to 100"),
      frameRow(
          "Samples", [](auto* r) { r->set_samples(3); }, "samples", "1, 2, 4, 8, 16, 32 and 64"),
      frameRow(
          "Quantity", [](auto* r) { r->set_quantity(pb::FrameQuantity(9)); }, "quantity", "9"),
      frameRow(
          "Format", [](auto* r) { r->set_format(pb::FrameFormat(9)); }, "format", "9"),
      frameRow(
          "Exposure", [](auto* r) { r->mutable_exposure()->set_ev(41); }, "exposure.ev", "-40 to 40"),
      frameRow(
          "NanExposure", [](auto* r) { r->mutable_exposure()->set_ev(kNan); }, "exposure.ev", "-40 to 40"),
      frameRow(
          "NoView", [](auto* r) { *r->mutable_camera()->mutable_target() = r->camera().eye(); }, "camera.target",
          "another point"),
      frameRow(
          "NanEye", [](auto* r) { r->mutable_camera()->mutable_eye()->set_y(kNan); }, "camera.eye", "finite"),
      frameRow(
          "NoTarget", [](auto* r) { r->mutable_camera()->clear_target(); }, "camera.target", "not set"),
      frameRow(
          "ParallelUp", [](auto* r) { *r->mutable_camera()->mutable_up() = vec3(0, 0, 1); }, "camera.up", "parallel"),
      frameRow(
          "NarrowView", [](auto* r) { r->mutable_camera()->set_fov_degrees(0.1); }, "camera.fov_degrees", "1..170"),
      frameRow(
          "WideView", [](auto* r) { r->mutable_camera()->set_fov_degrees(179); }, "camera.fov_degrees", "1..170"),
      frameRow(
          "NegativeNear", [](auto* r) { r->mutable_camera()->set_near(-1); }, "camera.near", "above 0"),
      frameRow(
          "FarBeforeNear", [](auto* r) { r->mutable_camera()->set_far(0.001); }, "camera.far", "above"),
      {"CameraPut",
       [](World& w) {
         pb::Operation put;
         *put.mutable_put_camera() = camera({0, 0, 1}, {0, 0, 1});
         put.mutable_put_camera()->set_name("Bad");
         return tryEdit(w.stubs, w.session, client::editOf({put}));
       },
       StatusCode::INVALID_ARGUMENT, "edit.operations[0].put_camera.target", "another point"},
  };
}

std::vector<Row> probeRows() {
  std::string many;
  many.resize(std::size_t(16385) * 48, '\0');
  const std::string good = packed<double>({0, 0, 0.5, 0, 0, 1});
  return {
      probeRow("NanPoint", good + packed<double>({0, kNan, 0, 0, 0, 1}), "point 1"),
      probeRow("InfinitePoint", packed<double>({kInf, 0, 0, 0, 0, 1}), "point 0"),
      probeRow("NoNormal", packed<double>({0, 0, 0, 0, 0, 0}), "normal"),
      probeRow("NanNormal", packed<double>({0, 0, 0, 0, kNan, 0}), "point 0"),
      probeRow("OddSize", good + "x", "multiple of 48"),
      probeRow("TooMany", many, "max_probe_points"),
  };
}

}  // namespace

std::vector<Row> badInput() {
  std::vector<Row> rows;
  for (const auto& some : {meshRows(), transformRows(), valueRows(), gridRows(), frameRows(), probeRows()}) {
    rows.insert(rows.end(), some.begin(), some.end());
  }
  return rows;
}

}  // namespace lpv::rpc
