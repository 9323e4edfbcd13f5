#include "convert/wire_fields.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "convert/geometry.h"

namespace lpv::api {
namespace {

using google::protobuf::FieldDescriptor;

bool isKnown(WireField field) {
  if (!field || field->is_repeated()) return false;
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_STRING:
      return true;
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return field->message_type() == pb::Vec3::descriptor();
    default:
      return false;
  }
}

}  // namespace

WireField wireField(const google::protobuf::Descriptor* message, const char* path) {
  const WireField field = message->FindFieldByName(path);
  if (isKnown(field)) return field;
  std::fprintf(stderr, "%s has no bool, double, string or Vec3 \"%s\"\n", message->full_name().c_str(), path);
  std::abort();
}

FieldValue readField(const google::protobuf::Message& in, WireField field) {
  const google::protobuf::Reflection& reflection = *in.GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.GetBool(in, field);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.GetDouble(in, field);
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection.GetString(in, field);
    default:
      return fromProto(static_cast<const pb::Vec3&>(reflection.GetMessage(in, field)));
  }
}

void writeField(const FieldValue& value, WireField field, google::protobuf::Message* out) {
  const google::protobuf::Reflection& reflection = *out->GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.SetBool(out, field, std::get<bool>(value));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.SetDouble(out, field, std::get<double>(value));
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection.SetString(out, field, std::get<std::string>(value));
    default:
      toProto(std::get<glm::dvec3>(value), static_cast<pb::Vec3*>(reflection.MutableMessage(out, field)));
  }
}

bool hasOwnDefault(WireField field) {
  return field->has_presence() && field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE;
}

bool isPresent(const google::protobuf::Message& in, WireField field) { return in.GetReflection()->HasField(in, field); }

}  // namespace lpv::api
