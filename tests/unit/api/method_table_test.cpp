// The method table against the .proto files, and as people read it.

#include "api/call/method_table.h"

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "api/services.h"

namespace lpv::api {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

constexpr const char* kTable = R"(ServerService.GetServerInfo | unary | viewer | - | -
ServerService.GetStats | unary | admin | - | -
SessionService.CreateSession | unary | admin | session_id | create
SessionService.GetSession | unary | viewer | name | -
SessionService.ListSessions | unary | viewer | - | -
SessionService.UpdateSession | unary | editor | session.name | -
SessionService.DeleteSession | unary | owner | name | delete
SessionService.FitSession | unary | editor | name | -
SessionService.JoinSession | unary | viewer | session | -
SessionService.LeaveSession | unary | viewer | session | -
SessionService.UpdatePresence | unary | viewer | session | -
SessionService.CreateToken | unary | owner | session | share
SessionService.RevokeToken | unary | owner | session | revoke
SessionService.ListTokens | unary | owner | session | tokens
SessionService.ExportSession | server stream | viewer | name | -
SessionService.ImportSession | client stream | admin | session_id | import
BlobService.UploadBlob | client stream | editor | header.session | -
BlobService.FindBlobs | unary | editor | session | -
BlobService.ReadBlob | server stream | viewer | session | -
SceneService.ApplyEdit | unary | editor | session | -
SceneService.StreamEdits | bidirectional | editor | session | -
SceneService.WatchScene | server stream | viewer | session | -
SceneService.ListLights | unary | viewer | session | -
SceneService.ListSurfaces | unary | viewer | session | -
SceneService.ListCameras | unary | viewer | session | -
SceneService.Undo | unary | editor | session | -
SceneService.Redo | unary | editor | session | -
SceneService.LockObjects | unary | editor | session | -
ResultService.WatchVolume | server stream | viewer | subscription.session | -
ResultService.StreamVolume | bidirectional | viewer | subscription.session | -
ResultService.WatchFrames | server stream | viewer | subscription.session | -
ResultService.StreamFrames | bidirectional | viewer | subscription.session | -
ResultService.UpdateSubscription | unary | viewer | session | -
ResultService.GetVolume | server stream | viewer | session | -
ResultService.GetFrame | server stream | viewer | session | -
ResultService.Probe | unary | viewer | session | -
ResultService.StreamProbe | bidirectional | viewer | request.session | -
ResultService.Pick | unary | viewer | session | -
)";

/// Line by line, so that a difference is one line of output.
std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// A new method gets its line here: who may call it is read by people.
TEST(MethodTableTest, IsWhatPeopleHaveRead) { EXPECT_EQ(linesOf(methodTableText()), linesOf(kTable)); }

TEST(MethodTableTest, HasOneRowForEachMethodOfTheServices) {
  std::map<std::string, int> rows;
  for (const Method& method : methods()) {
    ++rows[method.descriptor().full_name()];
    EXPECT_EQ(method.handler.request->GetDescriptor(), method.descriptor().input_type()) << method.name;
    EXPECT_EQ(method.handler.response->GetDescriptor(), method.descriptor().output_type()) << method.name;
    EXPECT_EQ(methodOf(*method.descriptor().input_type()), &method) << method.name;
  }
  std::map<std::string, int> declared;
  for (const Descriptor* one :
       {pb::GetStatsRequest::descriptor(), pb::GetSessionRequest::descriptor(), pb::ReadBlobRequest::descriptor(),
        pb::UndoRequest::descriptor(), pb::PickRequest::descriptor()}) {
    for (int i = 0; i < one->file()->service_count(); ++i) {
      const auto* service = one->file()->service(i);
      for (int j = 0; j < service->method_count(); ++j) ++declared[service->method(j)->full_name()];
    }
  }
  EXPECT_EQ(rows, declared);
}

/// Whether `path` leads through messages of this type to a text.
bool leadsToText(const Descriptor* type, const std::string& path) {
  std::istringstream in(path);
  const FieldDescriptor* field = nullptr;
  for (std::string name; std::getline(in, name, '.');) {
    if (field != nullptr) type = field->message_type();
    field = type == nullptr ? nullptr : type->FindFieldByName(name);
    if (field == nullptr) return false;
  }
  return field == nullptr || (field->type() == FieldDescriptor::TYPE_STRING && !field->is_repeated());
}

TEST(MethodTableTest, FindsSessionsInFieldsThatExist) {
  for (const Method& method : methods()) {
    EXPECT_TRUE(leadsToText(method.descriptor().input_type(), method.session)) << method.name;
    EXPECT_TRUE(leadsToText(method.descriptor().output_type(), method.made)) << method.name;
  }
}

TEST(MethodTableTest, ReadsTheTextAtAPath) {
  pb::WatchVolumeRequest request;
  EXPECT_EQ(textAt(request, "subscription.session"), "") << "nothing is set";
  request.mutable_subscription()->set_session("sessions/room");
  EXPECT_EQ(textAt(request, "subscription.session"), "sessions/room");
  EXPECT_EQ(textAt(request, ""), "");
}

}  // namespace
}  // namespace lpv::api
