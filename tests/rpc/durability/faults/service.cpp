#include "rpc/durability/faults/service.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <utility>

namespace lpv::rpc::faults {

Service::Service(std::string program) : program_(std::move(program)) { start(); }

Service::~Service() {
  server_.reset();
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

void Service::start() {
  const std::vector<std::string> arguments = {"--state-dir",     directory_, "--max-edits-per-second", "100000",
                                              "--max-lights",    "100000",   "--max-surfaces",         "100000",
                                              "--max-tick-rate", "10"};
  server_ = std::make_unique<ServerProcess>(arguments, "127.0.0.1:0", program_);
  stubs_ = std::make_unique<Stubs>(server_->address());
}

void Service::end(int signal, int status) {
  lives_.push_back(residentBytes());
  server_->process().signal(signal);
  ASSERT_EQ(server_->process().wait(), status);
  stubs_.reset();
  server_.reset();
}

void Service::kill() { end(SIGKILL, -SIGKILL); }
void Service::drain() { end(SIGTERM, 0); }

}  // namespace lpv::rpc::faults
