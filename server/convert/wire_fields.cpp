#include "convert/wire_fields.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "convert/geometry.h"

namespace lpv::api {
namespace {

using google::protobuf::FieldDescriptor;

bool isPlain(const FieldDescriptor* field) {
  if (!field || field->is_repeated()) return false;
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_STRING:
      return true;
    case FieldDescriptor::CPPTYPE_ENUM:
      return field->enum_type() == pb::AlphaMode_descriptor();
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return field->message_type() == pb::Vec3::descriptor();
    default:
      return false;
  }
}

}  // namespace

WireField wireField(const google::protobuf::Message& message, const char* path) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(path);
  if (isPlain(field)) return {message.GetReflection(), field, field->cpp_type(), field->has_presence()};
  std::fprintf(stderr, "%s has no bool, double, string, AlphaMode or Vec3 \"%s\"\n", message.GetTypeName().c_str(),
               path);
  std::abort();
}

FieldValue readField(const google::protobuf::Message& in, const WireField& field) {
  switch (field.type) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return field.reflection->GetBool(in, field.descriptor);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return field.reflection->GetDouble(in, field.descriptor);
    case FieldDescriptor::CPPTYPE_STRING:
      return field.reflection->GetString(in, field.descriptor);
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int mode = field.reflection->GetEnumValue(in, field.descriptor);
      return mode == pb::ALPHA_MODE_UNSPECIFIED ? AlphaMode::kOpaque : AlphaMode(mode);
    }
    default:
      return fromProto(static_cast<const pb::Vec3&>(field.reflection->GetMessage(in, field.descriptor)));
  }
}

void writeField(const FieldValue& value, const WireField& field, google::protobuf::Message* out) {
  switch (field.type) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return field.reflection->SetBool(out, field.descriptor, std::get<bool>(value));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return field.reflection->SetDouble(out, field.descriptor, std::get<double>(value));
    case FieldDescriptor::CPPTYPE_STRING:
      return field.reflection->SetString(out, field.descriptor, std::get<std::string>(value));
    case FieldDescriptor::CPPTYPE_ENUM:
      return field.reflection->SetEnumValue(out, field.descriptor, int(std::get<AlphaMode>(value)));
    default:
      toProto(std::get<glm::dvec3>(value),
              static_cast<pb::Vec3*>(field.reflection->MutableMessage(out, field.descriptor)));
  }
}

bool isPresent(const google::protobuf::Message& in, const WireField& field) {
  return field.reflection->HasField(in, field.descriptor);
}

}  // namespace lpv::api
