// session create | list | show | set | delete | fit | share | tokens | revoke | save | load

#include <fcntl.h>
#include <google/protobuf/util/time_util.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>

#include "command.h"
#include "files.h"
#include "output.h"
#include "progress.h"
#include "session_settings.h"
#include "values.h"

namespace lpv::cli {
namespace {

std::string gridText(const v1::Session& session) {
  const v1::Dims& d = session.grid().dims();
  return std::to_string(d.x()) + "x" + std::to_string(d.y()) + "x" + std::to_string(d.z());
}

std::string memoryText(const v1::GpuMemory& memory) {
  const auto mebibytes = [](std::int64_t bytes) { return shortText(double(bytes) / (1 << 20)) + " MiB"; };
  return mebibytes(memory.light_bytes()) + " for light, " + mebibytes(memory.frame_bytes()) + " for frames, " +
         mebibytes(memory.scene_bytes()) + " for meshes and textures";
}

void printSession(const Context& context, const v1::Session& session) {
  if (context.json()) return print(toJson(session));
  const std::string measured = session.has_measured_error()
                                   ? shortText(session.measured_error()) + " (" +
                                         shortText(session.measured_error_low()) + " to " +
                                         shortText(session.measured_error_high()) + ") at revision " +
                                         std::to_string(session.measured_revision())
                                   : "not yet";
  printTable({{"id", client::sessionId(session.name())},
              {"name", session.settings().display_name()},
              {"revision", std::to_string(session.revision())},
              {"grid", gridText(session) + " cells of " + shortText(session.grid().cell_size()) + " m"},
              {"lights", std::to_string(session.light_count())},
              {"surfaces", std::to_string(session.surface_count())},
              {"triangles", std::to_string(session.triangle_count())},
              {"clients", std::to_string(session.client_count())},
              {"subscribers", std::to_string(session.subscriber_count())},
              {"expected error", shortText(session.expected_error())},
              {"measured error", measured},
              {"GPU memory", session.has_gpu_memory() ? memoryText(session.gpu_memory()) : "not yet"},
              {"choice", session.choice()},
              {"settings", toJson(session.settings())}});
}

/// Writes the token to a file that only its owner can read. Does nothing for an empty path.
Status saveToken(const std::string& path, const std::string& token) {
  if (path.empty()) return {};
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const std::string line = token + "\n";
  const bool written = file >= 0 && ::write(file, line.data(), line.size()) == ssize_t(line.size());
  if (file >= 0) ::close(file);
  return written ? Status() : localError("save-token", "cannot write " + path);
}

void addSaveToken(CLI::App& app, std::string& file) {
  app.add_option("--save-token", file, "File to write the owner's access token to (default: it is not saved)")
      ->type_name("FILE");
}

void addCreate(CLI::App& group, Commands& commands) {
  struct Options {
    SessionFlags flags;
    std::string id;
    std::string tokenFile;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(group, "create", "Create a session and print its id", [given](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    v1::CreateSessionRequest request;
    request.set_session_id(given->id);
    given->flags.apply(*request.mutable_settings());
    const auto made = client->createSession(request);
    if (!made) return made.status();
    if (Status saved = saveToken(given->tokenFile, made->owner_token()); !saved.ok()) return saved;
    print(context.json() ? toJson(*made) : client::sessionId(made->session().name()));
    return Status();
  });
  app.add_option("--id", given->id, "Wanted id (the server chooses)")->type_name("ID");
  addSaveToken(app, given->tokenFile);
  given->flags.addTo(app);
}

void addList(CLI::App& group, Commands& commands) {
  commands.add(group, "list", "List the sessions", [](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const auto sessions = client->sessions();
    if (!sessions) return sessions.status();
    std::vector<std::vector<std::string>> rows;
    for (const v1::Session& session : *sessions) {
      if (context.json()) print(toJson(session));
      rows.push_back({client::sessionId(session.name()), gridText(session),
                      std::to_string(session.light_count()) + " lights",
                      std::to_string(session.surface_count()) + " surfaces",
                      "revision " + std::to_string(session.revision()), session.settings().display_name()});
    }
    if (!context.json()) printTable(rows);
    return Status();
  });
}

void addShow(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(group, "show", "Show a session and its settings", [id](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const auto session = client->session(*id);
    if (session) printSession(context, *session);
    return session.status();
  });
  addSession(app, *id);
}

void declareSet(CLI::App& group, Commands& commands) {
  struct Options {
    std::string id;
    SessionFlags flags;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(group, "set", "Change the given settings of a session", [given](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const auto now =
        client->session(given->id);  // the grid is one field of the mask, so its other parts are sent unchanged
    if (!now) return now.status();
    v1::Session wanted;
    wanted.set_name(now->name());
    *wanted.mutable_settings()->mutable_grid() = now->settings().grid();
    const std::vector<std::string> paths = given->flags.apply(*wanted.mutable_settings());
    const auto session = client->updateSession(wanted, paths);
    if (session && context.json()) print(toJson(*session));
    return session.status();
  });
  addSession(app, given->id);
  given->flags.addTo(app);
  requireSomeFlag(app);
}

void addDelete(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(group, "delete", "Delete a session for all its clients", [id](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    Status status = client->deleteSession(*id);
    if (status.ok() && context.json()) print("{}");
    return status;
  });
  addSession(app, *id);
}

void addFit(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(group, "fit", "Fit the grid to the content", [id](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const auto session = client->fitSession(*id);
    if (session) print(context.json() ? toJson(*session) : gridText(*session));
    return session.status();
  });
  addSession(app, *id);
}

void addShare(CLI::App& group, Commands& commands) {
  struct Options {
    std::string id;
    std::optional<v1::Role> role;
    std::optional<double> ttl;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(group, "share", "Create an access token and print it", [given](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    v1::CreateTokenRequest request;
    request.set_session(client::sessionName(given->id));
    request.set_role(*given->role);
    if (given->ttl) request.mutable_ttl()->set_seconds(std::int64_t(*given->ttl));
    const auto token = client->createToken(request);
    if (token) print(context.json() ? toJson(*token) : token->token());
    return token.status();
  });
  addSession(app, given->id);
  addChoice<v1::Role>(app, "--role", given->role,
                      {{"viewer", v1::ROLE_VIEWER}, {"editor", v1::ROLE_EDITOR}, {"owner", v1::ROLE_OWNER}},
                      "Role that the token grants")
      ->required();
  addParsed<double>(app, "--ttl", given->ttl, "T", parseDuration,
                    "Lifetime of the token: 90s, 10m, 1h, 2d (default: 30d)");
}

const char* roleText(v1::Role role) {
  if (role == v1::ROLE_VIEWER) return "viewer";
  if (role == v1::ROLE_EDITOR) return "editor";
  return role == v1::ROLE_OWNER ? "owner" : "unknown role";
}

void addTokens(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app =
      commands.add(group, "tokens", "List a session's access tokens: id, role, expiry", [id](Context& context) {
        Expected<client::Client> client = context.connect();
        if (!client) return client.status();
        const auto tokens = client->tokens(*id);
        if (!tokens) return tokens.status();
        std::vector<std::vector<std::string>> rows;
        for (const v1::AccessToken& token : *tokens) {
          if (context.json()) print(toJson(token));
          rows.push_back({token.token_id(), roleText(token.role()),
                          "until " + google::protobuf::util::TimeUtil::ToString(token.expire_time())});
        }
        if (!context.json()) printTable(rows);
        return Status();
      });
  addSession(app, *id);
}

void addRevoke(CLI::App& group, Commands& commands) {
  struct Options {
    std::string id;
    std::string token;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(group, "revoke", "Revoke an access token and end the streams opened with it",
                               [given](Context& context) {
                                 Expected<client::Client> client = context.connect();
                                 if (!client) return client.status();
                                 return client->revokeToken(client::sessionName(given->id), given->token);
                               });
  addSession(app, given->id);
  app.add_option("token", given->token, "Id of the token, printed by session tokens: the 16 digits after lpv_")
      ->required()
      ->type_name("TOKEN_ID");
}

/// Passes the session's parts to `write`, which returns false to stop, with a progress line. Returns their bytes.
Expected<std::uint64_t> exportTo(client::Client& client, const std::string& session,
                                 const std::function<bool(const std::string&)>& write) {
  ProgressBar bar("saving");
  std::uint64_t bytes = 0;
  Status status = client.exportSession(session, [&](const std::string& part) {
    bytes += part.size();
    bar.show(bytes, 0);
    return write(part);
  });
  if (!status.ok()) return status;
  return bytes;
}

/// Writes a temporary file and renames it; "-": to stdout, part by part.
Status saveSession(Context& context, client::Client& client, const std::string& session, const std::string& path) {
  if (isStandardStream(path)) {
    Status written;
    const auto toStdout = [&written](const std::string& part) {
      written = writeFile(kStandardStream, part);
      return written.ok();
    };
    const Status sent = exportTo(client, session, toStdout).status();
    return written.ok() ? sent : written;
  }
  const std::string partial = path + ".part";
  std::ofstream file(partial, std::ios::binary);
  if (!file) return localError("file", "cannot write " + path);
  const Expected<std::uint64_t> bytes = exportTo(client, session, [&](const std::string& part) {
    return bool(file.write(part.data(), std::streamsize(part.size())));
  });
  file.close();
  Status status = file ? bytes.status() : localError("file", "cannot write " + path);
  if (status.ok() && std::rename(partial.c_str(), path.c_str()) != 0)
    status = localError("file", "cannot write " + path);
  if (!status.ok()) std::remove(partial.c_str());
  if (status.ok() && context.json()) print(JsonObject().text("file", path).number("bytes", double(*bytes)).str());
  return status;
}

void addSave(CLI::App& group, Commands& commands) {
  struct Options {
    std::string id;
    std::string file;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(group, "save", "Save a session's content to a file", [given](Context& context) {
    checkBinaryOutput(context, "session save", given->file);
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    return saveSession(context, *client, given->id, given->file);
  });
  addSession(app, given->id);
  app.add_option("file", given->file, "File to write; - is stdout")->required()->type_name("FILE");
}

void addLoad(CLI::App& group, Commands& commands) {
  struct Options {
    std::string file;
    std::string id;
    std::string tokenFile;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app =
      commands.add(group, "load", "Create a session from a saved file and print its id", [given](Context& c) {
        const Expected<std::string> bytes = readFile(given->file, "file");
        if (!bytes) return bytes.status();
        Expected<client::Client> client = c.connect();
        if (!client) return client.status();
        ProgressBar bar("uploading");
        const auto made =
            client->importSession(given->id, *bytes, [&](auto done, auto total) { bar.show(done, total); });
        if (!made) return made.status();
        if (Status saved = saveToken(given->tokenFile, made->owner_token()); !saved.ok()) return saved;
        print(c.json() ? toJson(*made) : client::sessionId(made->session().name()));
        return Status();
      });
  app.add_option("file", given->file, "File to read; - is stdin")->required()->type_name("FILE");
  app.add_option("--id", given->id, "Wanted id (the server chooses)")->type_name("ID");
  addSaveToken(app, given->tokenFile);
}

}  // namespace

void addSessionCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(
      app, "session", "Sessions: create, list, show, set, delete, fit, share, tokens, revoke, save, load");
  addCreate(group, commands);
  addList(group, commands);
  addShow(group, commands);
  declareSet(group, commands);
  addDelete(group, commands);
  addFit(group, commands);
  addShare(group, commands);
  addTokens(group, commands);
  addRevoke(group, commands);
  addSave(group, commands);
  addLoad(group, commands);
}

}  // namespace lpv::cli
