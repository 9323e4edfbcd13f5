#include "app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <iostream>
#include <optional>

#include "app/sources.h"
#include "app/version.h"
#include "session/limit_table.h"
#include "web/origins.h"

namespace lpv::app {
namespace {

/// Options of this group change while the server runs.
constexpr const char* kLimitsGroup = "Limits";
constexpr const char* kPrecedence =
    "A flag wins over its LPVD_* variable, and the variable over the file of --config (or LPVD_CONFIG). Dashes and "
    "underscores in names are the same.";

std::string flagOf(const char* limit) {
  std::string flag = std::string("--") + limit;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

template <typename Value>
CLI::Option* addLimit(CLI::App& app, Limits& limits, const LimitRow<Value>& row) {
  return app.add_option(flagOf(row.name), limits.*row.value, row.help)
      ->check(CLI::Range(Value(row.least), Value(row.most)))
      ->capture_default_str();
}

CLI::Option* addLimit(CLI::App& app, Limits& limits, const LimitRow<std::chrono::seconds>& row) {
  std::chrono::seconds& value = limits.*row.value;
  return app
      .add_option_function<int>(
          flagOf(row.name), [&value](const int& given) { value = std::chrono::seconds(given); }, row.help)
      ->check(CLI::Range(int(row.least), int(row.most)))
      ->default_str(std::to_string(value.count()));
}

void addLimits(CLI::App& app, Limits& limits) {
  forEachLimit([&](const auto& row) { addLimit(app, limits, row)->group(kLimitsGroup); });
}

/// "90s", "10m", "1h", "30d", or a number of seconds.
std::optional<std::chrono::seconds> parseRetain(const std::string& text) {
  std::int64_t count = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || count < 1 || count > 3650LL * 86400) return std::nullopt;
  const std::string unit(rest, text.data() + text.size());
  const std::int64_t seconds = unit.empty() || unit == "s" ? 1
                               : unit == "m"               ? 60
                               : unit == "h"               ? 3600
                               : unit == "d"               ? 86400
                                                           : 0;
  if (seconds == 0 || count * seconds > 3650LL * 86400) return std::nullopt;
  return std::chrono::seconds(count * seconds);
}

void addWeb(CLI::App& app, Options& o) {
  const auto option = [&app](const char* flag, std::string& value, const char* what, const char* type) {
    app.add_option(flag, value, what)->type_name(type)->group("Browsers");
  };
  option("--web", o.web,
         "serve the page for browsers here: HOST:PORT or :PORT on the loopback; port 0 takes a free one; off where not "
         "given",
         "ADDRESS");
  option("--web-port-file", o.webPortFile, "write the --web port here once listening", "FILE");
  option("--web-origins", o.webOrigins,
         "by which addresses browsers reach --web, where they are not its own, as behind a proxy: "
         "https://light.example.org, ...",
         "ORIGIN,..");
  option("--web-files", o.webFiles, "for work on the page: a folder instead of the page in this program", "DIR");
}

void addState(CLI::App& app, Options& o) {
  app.add_option(
         "--state-dir", o.stateDir,
         "keep sessions in this directory, made where it is missing: edits are acknowledged when they are on disk")
      ->type_name("DIR");
  app.add_option_function<std::string>(
         "--retain", [&o](const std::string& given) { o.retain = *parseRetain(given); },
         "how long an expired session is kept in --state-dir: 90s, 10m, 1h, 30d")
      ->check([](const std::string& given) { return parseRetain(given) ? std::string() : "allowed are 1s to 3650d"; })
      ->default_str("30d")
      ->type_name("T");
}

void addSecurity(CLI::App& app, Options& o) {
  const auto file = [&app](const char* flag, std::string& path, const char* what) {
    app.add_option(flag, path, what)->type_name("FILE")->group("Security");
  };
  file("--tls-cert", o.tls.certificate, "this server's certificate chain, PEM; a changed file is taken up by itself");
  file("--tls-key", o.tls.key, "its private key, PEM");
  file("--tls-client-ca", o.tls.clientAuthorities, "clients need a certificate that these authorities vouch for, PEM");
  file("--admin-token-file", o.adminTokenFile,
       "every call needs an access token; the first line of this file is the admin's. SIGHUP reads it again");
  app.add_option("--trusted-proxy", o.trustedProxy,
                 "addresses or networks of proxies: lpvd's limit per address is off for them, limits by address are "
                 "the proxy's (deploy/proxy); none: all are limited")
      ->capture_default_str()
      ->type_name("ADDRESS,..")
      ->group("Security");
  app.add_flag("--reflection", o.reflection, "gRPC reflection although access tokens are asked for")->group("Security");
  app.add_flag("--insecure", o.insecure, "allow a non-loopback address without TLS and tokens")->group("Security");
}

void addOps(CLI::App& app, Options& o) {
  app.add_option(
      "--ops-listen", o.opsListen,
      "plain HTTP for monitoring, /live, /ready and /metrics: HOST:PORT or :PORT on the loopback; port 0 takes "
      "a free one; off where not given");
  app.add_option("--ops-port-file", o.opsPortFile, "write the --ops-listen port here once listening");
  app.add_option("--log-level", o.logLevel, "trace, debug, info, warn, error, off; audit lines come at every level")
      ->capture_default_str();
  app.add_option("--log-format", o.logFormat, "text, or json: an object per line")->capture_default_str();
}

/// Metrics are told to whoever asks, without TLS and tokens, wherever the operator wants: they name no session and no
/// caller. The server says so where others can reach them.
Status checkOps(Options& options) {
  if (options.opsListen.empty()) return {};
  const Expected<HostPort> at = parseHostPort("ops-listen", options.opsListen);
  if (!at) return at.status();
  options.opsAt = *at;
  options.opsListen = at->text();
  return {};
}

/// An address that others reach asks for TLS and tokens.
Status checkExposed(const char* flag, const HostPort& at, const Options& options) {
  const bool secured = options.tls.given() && !options.adminTokenFile.empty();
  if (isLoopback(at.host) || secured || options.insecure) return {};
  return invalid(flag, std::string("--") + flag + " " + at.text() +
                           " is not a loopback address: give --tls-cert, --tls-key and --admin-token-file, or "
                           "--insecure on a network you trust");
}

Status checkWeb(Options& options) {
  if (const auto origins = web_door::Origins::read(options.webOrigins); !origins) return origins.status();
  if (options.web.empty()) return {};
  const Expected<HostPort> at = parseHostPort("web", options.web);
  if (!at) return at.status();
  options.webAt = *at;
  options.web = at->text();
  return checkExposed("web", *at, options);
}

Status check(Options& options) {
  if (Status s = checkOps(options); !s.ok()) return s;
  if (Status s = checkWeb(options); !s.ok()) return s;
  Expected<api::AddressList> proxies = api::AddressList::read("trusted-proxy", options.trustedProxy);
  if (!proxies) return proxies.status();
  options.trustedProxies = std::move(*proxies);
  const Expected<HostPort> at = parseHostPort("listen", options.listen);
  if (!at) return at.status();
  options.listen = at->text();
  if (Status s = checkExposed("listen", *at, options); !s.ok()) return s;
  if (Status s = tls::check(options.tls); !s.ok()) return s;
  const Expected<DeviceChoice> choice = parseDeviceChoice(options.device);
  if (!choice) return choice.status();
  options.choice = *choice;
  return {};
}

/// All options, told where to put their values.
class CommandLine {
 public:
  explicit CommandLine(Options& options);
  CLI::App app{"lpvd: keeps light propagation volumes per session on the GPU and streams what they light", "lpvd"};
  /// Reads flags, environment and file. INVALID_ARGUMENT names the flag, or the place in the file or the variable.
  Expected<Sources> gather(int argc, char** argv) const;
  /// Throws CLI::ParseError.
  void parse(const Sources& sources);
  /// Options::given.
  std::map<std::string, std::string> values() const;
  /// A file for --config.
  std::string printed() const;

 private:
  /// An option that files and variables can set.
  bool known(const std::string& name) const;

  std::string config_;
};

CommandLine::CommandLine(Options& o) {
  app.add_option("--config", config_, "read options from a file of lines NAME = VALUE, as --print-config writes them")
      ->type_name("FILE")
      ->configurable(false);
  app.footer(kPrecedence);
  app.add_option("--listen", o.listen, "gRPC address, HOST:PORT or :PORT on the loopback; port 0 takes a free one")
      ->capture_default_str();
  app.add_option("--port-file", o.portFile, "write the gRPC port here once listening");
  app.add_option("--device", o.device, "auto, software, or a number from --list-devices")->capture_default_str();
  addWeb(app, o);
  addState(app, o);
  addOps(app, o);
  addSecurity(app, o);
  app.add_flag("--list-devices", o.listDevices, "print what --device would use and why, then exit")
      ->configurable(false);
  app.add_flag("--print-config", o.printConfig, "print the configuration as TOML, then exit")->configurable(false);
  app.add_flag("--version", o.version, "print the version, then exit")->configurable(false);
  addLimits(app, o.limits);
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_envname().empty() || !option->get_configurable() || option->get_lnames().empty()) continue;
    option->envname(variableOf(option->get_lnames().front()));
  }
}

bool CommandLine::known(const std::string& name) const {
  const CLI::Option* option = app.get_option_no_throw("--" + name);
  return option != nullptr && option->get_configurable();
}

Expected<Sources> CommandLine::gather(int argc, char** argv) const {
  return gatherSources(argc, argv, [this](const std::string& name) { return known(name); });
}

void CommandLine::parse(const Sources& sources) {
  std::vector<std::string> arguments = sources.arguments();
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes the last one first
  app.parse(arguments);
}

/// Options that are not given and have no default are comments: an empty text would be one too.
std::string CommandLine::printed() const {
  std::string out;
  const auto all = values();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_configurable() || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    const std::string& value = all.at("--" + name);
    const bool flag = option->get_expected_max() == 0;
    out += "# " + option->get_description() + "\n" + (value.empty() && !flag ? "# " : "");
    out += configLine(name, flag && value.empty() ? "false" : value) + "\n";
  }
  return out;
}

std::map<std::string, std::string> CommandLine::values() const {
  std::map<std::string, std::string> out;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_configurable() || option->get_lnames().empty()) continue;
    const auto& results = option->results();
    out["--" + option->get_lnames().front()] = results.empty() ? option->get_default_str() : results.back();
  }
  return out;
}

/// What CLI11 says, with the place of a value that does not stand on the command line.
std::string explained(const CLI::ParseError& error, const Sources& sources) {
  std::string text = error.what();
  text = text.substr(0, text.find('\n'));
  const std::size_t flag = text.find("--");
  if (flag == std::string::npos) return text;
  const std::string place = sources.placeOf(text.substr(flag + 2, text.find_first_of(":= ", flag) - flag - 2));
  return place.empty() ? text : place + ": " + text;
}

}  // namespace

Parsed parse(int argc, char** argv) {
  Parsed out;
  Options& o = out.options;
  CommandLine line(o);
  const Expected<Sources> sources = line.gather(argc, argv);
  if (!sources) {
    std::cerr << "lpvd: " << sources.status().message() << "\n";
    out.exitStatus = 2;
    return out;
  }
  try {
    line.parse(*sources);
  } catch (const CLI::Success& wanted) {
    line.app.exit(wanted, std::cout, std::cerr);
    return out;
  } catch (const CLI::ParseError& error) {
    std::cerr << "lpvd: " << explained(error, *sources) << "; see lpvd --help\n";
    out.exitStatus = 2;
    return out;
  }
  o.ignoredVariables = sources->ignored;
  if (o.version) {
    std::cout << "lpvd " << kVersion << "\n";
    return out;
  }
  if (o.printConfig) {
    std::cout << line.printed();
    return out;
  }
  if (const Status status = check(o); !status.ok()) {
    std::cerr << "lpvd: " << status.message() << "\n";
    out.exitStatus = 2;
    return out;
  }
  o.given = line.values();
  out.run = true;
  return out;
}

Expected<Reload> reload(int argc, char** argv, Options& running) {
  Options fresh;
  CommandLine line(fresh);
  const Expected<Sources> sources = line.gather(argc, argv);
  if (!sources) return sources.status();
  try {
    line.parse(*sources);
  } catch (const CLI::ParseError& error) {
    return invalid("config", explained(error, *sources));
  }
  if (Status s = check(fresh); !s.ok()) return s;
  Reload out;
  out.limits = fresh.limits;
  for (const auto& [flag, value] : line.values()) {
    std::string& before = running.given[flag];
    if (before == value) continue;
    if (line.app.get_option(flag)->get_group() == kLimitsGroup) {
      out.applied.push_back(flag + " " + before + " -> " + value);
      before = value;
    } else {
      out.kept.push_back(flag);
    }
  }
  running.limits = fresh.limits;
  return out;
}

}  // namespace lpv::app
