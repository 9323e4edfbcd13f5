// What a session without a disk is told of its journal (PROTOCOL.md, Durability).

#include "session/memory_journal.h"

#include <gtest/gtest.h>

namespace lpv {
namespace {

/// Seen to fail with kDisk, and with a position that is not confirmed before the call returns.
TEST(MemoryJournal, EveryChangeIsAsDurableAsItGetsAtOnce) {
  MemoryJournal journal;
  EXPECT_EQ(journal.durability(), Durability::kMemory);
  const Position position = journal.append("sessions/room", {});
  int confirmed = 0;
  journal.whenDurable("sessions/room", position, [&](const Status& status) { confirmed += status.ok() ? 1 : 100; });
  EXPECT_EQ(confirmed, 1);
}

/// Seen to fail with a status that names no field.
TEST(MemoryJournal, HasNoSessionToLoad) {
  MemoryJournal journal;
  const Status status = journal.load("sessions/room").status();
  EXPECT_EQ(status.code(), Code::kNotFound);
  EXPECT_EQ(status.field(), "session");
  EXPECT_NE(status.message().find("\"sessions/room\""), std::string::npos) << status.message();
  EXPECT_EQ(journal.summary("sessions/room").status().code(), Code::kNotFound);
  EXPECT_TRUE(journal.heads()->empty());
}

}  // namespace
}  // namespace lpv
