#pragma once
// A session with two members who take things back.

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "unit/session/session_rig.h"

namespace lpv::test {

inline Limits unhurried() {
  Limits limits = Rig::quick();
  limits.maxEditsPerSecond = 1e9;
  return limits;
}

class UndoTest : public testing::Test {
 protected:
  explicit UndoTest(const Limits& limits = unhurried()) : rig_(limits) {}

  EditOutcome apply(const ClientIdentity& client, std::vector<Operation> operations, const std::string& group = {}) {
    Edit edit = editOf(std::move(operations));
    edit.undoGroup = group;
    EditOutcome outcome = session_->apply(client, edit);
    EXPECT_TRUE(outcome.status.ok()) << outcome.status.message();
    return outcome;
  }
  EditOutcome undo(const ClientIdentity& client, std::uint64_t sequence = 0) {
    return session_->undoRedo(client, sequence, UndoDirection::kUndo);
  }
  EditOutcome redo(const ClientIdentity& client) { return session_->undoRedo(client, 0, UndoDirection::kRedo); }
  LightPtr light(const std::string& name = "Lamp") {
    for (const Versioned<Light>& each : session_->lights()) {
      if (each.object->name == name) return each.object;
    }
    return nullptr;
  }
  double radiance() { return light() ? light()->radiance.x : -1.0; }
  double place() { return light() ? light()->transform.translation.x : -1.0; }

  Rig rig_;
  std::shared_ptr<Session> session_ = rig_.session();
  const ClientIdentity a_ = *session_->join();
  const ClientIdentity b_ = *session_->join();
};

}  // namespace lpv::test
