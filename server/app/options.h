#pragma once

#include <chrono>
#include <string>

#include "grpc/certificates.h"
#include "lpv/engine.h"
#include "session/limits.h"

namespace lpv::app {

/// What lpvd was asked on its command line, in LPVD_* environment variables or in a TOML file.
struct Options {
  std::string listen = "127.0.0.1:50051";
  std::string portFile;
  std::string opsListen;  ///< empty: no endpoint
  std::string opsPortFile;
  std::string stateDir;                    ///< empty: sessions live in memory
  std::chrono::seconds retain{30 * 86400};  ///< of expired sessions in stateDir
  std::string device = "auto";
  std::string logLevel = "info";
  std::string logFormat = "text";
  bool listDevices = false;
  bool printConfig = false;
  bool version = false;
  bool insecure = false;
  door::TlsFiles tls;
  std::string adminTokenFile;  ///< given: calls need access tokens, and its first line is the admin's
  bool reflection = false;     ///< although tokens are asked for
  Limits limits;
  DeviceChoice choice;
};

/// What to do after parsing: run, or exit with a status.
struct Parsed {
  Options options;
  bool run = false;
  int exitStatus = 0;
};

/// Parses and checks. Prints help, version, configuration or an error itself.
Parsed parse(int argc, char** argv);

}  // namespace lpv::app
