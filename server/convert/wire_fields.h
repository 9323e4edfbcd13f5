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

/// The descriptor of a plain field in its message; aborts if there is none, or its type is none of bool, double, string
/// and Vec3.
using WireField = const google::protobuf::FieldDescriptor*;
WireField wireField(const google::protobuf::Descriptor* message, const char* path);

/// The value in the message; an absent one is proto's default, an absent Vec3 0, 0, 0.
FieldValue readField(const google::protobuf::Message& in, WireField field);
void writeField(const FieldValue& value, WireField field, google::protobuf::Message* out);
/// Whether the field is set; one without presence is if it differs from proto's default.
bool isPresent(const google::protobuf::Message& in, WireField field);
/// Whether a field that is no message can be absent, so that its default can differ from proto's.
bool hasOwnDefault(WireField field);

/// The descriptor of each field of the table; null for those that are not plain.
template <typename T>
const auto& wireFields() {
  static const auto places = [] {
    std::array<WireField, fieldTable<T>().size()> out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Field<T>& field = fieldTable<T>()[i];
      if (field.kind == FieldKind::kPlain) out[i] = wireField(MessageOf<T>::descriptor(), field.path);
    }
    return out;
  }();
  return places;
}

/// Takes the plain values of a stored message. A field that can be absent and is (the message may be older than the
/// field) is not taken, so that the object keeps its default.
template <typename T>
void takeStored(const MessageOf<T>& in, FieldsOf<T>* out) {
  for (std::size_t i = 0; i < wireFields<T>().size(); ++i) {
    const WireField place = wireFields<T>()[i];
    if (!place || (place->has_presence() && !isPresent(in, place))) continue;
    fieldTable<T>()[i].give(*out, readField(in, place));
  }
}

/// Writes all plain values of the object.
template <typename T>
void writePlain(const T& object, MessageOf<T>* out) {
  for (std::size_t i = 0; i < wireFields<T>().size(); ++i) {
    if (const WireField place = wireFields<T>()[i]) writeField(fieldTable<T>()[i].get(object), place, out);
  }
}

}  // namespace lpv::api
