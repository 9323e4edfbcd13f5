#include "membership.h"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "command.h"

namespace lpv::cli {
namespace {

namespace fs = std::filesystem;

/// The user's folder for program state; empty if the environment names neither XDG_STATE_HOME nor HOME.
std::optional<fs::path> stateHome() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/') return fs::path(state);
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') return fs::path(home) / ".local/state";
  return std::nullopt;
}

std::string asFileName(std::string words) {
  for (char& c : words) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    if (!plain) c = '_';
  }
  return words;
}

/// File that stores the identity for a session.
std::optional<fs::path> fileFor(const client::Client& client, const std::string& session) {
  const std::optional<fs::path> home = stateHome();
  if (!home) return std::nullopt;
  return *home / "lpvctl/members" / asFileName(client.address()) / asFileName(client::sessionId(session));
}

v1::ClientIdentity readIdentity(const fs::path& path) {
  v1::ClientIdentity out;
  std::ifstream file(path);
  std::string id;
  std::string secret;
  if (!(file >> id >> secret)) return out;
  out.set_client_id(id);
  out.set_secret(secret);
  return out;
}

/// Writes a temporary file and renames it, so that another run reads a complete identity or none.
bool writeIdentity(const fs::path& path, const v1::ClientIdentity& identity) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  fs::permissions(path.parent_path(), fs::perms::owner_all, error);
  const fs::path part = path.string() + "." + identity.client_id();
  {
    std::ofstream file(part);
    fs::permissions(part, fs::perms::owner_read | fs::perms::owner_write, error);
    file << identity.client_id() << "\n" << identity.secret() << "\n";
    if (!file.flush()) return false;
  }
  fs::rename(part, path, error);
  return !error;
}

/// Sequence of an edit: microseconds since 1970. Sequences must rise from run to run but need not be consecutive.
std::uint64_t sequenceNow() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::uint64_t(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

client::Editor editorFor(const client::Client& client, const std::string& session, v1::ClientIdentity identity) {
  return client::Editor::resume(client, session, std::move(identity), sequenceNow());
}

/// Joins the session and stores the identity. Without a stored identity edits are made anonymously.
client::Editor newMember(const client::Client& client, const std::string& session, const fs::path& path) {
  Expected<client::Editor> joined = client::Editor::join(client, session, "");
  if (!joined) return editorFor(client, session, {});
  if (writeIdentity(path, joined->identity())) return editorFor(client, session, joined->identity());
  warn(path.string() + " cannot be written, so lpvctl undo cannot undo this edit");
  (void)joined->leave();
  return editorFor(client, session, {});
}

bool isUnknownMember(const Status& status) {
  return status.code() == Code::kPermissionDenied && status.field() == "client";
}

}  // namespace

Status asMember(const client::Client& client, const std::string& session,
                const std::function<Status(client::Editor&)>& act) {
  const std::optional<fs::path> path = fileFor(client, session);
  client::Editor editor = editorFor(client, session, path ? readIdentity(*path) : v1::ClientIdentity());
  const bool known = !editor.identity().client_id().empty();
  if (path && !known) editor = newMember(client, session, *path);
  Status status = act(editor);
  if (!known || !isUnknownMember(status)) return status;
  editor = newMember(client, session, *path);
  return act(editor);
}

}  // namespace lpv::cli
