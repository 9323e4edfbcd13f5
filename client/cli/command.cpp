#include "command.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include "interrupt.h"
#include "output.h"

namespace lpv::cli {
namespace {

const char* codeName(Code code) {
  switch (code) {
    case Code::kOk:
      return "OK";
    case Code::kCancelled:
      return "CANCELLED";
    case Code::kInvalidArgument:
      return "INVALID_ARGUMENT";
    case Code::kDeadlineExceeded:
      return "DEADLINE_EXCEEDED";
    case Code::kNotFound:
      return "NOT_FOUND";
    case Code::kAlreadyExists:
      return "ALREADY_EXISTS";
    case Code::kPermissionDenied:
      return "PERMISSION_DENIED";
    case Code::kResourceExhausted:
      return "RESOURCE_EXHAUSTED";
    case Code::kFailedPrecondition:
      return "FAILED_PRECONDITION";
    case Code::kAborted:
      return "ABORTED";
    case Code::kOutOfRange:
      return "OUT_OF_RANGE";
    case Code::kUnimplemented:
      return "UNIMPLEMENTED";
    case Code::kInternal:
      return "INTERNAL";
    case Code::kUnavailable:
      return "UNAVAILABLE";
    case Code::kDataLoss:
      return "DATA_LOSS";
    case Code::kUnauthenticated:
      return "UNAUTHENTICATED";
  }
  return code == kLocal ? "LOCAL" : "UNKNOWN";
}

std::string oneLine(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return line;
}

/// Whether all of stderr is JSON; set once, before an action runs.
bool jsonMessages = false;

void printMessage(const char* kind, const std::string& before, const std::string& message) {
  const std::string line = jsonMessages ? JsonObject().text(kind, message).str() : "lpvctl: " + before + message;
  std::cerr << visible(line) << "\n";
}

void printErrorObject(const char* code, std::string_view reason, const std::string& message, const std::string& field) {
  JsonObject object;
  object.text("code", code).text("reason", std::string(reason)).text("message", message);
  if (!field.empty()) object.text("field", field);
  std::cerr << visible(object.str()) << "\n";
}

}  // namespace

Exit exitFor(const Status& status) {
  switch (status.code()) {
    case Code::kOk:
      return Exit::kOk;
    case Code::kUnavailable:
    case Code::kDeadlineExceeded:
      return Exit::kUnreachable;
    case Code::kPermissionDenied:
    case Code::kUnauthenticated:
      return Exit::kNotAuthorised;
    case Code::kCancelled:
      return interrupted() ? Exit::kInterrupted : Exit::kRefused;
    default:
      return Exit::kRefused;
  }
}

Status localError(std::string field, std::string message) {
  return Status(kLocal, std::move(message), std::move(field));
}

Status asLocal(const Status& status) { return status.ok() ? status : localError(status.field(), status.message()); }

std::string describe(const Status& status) {
  if (status.code() == kLocal) return oneLine(status.message());
  std::string line = std::string(codeName(status.code())) + ": " + status.message();
  if (!status.field().empty() && status.message().find(status.field()) == std::string::npos) {
    line += " (" + status.field() + ")";
  }
  if (status.reason() != Reason::kNone) line += " [" + std::string(nameOf(status.reason())) + "]";
  return oneLine(std::move(line));
}

void printError(const Status& status, bool json) {
  if (!json) {
    std::cerr << "lpvctl: " << visible(describe(status)) << "\n";
    return;
  }
  const std::string_view reason = status.reason() == Reason::kNone ? std::string_view() : nameOf(status.reason());
  printErrorObject(codeName(status.code()), reason, status.message(), status.field());
}

void printUsageError(const std::string& message, bool json) {
  if (json) return printErrorObject("USAGE", "", message, "");
  std::cerr << "lpvctl: " << visible(message) << "\n";
}

void failUsage(const std::string& command, const std::string& message) { throw CLI::ValidationError(command, message); }

client::ConnectOptions Context::options() const {
  client::ConnectOptions options;
  options.address = globals_.server;
  options.tokenFile = globals_.tokenFile;
  if (const char* token = std::getenv("LPV_TOKEN"); token != nullptr) options.token = token;
  options.tls.enabled = globals_.ca == kSystemRoots;
  if (!options.tls.enabled) options.tls.caFile = globals_.ca;
  options.tls.certFile = globals_.cert;
  options.tls.keyFile = globals_.key;
  options.timeout = std::chrono::milliseconds(std::int64_t(globals_.timeoutSeconds * 1000.0));
  return options;
}

Expected<client::Client> Context::connect() const {
  // Nothing is sent before the first call: what fails here is a file of this machine.
  Expected<client::Client> client = asLocal(client::Client::connect(options()));
  if (client) cancelOnInterrupt(*client);
  return client;
}

Expected<client::Client> Context::connectForCleanup() const {
  client::ConnectOptions brief = options();
  brief.timeout = std::min<std::chrono::milliseconds>(brief.timeout, std::chrono::seconds(5));
  return client::Client::connect(brief);
}

CLI::App& Commands::group(CLI::App& parent, const std::string& name, const std::string& about) {
  CLI::App& app = *parent.add_subcommand(name, about);
  app.require_subcommand(1);
  return app;
}

CLI::App& Commands::add(CLI::App& parent, const std::string& name, const std::string& about, Action action) {
  CLI::App& app = *parent.add_subcommand(name, about);
  app.final_callback([this, action = std::move(action)] { chosen_ = action; });
  return app;
}

void addSession(CLI::App& command, std::string& session) {
  command.add_option("session", session, "Session id")->required()->type_name("ID");
}

void requireSomeFlag(CLI::App& command) {
  command.parse_complete_callback([&command] {
    for (const CLI::Option* option : command.get_options()) {
      if (!option->get_positional() && option->count() > 0) return;
    }
    throw CLI::ValidationError(command.get_name(), "name at least one flag: nothing would change");
  });
}

void note(const std::string& message) { printMessage("note", "", message); }

void warn(const std::string& message) { printMessage("warning", "warning: ", message); }

void setJsonMessages(bool json) { jsonMessages = json; }

}  // namespace lpv::cli
