#pragma once
// Every method of lpv.v1, one row each. A service's rows stand below its handlers, in *_service.cpp.

#include <string>
#include <vector>

#include "api/call/method.h"

namespace lpv::api {

std::vector<Method> serverMethods();
std::vector<Method> sessionMethods();
std::vector<Method> blobMethods();
std::vector<Method> sceneMethods();
std::vector<Method> resultMethods();

/// All of them, service by service, in the order of the .proto files. Lives as long as the process.
const std::vector<Method>& methods();
/// The row whose request has this type; null where there is none. Every request type belongs to one method.
const Method* methodOf(const google::protobuf::Descriptor& request);
/// The table for people and tests: a line per method with kind, least role, session field and audit verb.
std::string methodTableText();

}  // namespace lpv::api
