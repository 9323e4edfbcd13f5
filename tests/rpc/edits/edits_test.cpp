// Edits: all or nothing, names, masks, transforms, sequences, many writers.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <thread>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::HasSubstr;

class Edits : public ::testing::Test {
 protected:
  grpc::Status edit(const std::vector<pb::Operation>& operations, pb::EditAck* ack = nullptr) {
    return tryEdit(stubs_, session_, client::editOf(operations), ack);
  }
  std::uint64_t revision() { return getSession(stubs_, session_).revision(); }

  Stubs stubs_{server().address()};
  std::string session_ = makeSession(stubs_);
};

using EditsStream = grpc::ClientReaderWriter<pb::StreamEditsRequest, pb::StreamEditsResponse>;

/// The next acknowledgement; heartbeats are passed over.
pb::EditAck nextAck(EditsStream& stream) {
  pb::StreamEditsResponse response;
  while (stream.Read(&response)) {
    if (response.has_ack()) return response.ack();
  }
  ADD_FAILURE() << "the stream ended";
  return {};
}

pb::StreamEditsRequest streamed(std::uint64_t sequence, const std::vector<pb::Operation>& operations) {
  pb::StreamEditsRequest request;
  *request.mutable_edit() = client::editOf(operations);
  request.mutable_edit()->set_sequence(sequence);
  return request;
}

TEST_F(Edits, AreAllOrNothing) {
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  pb::EditAck ack;
  const grpc::Status status = edit(
      {client::setRadiance("Lamp", {9, 9, 9}), client::deleteLight("Nobody"), client::createSurface(surface("Wall"))},
      &ack);
  EXPECT_THAT(status, HasCode(StatusCode::NOT_FOUND));
  EXPECT_THAT(fieldOf(status), HasSubstr("edit.operations[1].delete_light"));
  EXPECT_EQ(revision(), 1U);
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "Lamp").radiance().x(), 1.0);
  EXPECT_EQ(getSession(stubs_, session_).surface_count(), 0);
  // The same with a deletion and a creation in front: both are taken back.
  EXPECT_THAT(edit({client::deleteLight("Lamp"), client::createLight(light("Other")), client::deleteSurface("Nobody")}),
              HasCode(StatusCode::NOT_FOUND));
  EXPECT_EQ(revision(), 1U);
  EXPECT_EQ(findLight(stubs_, session_, "Lamp").status().revision(), 1U);
  EXPECT_EQ(getSession(stubs_, session_).light_count(), 1);
}

TEST_F(Edits, GiveATakenNameANumber) {
  pb::EditAck ack = apply(
      stubs_, session_,
      {client::createLight(light("Lamp")), client::createLight(light("Lamp")), client::createSurface(surface("Lamp"))});
  EXPECT_THAT(ack.names(), ::testing::ElementsAre("Lamp", "Lamp.001", "Lamp.002"));
  EXPECT_EQ(ack.revision(), 1U);
  EXPECT_EQ(ack.durability(), pb::DURABILITY_MEMORY);
  apply(stubs_, session_, {client::deleteLight("Lamp.001")});
  ack = apply(stubs_, session_, {client::createLight(light("Lamp"))});
  EXPECT_THAT(ack.names(), ::testing::ElementsAre("Lamp.001"));
}

TEST_F(Edits, ChangeOnlyWhatTheMaskNames) {
  pb::Light lamp = light("Lamp");
  lamp.set_two_sided(true);
  *lamp.mutable_transform()->mutable_translation() = vec3(0.1, 0.2, 0.3);
  apply(stubs_, session_, {client::createLight(lamp)});
  pb::Light change;
  change.set_name("Lamp");
  *change.mutable_radiance() = vec3(2, 3, 4);
  *change.mutable_transform()->mutable_scale() = vec3(2, 2, 2);
  change.set_enabled(false);
  apply(stubs_, session_, {client::updateLight(change, {"radiance", "transform.scale"})});
  const pb::Light after = findLight(stubs_, session_, "Lamp");
  EXPECT_DOUBLE_EQ(after.radiance().z(), 4.0);
  EXPECT_DOUBLE_EQ(after.transform().scale().y(), 2.0);
  EXPECT_DOUBLE_EQ(after.transform().translation().z(), 0.3);
  EXPECT_TRUE(after.two_sided());
  EXPECT_TRUE(after.enabled());
  EXPECT_THAT(edit({client::updateLight(change, {})}),
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations[0].update_light.update_mask", "no field"));
  EXPECT_THAT(edit({client::updateLight(change, {"colour"})}),
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations[0].update_light.update_mask", "colour"));
  EXPECT_EQ(revision(), 2U);
  // A masked field that the message leaves out goes back to its default.
  pb::Light bare;
  bare.set_name("Lamp");
  apply(stubs_, session_, {client::updateLight(bare, {"transform.translation", "two_sided"})});
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "Lamp").transform().translation().z(), 0.0);
  EXPECT_FALSE(findLight(stubs_, session_, "Lamp").two_sided());
}

TEST_F(Edits, TakeAMatrixForTheThreeFields) {
  pb::Light lamp = light("Lamp");
  // A quarter turn about y, scaled by 2, 3, 4, moved; column-major.
  for (const double m : {0.0, 0.0, -2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.5, 0.25, -0.5, 1.0}) {
    lamp.mutable_transform()->add_matrix(m);
  }
  apply(stubs_, session_, {client::createLight(lamp)});
  const pb::Transform t = findLight(stubs_, session_, "Lamp").transform();
  EXPECT_NEAR(t.scale().x(), 2.0, 1e-12);
  EXPECT_NEAR(t.scale().y(), 3.0, 1e-12);
  EXPECT_NEAR(t.scale().z(), 4.0, 1e-12);
  EXPECT_NEAR(std::abs(t.rotation().y()), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(std::abs(t.rotation().w()), std::sqrt(0.5), 1e-12);
  EXPECT_DOUBLE_EQ(t.translation().z(), -0.5);
  EXPECT_EQ(t.matrix_size(), 0);
  lamp.mutable_transform()->set_matrix(1, 1.0);  // x leans into y
  const grpc::Status shear = edit({client::createLight(lamp)});
  EXPECT_THAT(shear,
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations[0].create_light.transform.matrix", "shear"));
  *lamp.mutable_transform()->mutable_scale() = vec3(1, 1, 1);
  EXPECT_THAT(edit({client::createLight(lamp)}), HasCode(StatusCode::INVALID_ARGUMENT)) << "both forms at once";
}

TEST_F(Edits, AbortWhereTheRevisionIsAnother) {
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  pb::Edit wanted = client::editOf({client::setRadiance("Lamp", {2, 2, 2})});
  wanted.set_expected_revision(0);
  EXPECT_THAT(tryEdit(stubs_, session_, wanted),
              Refused(StatusCode::ABORTED, "edit.expected_revision", "is at revision 1"));
  wanted.set_expected_revision(1);
  EXPECT_THAT(tryEdit(stubs_, session_, wanted), IsOk());
  EXPECT_EQ(revision(), 2U);
}

// Seen to fail when a sequence is not looked up, and when an outcome is not recorded.
TEST_F(Edits, ARepeatedSequenceReturnsItsFirstOutcome) {
  const pb::ClientIdentity me = join(stubs_, session_);
  pb::Edit create = client::editOf({client::createLight(light("Lamp"))});
  create.set_sequence(1);
  pb::EditAck first;
  ASSERT_THAT(tryEdit(stubs_, session_, create, &first, me), IsOk());
  pb::Edit bad = client::editOf({client::deleteLight("Nobody")});
  bad.set_sequence(2);
  const grpc::Status refused = tryEdit(stubs_, session_, bad, nullptr, me);
  EXPECT_THAT(refused, HasCode(StatusCode::NOT_FOUND));
  apply(stubs_, session_, {client::setRadiance("Lamp", {2, 2, 2})});
  pb::EditAck again;
  ASSERT_THAT(tryEdit(stubs_, session_, create, &again, me), IsOk());
  EXPECT_EQ(again.SerializeAsString(), first.SerializeAsString());
  EXPECT_EQ(getSession(stubs_, session_).light_count(), 1);
  pb::Edit different = client::editOf({client::setRadiance("Lamp", {3, 3, 3})});
  different.set_sequence(2);
  const grpc::Status repeated = tryEdit(stubs_, session_, different, nullptr, me);
  EXPECT_EQ(repeated.error_message(), refused.error_message());
  EXPECT_EQ(revision(), 2U);
  // On a stream the same memory answers.
  Call call;
  const auto stream = stubs_.scene->StreamEdits(call);
  pb::StreamEditsRequest request = streamed(1, {client::createLight(light("Lamp"))});
  request.set_session(session_);
  *request.mutable_client() = me;
  ASSERT_TRUE(stream->Write(request));
  EXPECT_EQ(nextAck(*stream).SerializeAsString(), first.SerializeAsString());
  EXPECT_EQ(revision(), 2U);
}

TEST_F(Edits, ARejectedEditDoesNotEndTheStream) {
  const pb::ClientIdentity me = join(stubs_, session_);
  Call call;
  const auto stream = stubs_.scene->StreamEdits(call);
  pb::StreamEditsRequest opening;
  opening.set_session(session_);
  *opening.mutable_client() = me;
  ASSERT_TRUE(stream->Write(opening));
  ASSERT_TRUE(stream->Write(streamed(1, {client::createLight(light("Lamp"))})));
  ASSERT_TRUE(stream->Write(streamed(2, {client::deleteLight("Nobody")})));
  pb::Light unlit;
  unlit.set_name("Lamp");
  *unlit.mutable_radiance() = vec3(-1, 0, 0);
  ASSERT_TRUE(stream->Write(streamed(3, {client::updateLight(unlit, {"radiance"})})));
  ASSERT_TRUE(stream->Write(streamed(4, {client::setRadiance("Lamp", {5, 5, 5})})));
  EXPECT_EQ(nextAck(*stream).revision(), 1U);
  const pb::EditAck missing = nextAck(*stream);
  EXPECT_EQ(missing.sequence(), 2U);
  EXPECT_EQ(missing.status().code(), int(StatusCode::NOT_FOUND));
  EXPECT_EQ(missing.revision(), 1U) << "the current revision";
  const pb::EditAck negative = nextAck(*stream);
  EXPECT_EQ(negative.status().code(), int(StatusCode::INVALID_ARGUMENT));
  EXPECT_EQ(fieldOf(negative.status()), "edit.operations[0].update_light.light.radiance");
  const pb::EditAck last = nextAck(*stream);
  EXPECT_EQ(last.sequence(), 4U);
  EXPECT_EQ(last.status().code(), 0);
  EXPECT_EQ(last.revision(), 2U);
  stream->WritesDone();
  pb::StreamEditsResponse rest;
  while (stream->Read(&rest)) EXPECT_TRUE(rest.has_heartbeat());
  EXPECT_THAT(stream->Finish(), IsOk());
}

TEST_F(Edits, OfManyWritersFormOneOrder) {
  constexpr int kEach = 60;
  apply(stubs_, session_, {client::createLight(light("A")), client::createLight(light("B"))});
  const auto write = [&](const std::string& name, std::vector<std::uint64_t>* revisions) {
    Stubs own(server().address());
    const pb::ClientIdentity me = join(own, session_);
    Call call;
    const auto stream = own.scene->StreamEdits(call);
    for (int i = 1; i <= kEach; ++i) {
      pb::StreamEditsRequest request = streamed(std::uint64_t(i), {client::setRadiance(name, {double(i), 0, 0})});
      if (i == 1) {
        request.set_session(session_);
        *request.mutable_client() = me;
      }
      stream->Write(request);
    }
    for (int i = 1; i <= kEach; ++i) {
      const pb::EditAck ack = nextAck(*stream);
      EXPECT_EQ(ack.sequence(), std::uint64_t(i)) << "acknowledged in order";
      EXPECT_EQ(ack.status().code(), 0) << ack.status().message();
      revisions->push_back(ack.revision());
    }
  };
  std::vector<std::uint64_t> a;
  std::vector<std::uint64_t> b;
  std::thread other(write, "B", &b);
  write("A", &a);
  other.join();
  EXPECT_TRUE(std::is_sorted(a.begin(), a.end()));
  EXPECT_TRUE(std::is_sorted(b.begin(), b.end()));
  std::set<std::uint64_t> all(a.begin(), a.end());
  all.insert(b.begin(), b.end());
  ASSERT_EQ(all.size(), std::size_t(2 * kEach));
  EXPECT_EQ(*all.begin(), 2U);
  EXPECT_EQ(*all.rbegin(), std::uint64_t(2 * kEach + 1));
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "A").radiance().x(), double(kEach));
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "B").radiance().x(), double(kEach));
}

TEST_F(Edits, SetVerticesDeformsWhatIsThere) {
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  const std::string before = findLight(stubs_, session_, "Lamp").mesh();
  const std::vector<glm::vec3> larger = {{-0.5F, -0.5F, 0}, {0.5F, -0.5F, 0}, {0.5F, 0.5F, 0}, {-0.5F, 0.5F, 0}};
  apply(stubs_, session_, {client::setVertices("Lamp", larger)});
  const pb::Light after = findLight(stubs_, session_, "Lamp");
  EXPECT_NE(after.mesh(), before);
  EXPECT_NEAR(after.status().area(), 1.0, 1e-6);
  EXPECT_THAT(edit({client::setVertices("Lamp", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}),
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations[0].set_vertices.positions", "4"));
  std::vector<glm::vec3> broken = larger;
  broken[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(edit({client::setVertices("Lamp", broken)}),
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations[0].set_vertices.positions", "positions[2]"));
  EXPECT_THAT(edit({client::setVertices("Nobody", larger)}), HasCode(StatusCode::NOT_FOUND));
  EXPECT_EQ(revision(), 2U);
  // Of an object made by the same edit, and twice in one edit.
  apply(stubs_, session_, {client::createSurface(surface("Wall")), client::setVertices("Wall", larger)});
  apply(stubs_, session_, {client::setVertices("Lamp", larger), client::setVertices("Lamp", larger)});
  EXPECT_EQ(findLight(stubs_, session_, "Lamp").mesh(), after.mesh()) << "equal content, equal name";
}

TEST_F(Edits, ALightTakesAnotherMeshByItsHash) {
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  pb::UploadBlobResponse uploaded;
  ASSERT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, sheet(5).SerializeAsString(), &uploaded), IsOk());
  apply(stubs_, session_, {client::setLightMesh("Lamp", uploaded.hash())});
  const pb::Light lamp = findLight(stubs_, session_, "Lamp");
  EXPECT_EQ(lamp.mesh(), uploaded.hash());
  EXPECT_EQ(lamp.status().triangle_count(), 32);
  const grpc::Status unknown = edit({client::setLightMesh("Lamp", std::string(64, '0'))});
  EXPECT_THAT(unknown, Refused(StatusCode::NOT_FOUND, "edit.operations[0].update_light.light.mesh", "UploadBlob"));
  EXPECT_EQ(findLight(stubs_, session_, "Lamp").mesh(), uploaded.hash());
}

TEST_F(Edits, PowerFollowsTheArea) {
  pb::Light lamp = light("Lamp");
  *lamp.mutable_power() = vec3(3, 2, 1);
  apply(stubs_, session_, {client::createLight(lamp)});
  const std::vector<std::pair<glm::dvec3, glm::dvec3>> place = {{{0, 0, 0.5}, {0, 0, -1}}};
  const glm::dvec3 asPower = probe(stubs_, session_, place)[0];
  ASSERT_GT(asPower.x, 0.0);
  EXPECT_NEAR(asPower.x / asPower.z, 3.0, 1e-4);
  // 0.5 x 0.5 m: radiance = power / (pi area).
  const double perWatt = 1.0 / (3.14159265358979 * 0.25);
  apply(stubs_, session_, {client::setRadiance("Lamp", glm::dvec3(3, 2, 1) * perWatt)});
  EXPECT_TRUE(findLight(stubs_, session_, "Lamp").has_radiance());
  EXPECT_NEAR(probe(stubs_, session_, place)[0].x / asPower.x, 1.0, 1e-5);
  // A larger lamp of the same power is dimmer per area.
  pb::Light change = lamp;
  change.set_name("Lamp");
  *change.mutable_transform()->mutable_scale() = vec3(2, 2, 1);
  apply(stubs_, session_, {client::updateLight(change, {"power", "transform.scale"})});
  EXPECT_NEAR(findLight(stubs_, session_, "Lamp").status().area(), 1.0, 1e-6);
  change.mutable_radiance();
  EXPECT_THAT(edit({client::updateLight(change, {"power", "radiance"})}), HasCode(StatusCode::INVALID_ARGUMENT));
}

// Broken by: nine allowed; a group that goes when an edit does not name it.
TEST_F(Edits, PutLightsInUpToEightGroups) {
  pb::Light lamp = light("Lamp");
  lamp.set_group("group 0");
  apply(stubs_, session_, {client::createLight(lamp)});
  EXPECT_EQ(findLight(stubs_, session_, "Lamp").group(), "group 0");
  lamp.set_group("ceiling");
  apply(stubs_, session_, {client::updateLight(lamp, {"group"}), client::setRadiance("Lamp", {2, 2, 2})});
  EXPECT_EQ(findLight(stubs_, session_, "Lamp").group(), "ceiling");
  for (int i = 1; i < 8; ++i) {
    lamp.set_group("group " + std::to_string(i));
    apply(stubs_, session_, {client::createLight(lamp)});
  }
  lamp.set_group("a ninth");
  EXPECT_THAT(edit({client::createLight(lamp)}),
              Refused(StatusCode::RESOURCE_EXHAUSTED, "edit.max_groups", "\"a ninth\""));
  lamp.set_name("Lamp");
  apply(stubs_, session_, {client::updateLight(lamp, {"group"})});  // its old group has no other light
  lamp.set_group("");
  apply(stubs_, session_, {client::updateLight(lamp, {"group"})});
  EXPECT_EQ(findLight(stubs_, session_, "Lamp").group(), "");
  EXPECT_EQ(revision(), 11U);
  lamp.set_group(std::string(65, 'g'));
  EXPECT_THAT(edit({client::updateLight(lamp, {"group"})}),
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations[0].update_light.light.group", "0 to 64"));
}

TEST_F(Edits, AWrongIdentityIsDenied) {
  const pb::ClientIdentity me = join(stubs_, session_);
  pb::ClientIdentity forged = me;
  forged.set_secret(std::string(32, '0'));
  const pb::Edit wanted = client::editOf({client::createLight(light("Lamp"))});
  EXPECT_THAT(tryEdit(stubs_, session_, wanted, nullptr, forged), HasCode(StatusCode::PERMISSION_DENIED));
  pb::ClientIdentity stranger;
  stranger.set_client_id("c-stranger");
  EXPECT_THAT(tryEdit(stubs_, session_, wanted, nullptr, stranger), HasCode(StatusCode::PERMISSION_DENIED));
  EXPECT_THAT(tryEdit(stubs_, makeSession(stubs_), wanted, nullptr, me), HasCode(StatusCode::PERMISSION_DENIED))
      << "an identity belongs to its session";
  Call call;
  const auto stream = stubs_.scene->StreamEdits(call);
  pb::StreamEditsRequest opening;
  opening.set_session(session_);
  *opening.mutable_client() = forged;
  stream->Write(opening);
  pb::StreamEditsResponse response;
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_THAT(stream->Finish(), HasCode(StatusCode::PERMISSION_DENIED));
  EXPECT_EQ(revision(), 0U);
}

TEST(EditLimits, AreNamed) {
  ServerProcess slow({"--max-edits-per-second", "5", "--max-lights", "3", "--max-triangles", "100"});
  Stubs stubs(slow.address());
  const std::string session = makeLitSession(stubs);
  const pb::ClientIdentity me = join(stubs, session);
  grpc::Status last;
  std::uint64_t sequence = 0;
  for (int i = 0; i < 200 && last.ok(); ++i) {
    pb::Edit edit = client::editOf({client::setRadiance("Lamp", {1.0 + i, 1, 1})});
    edit.set_sequence(++sequence);
    last = tryEdit(stubs, session, edit, nullptr, me);
  }
  EXPECT_THAT(last, HasCode(StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_THAT(last.error_message(), HasSubstr("max_edits_per_second"));
  EXPECT_GE(sequence, 6U);
  // Not an outcome: the same sequence goes through later.
  EXPECT_TRUE(eventually([&] {
    pb::Edit edit = client::editOf({client::setRadiance("Lamp", {7, 7, 7})});
    edit.set_sequence(sequence);
    return tryEdit(stubs, session, edit, nullptr, me).ok();
  }));
  const auto more = [&](const pb::Operation& operation) {
    return tryEdit(stubs, session, client::editOf({operation, operation, operation}));
  };
  EXPECT_THAT(more(client::createLight(light("More"))).error_message(), HasSubstr("max_lights"));
  EXPECT_THAT(more(client::createSurface(surface("More", sheet(6)))).error_message(), HasSubstr("max_triangles"));
  std::vector<pb::Operation> many(1001, client::fitGrid());
  EXPECT_THAT(tryEdit(stubs, session, client::editOf(many)),
              Refused(StatusCode::INVALID_ARGUMENT, "edit.operations", "1000"));
  EXPECT_EQ(getSession(stubs, session).light_count(), 1);
  EXPECT_EQ(getSession(stubs, session).surface_count(), 0);
}

}  // namespace
}  // namespace lpv::rpc
