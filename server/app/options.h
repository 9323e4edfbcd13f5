#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "api/call/address_limit.h"
#include "base/address.h"
#include "engine/device_choice.h"
#include "session/limits.h"
#include "tls/files.h"

namespace lpv::app {

/// What lpvd was asked on its command line, in LPVD_* environment variables or in a TOML file.
struct Options {
  std::string listen = "127.0.0.1:50051";
  std::string portFile;
  std::string opsListen;  ///< empty: no endpoint
  HostPort opsAt;         ///< opsListen, read
  std::string opsPortFile;
  std::string web;         ///< empty: no door for browsers
  HostPort webAt;          ///< web, read
  std::string webPortFile;
  std::string webOrigins;  ///< as --web-origins
  std::string webFiles;    ///< folder of the page; empty: the one in this program
  std::string stateDir;                    ///< empty: sessions live in memory
  std::chrono::seconds retain{30 * 86400};  ///< of expired sessions in stateDir
  std::string device = "auto";
  std::string logLevel = "info";
  std::string logFormat = "text";
  bool listDevices = false;
  bool printConfig = false;
  bool version = false;
  bool insecure = false;
  tls::Files tls;
  std::string adminTokenFile;  ///< given: calls need access tokens, and its first line is the admin's
  std::string trustedProxy = "127.0.0.0/8,::1";
  api::AddressList trustedProxies;  ///< trustedProxy, read
  bool reflection = false;     ///< although tokens are asked for
  Limits limits;
  DeviceChoice choice;
  std::string ignoredVariables;  ///< LPVD_* that set nothing: "LPVD_PORT, LPVD_X"
  std::map<std::string, std::string> given;  ///< every option by its flag, as text: what a reload compares
};

/// What to do after parsing: run, or exit with a status.
struct Parsed {
  Options options;
  bool run = false;
  int exitStatus = 0;
};

/// What a configuration that was read again changes.
struct Reload {
  Limits limits;                     ///< to be used from now on
  std::vector<std::string> applied;  ///< "--max-lights 1024 -> 2"
  std::vector<std::string> kept;     ///< flags of changes that only a new start takes up
};
/// Reads flags, environment and file again, and compares them with what `running` was started or reloaded with, which
/// then counts the new limits as its own. INVALID_ARGUMENT, and nothing changes, for what a start would refuse.
Expected<Reload> reload(int argc, char** argv, Options& running);

/// Parses and checks. Prints help, version, configuration or an error itself.
Parsed parse(int argc, char** argv);

}  // namespace lpv::app
