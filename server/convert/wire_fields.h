#pragma once
// Plain fields of lights and surfaces (scene/fields.h) in their messages, found by name: a new field needs no line
// here.

#include <google/protobuf/message.h>

#include <array>

#include "lpv/v1/scene.pb.h"
#include "scene/fields.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// The message of a T.
template <typename T>
using MessageOf = std::conditional_t<std::is_same_v<T, Light>, pb::Light, pb::Surface>;

/// A plain field in its message: what reflection needs, looked up once.
struct WireField {
  const google::protobuf::Reflection* reflection = nullptr;
  const google::protobuf::FieldDescriptor* descriptor = nullptr;  ///< null: not a plain field
  google::protobuf::FieldDescriptor::CppType type{};
  bool canBeAbsent = false;  ///< told from proto's default

  explicit operator bool() const { return descriptor != nullptr; }
  /// Whether the default can differ from proto's: an absent Vec3 in an update is 0, 0, 0.
  bool hasOwnDefault() const { return canBeAbsent && type != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE; }
};

/// The field `path` of messages like `message`; aborts if there is none, or its type is none of bool, double, string,
/// AlphaMode and Vec3.
WireField wireField(const google::protobuf::Message& message, const char* path);

/// The value in the message; an absent one is proto's default, an absent Vec3 0, 0, 0.
FieldValue readField(const google::protobuf::Message& in, const WireField& field);
void writeField(const FieldValue& value, const WireField& field, google::protobuf::Message* out);
/// Whether the field is set; one that cannot be absent is if it differs from proto's default.
bool isPresent(const google::protobuf::Message& in, const WireField& field);

/// The table's fields in their message; null those that are not plain.
template <typename T>
const auto& wireFields() {
  static const auto places = [] {
    std::array<WireField, fieldTable<T>().size()> out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Field<T>& field = fieldTable<T>()[i];
      if (field.kind == FieldKind::kPlain) out[i] = wireField(MessageOf<T>::default_instance(), field.path);
    }
    return out;
  }();
  return places;
}

/// Takes the plain values of a stored message. A field that can be absent and is (the message may be older than the
/// field) is not taken, so that the object keeps its default.
template <typename T>
void takeStored(const MessageOf<T>& in, FieldsOf<T>* out) {
  const auto& places = wireFields<T>();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i] || (places[i].canBeAbsent && !isPresent(in, places[i]))) continue;
    fieldTable<T>()[i].give(*out, readField(in, places[i]));
  }
}

/// Writes all plain values of the object.
template <typename T>
void writePlain(const T& object, MessageOf<T>* out) {
  const auto& places = wireFields<T>();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i]) writeField(fieldTable<T>()[i].get(object), places[i], out);
  }
}

}  // namespace lpv::api
