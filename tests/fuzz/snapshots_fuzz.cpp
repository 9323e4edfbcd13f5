// Sessions as a disk or a stranger's file has them: snapshots, records of a log, whole files. What cannot be used is
// refused and says why; what can makes a session that is kept as the same again.
//
// Has found a texture that a light wears and that nobody has uploaded, taken and then lost (seeds/snapshots/texture).

#include <google/protobuf/stubs/logging.h>

#include "api/services.h"
#include "base/digest.h"
#include "fuzz/check.h"
#include "fuzz/inputs.pb.h"
#include "fuzz/message_input.h"
#include "fuzz/world.h"
#include "persistence/snapshot.h"
#include "store/envelope.h"
#include "store/fold.h"

namespace lpv::fuzz {
namespace {

namespace kept = lpv::store::v1;

/// "#0" is the hash of the first content.
void nameContents(Kept& input) {
  for (kept::Content& content : *input.mutable_contents()) {
    if (content.hash().empty()) content.set_hash(sha256(content.bytes()));
  }
  const auto name = [&](const std::string& text) {
    if (text.size() != 2 || text[0] != '#') return text;
    const int index = text[1] - '0';
    return index >= 0 && index < input.contents_size() ? input.contents(index).hash() : text;
  };
  for (google::protobuf::Message* message : everyMessage(&input)) {
    if (auto* light = dynamic_cast<lpv::v1::Light*>(message)) {
      light->set_mesh(name(light->mesh()));
      light->set_texture(name(light->texture()));
    } else if (auto* surface = dynamic_cast<lpv::v1::Surface*>(message)) {
      surface->set_mesh(name(surface->mesh()));
      surface->set_albedo_texture(name(surface->albedo_texture()));
    }
  }
}

/// What a store reads of it: false where it would say that it is damaged.
bool readBack(const Kept& input, kept::Snapshot* snapshot) {
  if (!store::unseal("the snapshot", *store::seal("the snapshot", input.snapshot()), snapshot).ok()) return false;
  for (const kept::Record& record : input.log()) {
    kept::Record read;
    if (!store::unseal("the log", *store::seal("the log", record), &read).ok()) return false;
    if (const Status s = store::fold(read, snapshot); !s.ok()) return checkRefusal(s), false;
  }
  return true;
}

/// A session that came back is kept as it came.
void useState(const SavedSession& state) {
  const kept::Snapshot once = api::toSnapshot(state);
  const Expected<SavedSession> again = api::fromStore({{}, once, api::contentsOf(state)});
  check(again.ok(), "what came back can be kept: " + again.status().message());
  check(deterministic(api::toSnapshot(*again)) == deterministic(once), "a session is kept as what it came back as");
  Machinery& m = machinery();
  const SessionServices services{smallLimits(), &m.engine, &m.pool, &m.timers, &m.counters, {}, &m.journal};
  const auto session = std::make_shared<Session>(1, 2, state, services);
  Edit edit;
  edit.operations = {PutCamera{"Another", Camera()}};
  (void)session->apply({}, edit);
  check(session->scene()->lights.size() == state.document.lights.size(), "every light that was kept is there");
}

/// The end of an import of these bytes.
Status imported(World& world, const std::string& bytes) {
  const auto stream = api::importSession(world.contextOf(Role::kAdmin));
  lpv::v1::ImportSessionRequest request;
  request.set_session_id("hall");
  request.set_data(bytes);
  stream->receive(request);
  stream->halfClosed();
  machinery().settle();
  const std::optional<Status> end = stream->ended();
  check(end.has_value(), "an import ends");
  if (!end->ok()) checkRefusal(*end);
  return *end;
}

std::string exported(World& world) {
  const auto stream = api::exportSession(world.contextOf(Role::kAdmin));
  lpv::v1::ExportSessionRequest request;
  request.set_name("sessions/hall");
  stream->receive(request);
  std::string bytes;
  lpv::v1::ExportSessionResponse part;
  while (stream->next(&part)) bytes += part.data();
  return bytes;
}

void useFile(const std::string& bytes) {
  World world(false);
  const std::string before = world.content();
  if (!imported(world, bytes).ok()) return check(world.content() == before, "a file that is refused changes nothing");
  const std::string first = world.content();
  const std::string file = exported(world);
  World other(false);
  check(imported(other, file).ok() && other.content() == first, "what was exported is imported as the same");
}

void run(Kept& input) {
  if (!input.envelope().empty()) return useFile(input.envelope());
  nameContents(input);
  kept::Snapshot snapshot;
  if (!readBack(input, &snapshot)) return;
  store::Loaded loaded{{}, snapshot, {}};
  loaded.head.id = "hall";
  for (const kept::Content& content : input.contents()) {
    loaded.contents.push_back({content.hash(), content.kind(), std::make_shared<const std::string>(content.bytes())});
  }
  const Expected<SessionSummary> summary = api::summaryOf(loaded);
  if (!summary) checkRefusal(summary.status());
  const Expected<SavedSession> state = api::fromStore(loaded);
  if (state) {
    useState(*state);
  } else {
    checkRefusal(state.status());
  }
  kept::SessionFile file;
  *file.mutable_snapshot() = snapshot;
  *file.mutable_contents() = input.contents();
  useFile(*store::seal("the file", file));
}

const std::vector<std::string>& words() {
  static const std::vector<std::string> all = {"", "#0", "#1", "#2", "Lamp", "Wall", "Front", "a/b", "key", "me"};
  return all;
}

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t maxSize,
                                               unsigned seed) {
  lpv::fuzz::Kept input;
  return lpv::fuzz::mutateText(&input, lpv::fuzz::words(), data, size, maxSize, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lpv::fuzz::Kept input;
  if (!lpv::fuzz::parseText(data, size, &input)) return -1;
  lpv::fuzz::run(input);
  return 0;
}
