#pragma once
// Plain fields of lights and surfaces (scene/fields.h) in their messages: found
// by name, so that a field needs no line here.

#include <google/protobuf/message.h>

#include <array>

#include "lpv/v1/scene.pb.h"
#include "scene/fields.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// The message of a T.
template <typename T>
using MessageOf = std::conditional_t<std::is_same_v<T, Light>, pb::Light, pb::Surface>;

/// Where a plain field stands in its message; aborts where it does not, or is
/// of another type than bool, double, string or Vec3.
using WireField = const google::protobuf::FieldDescriptor*;
WireField wireField(const google::protobuf::Descriptor* message, const char* path);

/// The value in the message; what is absent is proto's default, a Vec3 then 0.
FieldValue readField(const google::protobuf::Message& in, WireField field);
void writeField(const FieldValue& value, WireField field, google::protobuf::Message* out);
/// Whether the message says something of the field: it is present or, without
/// presence, differs from proto's default.
bool saysField(const google::protobuf::Message& in, WireField field);

/// Whether an absent value can be told from proto's default, so that the field
/// can have a default of its own.
bool hasOwnDefault(WireField field);

/// Of each field of the table its place in the message; null but for plain
/// ones.
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

/// Gives all plain values of the message, present or not.
template <typename T>
void givePlain(const MessageOf<T>& in, FieldsOf<T>* out) {
  for (std::size_t i = 0; i < wireFields<T>().size(); ++i) {
    if (const WireField place = wireFields<T>()[i]) fieldTable<T>()[i].give(*out, readField(in, place));
  }
}

/// Writes all plain values of the object.
template <typename T>
void writePlain(const T& object, MessageOf<T>* out) {
  for (std::size_t i = 0; i < wireFields<T>().size(); ++i) {
    if (const WireField place = wireFields<T>()[i]) writeField(fieldTable<T>()[i].get(object), place, out);
  }
}

} // namespace lpv::api
