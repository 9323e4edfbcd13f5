#pragma once

#include "session/journal.h"

namespace lpv {

/// Keeps nothing: sessions live as long as the process. Durability MEMORY; every change is as durable as it gets at
/// once. Tests derive from it what keeps a part.
class MemoryJournal : public Journal {
 public:
  Durability durability() const override { return Durability::kMemory; }
  Status available() const override { return {}; }
  Status writable(const std::string&) const override { return {}; }
  Position create(const SavedSession&) override { return 0; }
  Position append(const std::string&, JournalStep) override { return 0; }
  Position setEpoch(const std::string&, std::uint64_t) override { return 0; }
  Position touch(const std::string&, std::chrono::system_clock::time_point) override { return 0; }
  Position remove(const std::string&) override { return 0; }
  Position keepToken(const AccessToken&) override { return 0; }
  Position dropToken(const std::string&, const std::string&) override { return 0; }
  void whenDurable(const std::string&, Position, std::function<void(const Status&)> kept) override { kept({}); }
  Status flush() override { return {}; }
  Expected<std::vector<SessionHead>> heads() override { return std::vector<SessionHead>(); }
  Expected<std::vector<AccessToken>> tokens() override { return std::vector<AccessToken>(); }
  Expected<SavedSession> load(const std::string& session) override { return none(session); }
  Expected<SessionSummary> summary(const std::string& session) override { return none(session); }
  std::uint64_t highestEpoch() override { return 0; }

 private:
  static Status none(const std::string& session) {
    return {Code::kNotFound, "there is no session \"" + session + "\"; this server keeps none on disk", "session"};
  }
};

}  // namespace lpv
