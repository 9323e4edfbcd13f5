// Every row of the tables of fields (scene/fields.h), through messages, masks, undo and the store. A new field is
// walked without a line here.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <type_traits>

#include "convert/blob_content.h"
#include "convert/geometry.h"
#include "convert/scene.h"
#include "convert/wire_fields.h"
#include "persistence/snapshot.h"
#include "reference/meshes.h"
#include "unit/session/kept_fixture.h"

namespace lpv::test {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;
namespace pb = lpv::v1;

using Paths = std::set<std::string>;
/// Text of every field by its path; those of the transform one by one.
using FieldTexts = std::map<std::string, std::string>;

/// Fields that no mask names: the name, which says what an edit is about; the matrix, which stands for the other three
/// fields of a transform; and what the server fills in.
template <typename T>
Paths notSettable() {
  Paths out = {"name", "transform.matrix"};
  out.merge(std::is_same_v<T, Light> ? Paths{"status"} : Paths{"revision", "triangle_count"});
  return out;
}

std::string textOf(const Message& in, const FieldDescriptor* field) {
  using google::protobuf::TextFormat;
  std::string text;
  if (!field->is_repeated()) {
    if (field->has_presence() && !in.GetReflection()->HasField(in, field)) return "absent";
    TextFormat::PrintFieldValueToString(in, field, -1, &text);
    return text;
  }
  std::string all;
  for (int i = 0; i < in.GetReflection()->FieldSize(in, field); ++i) {
    TextFormat::PrintFieldValueToString(in, field, i, &text);
    all += text + " ";
  }
  return all;
}

void addTexts(const Message& in, const std::string& prefix, FieldTexts* out) {
  for (int i = 0; i < in.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = in.GetDescriptor()->field(i);
    if (field->message_type() == pb::Transform::descriptor()) {
      addTexts(in.GetReflection()->GetMessage(in, field), field->name() + ".", out);
      continue;
    }
    (*out)[prefix + field->name()] = textOf(in, field);
  }
}

/// The settable fields of a Light or Surface.
template <typename T>
FieldTexts settable(const api::MessageOf<T>& in) {
  FieldTexts out;
  addTexts(in, "", &out);
  for (const std::string& path : notSettable<T>()) out.erase(path);
  return out;
}

Paths differing(const FieldTexts& a, const FieldTexts& b) {
  Paths out;
  for (const auto& [path, text] : a) {
    if (b.at(path) != text) out.insert(path);
  }
  return out;
}

/// A value of a plain field other than `value`, within every range that there is.
FieldValue otherThan(const FieldValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return !*flag;
  if (const double* number = std::get_if<double>(&value)) return *number == 0.5 ? 0.25 : 0.5;
  if (std::holds_alternative<std::string>(value)) return std::string("other");
  if (std::holds_alternative<AlphaMode>(value)) return AlphaMode::kBlend;
  return glm::dvec3(0.125, 0.25, 0.5);
}

void setText(Message* out, const char* path, const std::string& value) {
  out->GetReflection()->SetString(out, out->GetDescriptor()->FindFieldByName(path), value);
}

BlobPtr blobOf(pb::BlobKind kind, const std::string& bytes) {
  const Expected<BlobPtr> blob = api::blobFromBytes(kind, bytes);
  EXPECT_TRUE(blob.ok()) << blob.status().message();
  return *blob;
}

BlobPtr onePixel() {
  pb::Texture texture;
  texture.set_width(1);
  texture.set_height(1);
  texture.set_format(pb::TEXTURE_FORMAT_RGB8_SRGB);
  texture.set_texels("rgb");
  return blobOf(pb::BLOB_KIND_TEXTURE, texture.SerializeAsString());
}

/// Makes the message one that a server stored which did not know the fields that can be absent.
template <typename T>
void clearAbsentable(api::MessageOf<T>* stored) {
  for (const api::WireField& field : api::wireFields<T>()) {
    if (field.canBeAbsent) field.reflection->ClearField(stored, field.descriptor);
  }
}

/// A session with one member, in a folder, to be filled through messages.
template <typename T>
class FieldsTest : public KeptSessions {
 protected:
  using Wire = api::MessageOf<T>;

  void SetUp() override {
    session_ = create("hall");
    member_ = *session_->join();
    EXPECT_TRUE(session_->addBlob(mesh_).ok());
    EXPECT_TRUE(session_->addBlob(otherMesh_).ok());
    EXPECT_TRUE(session_->addBlob(texture_).ok());
  }

  /// An object of which nothing but the mesh is given.
  Wire plainest(const std::string& name) const {
    Wire out;
    out.set_name(name);
    out.set_mesh(mesh_->hash);
    return out;
  }
  /// An object of which every field is given and none is at its default; by radiance, and the mesh by its hash.
  Wire other(const std::string& name) const {
    Wire out;
    out.set_name(name);
    TransformFields transform{glm::dvec3(1.0, 2.0, 3.0), glm::dquat(0.0, 1.0, 0.0, 0.0), glm::dvec3(2.0)};
    api::toProto(*withFields(Transform(), transform), out.mutable_transform());
    for (std::size_t i = 0; i < fieldTable<T>().size(); ++i) {
      const Field<T>& field = fieldTable<T>()[i];
      if (field.kind == FieldKind::kMesh) setText(&out, field.path, otherMesh_->hash);
      if (field.kind == FieldKind::kTexture) setText(&out, field.path, texture_->hash);
      if (field.kind == FieldKind::kPlain) api::writeField(otherThan(field.get(T())), api::wireFields<T>()[i], &out);
      if constexpr (std::is_same_v<T, Light>) {
        if (field.kind == FieldKind::kEmission) out.mutable_radiance()->set_y(7.0);
      }
    }
    return out;
  }

  void apply(const pb::Operation& operation) {
    pb::Edit edit;
    *edit.add_operations() = operation;
    const Expected<Edit> parsed = api::fromProto(edit, rig_.quick());
    ASSERT_TRUE(parsed.ok()) << parsed.status().message();
    const Status status = session_->apply(member_, *parsed).status;
    ASSERT_TRUE(status.ok()) << status.message();
  }
  void make(const Wire& object) {
    pb::Operation operation;
    if constexpr (std::is_same_v<T, Light>) *operation.mutable_create_light() = object;
    if constexpr (std::is_same_v<T, Surface>) *operation.mutable_create_surface() = object;
    apply(operation);
  }
  void update(const Wire& object, const std::string& path) {
    pb::Operation operation;
    const auto fill = [&](auto* update, Wire* target) {
      *target = object;
      update->mutable_update_mask()->add_paths(path);
    };
    if constexpr (std::is_same_v<T, Light>) {
      fill(operation.mutable_update_light(), operation.mutable_update_light()->mutable_light());
    } else {
      fill(operation.mutable_update_surface(), operation.mutable_update_surface()->mutable_surface());
    }
    apply(operation);
  }
  Wire told(const std::string& name) {
    Wire out;
    const auto take = [&](const auto& objects) {
      for (const auto& each : objects) {
        if (each.object->name == name) api::toProto(each, &out);
      }
    };
    if constexpr (std::is_same_v<T, Light>) take(session_->lights());
    if constexpr (std::is_same_v<T, Surface>) take(session_->surfaces());
    EXPECT_EQ(out.name(), name);
    return out;
  }
  FieldTexts texts(const std::string& name) { return settable<T>(told(name)); }

  /// Every path of an update mask.
  static Paths maskPaths() {
    Paths out = {"inline_mesh", "transform"};
    for (const Field<T>& field : fieldTable<T>()) out.insert(field.path);
    if (std::is_same_v<T, Light>) out.insert("power");
    return out;
  }
  /// What an update of `path` changes in the object as it is told.
  static Paths changedBy(const std::string& path) {
    if (path == "inline_mesh") return {"mesh"};
    if (path == "transform") return {"transform.rotation", "transform.scale", "transform.translation"};
    if (path == "power") return {"power", "radiance"};
    return {path};
  }

  const BlobPtr mesh_ = blobOf(pb::BLOB_KIND_MESH, api::meshBytes(*reference::quad()));
  const BlobPtr otherMesh_ = blobOf(pb::BLOB_KIND_MESH, api::meshBytes(scaledQuad()));
  const BlobPtr texture_ = onePixel();
  SessionPtr session_;
  ClientIdentity member_;

 private:
  static Mesh scaledQuad() {
    Mesh out = *reference::quad();
    for (glm::vec3& position : out.positions) position *= 2.0F;
    EXPECT_TRUE(finishMesh(out).ok());
    return out;
  }
};

using Kinds = testing::Types<Light, Surface>;
TYPED_TEST_SUITE(FieldsTest, Kinds);

// Red when a row is removed from a table or from the list above.
TYPED_TEST(FieldsTest, EveryFieldOfTheMessageIsInTheTableOrNotSettable) {
  Paths expected;
  for (const auto& [path, text] : settable<TypeParam>({})) expected.insert(path);
  Paths declared = this->maskPaths();
  declared.erase("transform");
  EXPECT_THAT(declared, UnorderedElementsAreArray(expected));
}

TYPED_TEST(FieldsTest, AMessageComesBackAsItWasSent) {
  this->make(this->plainest("Plainest"));
  auto again = this->told("Plainest");
  again.set_name("Again");
  this->make(again);
  EXPECT_EQ(this->texts("Again"), this->texts("Plainest"));
  this->make(this->other("Other"));
  EXPECT_EQ(this->texts("Other"), settable<TypeParam>(this->other("Other")));
}

TYPED_TEST(FieldsTest, AMaskChangesItsFieldAndNothingElseAndUndoTakesItBack) {
  this->make(this->plainest("Object"));
  const FieldTexts before = this->texts("Object");
  for (const std::string& path : this->maskPaths()) {
    auto given = this->other("Object");
    if (path == "inline_mesh") *given.mutable_inline_mesh() = api::meshToProto(*this->otherMesh_->mesh);
    if constexpr (std::is_same_v<TypeParam, Light>) {
      if (path == "power") given.mutable_power()->set_z(5.0);
    }
    const FieldTexts wanted = settable<TypeParam>(given);
    this->update(given, path);
    const FieldTexts after = this->texts("Object");
    const Paths changed = this->changedBy(path);
    EXPECT_EQ(differing(before, after), changed) << path;
    for (const std::string& each : changed) EXPECT_EQ(after.at(each), wanted.at(each)) << path;
    EXPECT_TRUE(this->session_->undoRedo(this->member_, 0, UndoDirection::kUndo).status.ok()) << path;
    EXPECT_THAT(differing(before, this->texts("Object")), IsEmpty()) << "undo of " << path;
    EXPECT_TRUE(this->session_->undoRedo(this->member_, 0, UndoDirection::kRedo).status.ok()) << path;
    EXPECT_EQ(this->texts("Object"), after) << "redo of " << path;
    this->session_->undoRedo(this->member_, 0, UndoDirection::kUndo);
  }
}

TYPED_TEST(FieldsTest, ARestartKeepsEveryField) {
  this->make(this->plainest("Plainest"));
  this->make(this->other("Other"));
  const FieldTexts plainest = this->texts("Plainest");
  const FieldTexts other = this->texts("Other");
  this->session_.reset();
  this->restart();
  this->session_ = this->find("hall");
  EXPECT_EQ(this->texts("Plainest"), plainest);
  EXPECT_EQ(this->texts("Other"), other);
}

TYPED_TEST(FieldsTest, AStoredObjectWithoutAFieldHasTheFieldsDefault) {
  auto object = std::make_shared<TypeParam>();
  object->name = "Object";
  object->mesh = this->mesh_->mesh;
  SavedSession state;
  state.document.grid = {glm::dvec3(0.0), 1.0, glm::ivec3(4)};
  constexpr bool kIsLight = std::is_same_v<TypeParam, Light>;
  if constexpr (kIsLight) state.document.lights.push_back({object, 0});
  if constexpr (!kIsLight) state.document.surfaces.push_back({object, 0});
  auto snapshot = api::toSnapshot(state);
  if constexpr (kIsLight) clearAbsentable<Light>(&snapshot.mutable_lights()->at("Object"));
  if constexpr (!kIsLight) clearAbsentable<Surface>(&snapshot.mutable_surfaces()->at("Object"));
  const Expected<SavedSession> back = api::fromStore({{}, snapshot, api::contentsOf(state)});
  ASSERT_TRUE(back.ok()) << back.status().message();
  api::MessageOf<TypeParam> before, after;
  api::toProto(Versioned<TypeParam>{object, 0}, &before);
  if constexpr (kIsLight) api::toProto(back->document.lights.at(0), &after);
  if constexpr (!kIsLight) api::toProto(back->document.surfaces.at(0), &after);
  EXPECT_EQ(settable<TypeParam>(after), settable<TypeParam>(before));
}

}  // namespace
}  // namespace lpv::test
