#pragma once
// The wire, raw: generated stubs, statuses with their details, and small scenes to send.

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <glm/glm.hpp>
#include <initializer_list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "lpv/client.h"
#include "lpv/edits.h"
#include "lpv/v1/blob.grpc.pb.h"
#include "lpv/v1/result.grpc.pb.h"
#include "lpv/v1/scene.grpc.pb.h"
#include "lpv/v1/server.grpc.pb.h"
#include "lpv/v1/session.grpc.pb.h"
#include "rpc/support/child_process.h"

namespace grpc {
void PrintTo(const Status& status, std::ostream* out);
}

namespace lpv::rpc {

namespace pb = lpv::v1;
using grpc::StatusCode;

/// The services over one connection of their own.
struct Stubs {
  explicit Stubs(const std::string& address, grpc::ChannelArguments arguments = {});
  explicit Stubs(std::shared_ptr<grpc::Channel> existing);
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<pb::ServerService::Stub> server;
  std::unique_ptr<pb::SessionService::Stub> session;
  std::unique_ptr<pb::BlobService::Stub> blob;
  std::unique_ptr<pb::SceneService::Stub> scene;
  std::unique_ptr<pb::ResultService::Stub> result;
};

/// The context of one call. Its deadline ends a hang; it measures nothing.
class Call {
 public:
  explicit Call(std::chrono::seconds patience = std::chrono::seconds(60)) {
    context_.set_deadline(std::chrono::system_clock::now() + patience);
  }
  operator grpc::ClientContext*() { return &context_; }  // NOLINT(google-explicit-constructor): reads as the context
  grpc::ClientContext* operator->() { return &context_; }

 private:
  grpc::ClientContext context_;
};

/// The field that a refusal blames (FieldViolation in grpc-status-details-bin); empty where it names none.
std::string fieldOf(const grpc::Status& status);
std::string fieldOf(const pb::Status& status);

/// A refusal with this code, this field and this text in its message.
MATCHER_P3(Refused, code, field, text, "") {
  *result_listener << "with the field \"" << fieldOf(arg) << "\"";
  return arg.error_code() == code && fieldOf(arg) == field && arg.error_message().find(text) != std::string::npos;
}
MATCHER_P(HasCode, code, "") { return arg.error_code() == code; }
MATCHER(IsOk, "") { return arg.ok(); }

/// Numbers as the wire packs them.
template <typename T>
std::string packed(std::initializer_list<T> numbers) {
  return std::string(reinterpret_cast<const char*>(numbers.begin()), numbers.size() * sizeof(T));
}
std::string packed(const std::vector<float>& numbers);

/// Lower-case hexadecimal SHA-256, not by the library under test.
std::string sha256(const std::string& bytes);

pb::Vec3 vec3(double x, double y, double z);
/// A square in the plane z = 0 that emits towards +z.
pb::Mesh quad(float halfEdge = 0.25F);
/// `side` x `side` vertices in the plane z = 0, triangulated.
pb::Mesh sheet(int side);
pb::Light light(const std::string& name, const pb::Mesh& mesh = quad());
pb::Surface surface(const std::string& name, const pb::Mesh& mesh = quad());
/// Puts a light elsewhere.
pb::Operation moveTo(const std::string& light, const glm::dvec3& translation);
pb::Camera camera(const glm::dvec3& eye, const glm::dvec3& target);

/// Settings with `cells` cells over the box of -1..1 m.
pb::SessionSettings settings(int cells = 8);
/// The same as the paper transports light: PROPAGATE, and what belongs to it.
pb::SessionSettings propagating(pb::SessionSettings settings = rpc::settings());
/// A new session's name, "sessions/...".
std::string makeSession(Stubs& stubs, const pb::SessionSettings& settings = rpc::settings());
/// A new session with a light "Lamp" at its middle.
std::string makeLitSession(Stubs& stubs, int cells = 8);
pb::Session getSession(Stubs& stubs, const std::string& session);
pb::ClientIdentity join(Stubs& stubs, const std::string& session);

/// One edit without identity.
grpc::Status tryEdit(Stubs& stubs, const std::string& session, const pb::Edit& edit, pb::EditAck* ack = nullptr,
                     const pb::ClientIdentity& client = {});
/// The same, which has to succeed.
pb::EditAck apply(Stubs& stubs, const std::string& session, const std::vector<pb::Operation>& operations);
pb::Light findLight(Stubs& stubs, const std::string& session, const std::string& name);

/// Sends a blob in parts of `partBytes`.
grpc::Status upload(Stubs& stubs, const std::string& session, pb::BlobKind kind, const std::string& bytes,
                    pb::UploadBlobResponse* response = nullptr, std::size_t partBytes = 1000 * 1000);

/// Irradiance at points, each position and normal; NaN where the volume cannot tell. Fails the test on an error.
std::vector<glm::dvec3> probe(Stubs& stubs, const std::string& session,
                              const std::vector<std::pair<glm::dvec3, glm::dvec3>>& points);

client::Client clientOf(const std::string& address);

/// Polls until `true`, for at most kPatience.
template <typename Condition>
bool eventually(Condition condition) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace lpv::rpc
