#pragma once
// A server in this process with a room, and what members, readers and the operator do there.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "tsan/guest.h"
#include "tsan/house.h"

namespace lpv::test {

/// Moves the room's lamp.
pb::Operation moving(double x);

class Together : public testing::Test {
 protected:
  Together() { makeRoom("room"); }

  void makeRoom(const std::string& id, std::int64_t ttl = 3600);
  pb::ClientIdentity join(const std::string& room = "sessions/room");
  void leave(const pb::ClientIdentity& client);
  std::uint64_t revision(const std::string& name);

  // What one does in a round.
  void edit(const pb::ClientIdentity& client, int round, std::atomic<std::uint64_t>& accepted);
  void takeBack(const pb::ClientIdentity& client, std::atomic<std::uint64_t>& accepted);
  void beSeen(const pb::ClientIdentity& client);
  void streamEdits(int edits, std::atomic<std::uint64_t>& accepted);
  void watchVolumes(bool leavesEarly);
  void watchFrames();
  void watchScene(const pb::ClientIdentity& client);
  void askForLight();
  void upload(int round);
  void shareAndRevoke();
  void askForNumbers();
  void comeAndGo(int round);
  void copyTheRoom(int round);

  House& house() { return *house_; }

  store::Folder folder_;
  std::unique_ptr<House> house_ = std::make_unique<House>(folder_);
};

}  // namespace lpv::test
