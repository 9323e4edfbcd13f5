#include "api/call/method_table.h"

#include <algorithm>
#include <string_view>

namespace lpv::api {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::MethodDescriptor;

namespace {

std::vector<Method> join(std::initializer_list<std::vector<Method>> services) {
  std::vector<Method> all;
  for (const std::vector<Method>& service : services) all.insert(all.end(), service.begin(), service.end());
  return all;
}

const char* kindOf(const MethodDescriptor& method) {
  if (method.client_streaming()) return method.server_streaming() ? "bidirectional" : "client stream";
  return method.server_streaming() ? "server stream" : "unary";
}

std::string orDash(const char* text) { return text == nullptr || *text == '\0' ? "-" : text; }

}  // namespace

const MethodDescriptor& Method::descriptor() const {
  const auto* pool = handler.request->GetDescriptor()->file()->pool();
  return *pool->FindMethodByName(std::string("lpv.v1.") + name);
}

std::string Method::path() const {
  const MethodDescriptor& method = descriptor();
  return "/" + method.service()->full_name() + "/" + method.name();
}

std::string textAt(const Message& message, const char* path) {
  const Message* at = &message;
  std::string_view rest(path);
  while (!rest.empty()) {
    const std::size_t dot = rest.find('.');
    const FieldDescriptor* field = at->GetDescriptor()->FindFieldByName(std::string(rest.substr(0, dot)));
    if (field == nullptr) return {};
    const google::protobuf::Reflection& reflection = *at->GetReflection();
    if (dot == std::string_view::npos) return reflection.GetString(*at, field);
    if (!reflection.HasField(*at, field)) return {};
    at = &reflection.GetMessage(*at, field);
    rest.remove_prefix(dot + 1);
  }
  return {};
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all =
      join({serverMethods(), sessionMethods(), blobMethods(), sceneMethods(), resultMethods()});
  return all;
}

const Method* methodOf(const google::protobuf::Descriptor& request) {
  const auto found = std::ranges::find_if(
      methods(), [&](const Method& method) { return method.handler.request->GetDescriptor() == &request; });
  return found == methods().end() ? nullptr : &*found;
}

std::string methodTableText() {
  std::string text;
  for (const Method& method : methods()) {
    text += std::string(method.name) + " | " + kindOf(method.descriptor()) + " | " + roleName(method.needs) + " | " +
            orDash(method.session) + " | " + orDash(method.audited) + "\n";
  }
  return text;
}

}  // namespace lpv::api
