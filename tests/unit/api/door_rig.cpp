#include "unit/api/door_rig.h"

#include <gtest/gtest.h>

#include "api/call/method_table.h"

namespace lpv::test {

using google::protobuf::Message;

DoorRig::DoorRig(bool tokens, Limits limits) : rig(limits) {
  if (tokens) {
    EXPECT_TRUE(access.require(kAdminToken).ok());
  }
  context.registry = &registry;
  context.pool = &rig.pool;
  context.timers = &rig.timers;
  context.counters = &rig.counters;
  context.limits = limits;
  context.access = &access;
  room = *registry.create("room", LightingSettings(), {}, "");
}

DoorRig::~DoorRig() {
  rig.settle();
  rig.timers.stop();
  rig.pool.stop();
}

MintedToken DoorRig::mint(Role role, const std::string& session) {
  return *access.mint(session, role, std::chrono::hours(1));
}

TestCall::TestCall(DoorRig& rig, const Message& request, const Expected<std::string>& token) {
  const api::Method* method = api::methodOf(*request.GetDescriptor());
  driver_ = std::make_shared<api::CallDriver>(
      rig.context, *method, api::CallOrigin{.token = token, .peer = "test", .traceparent = {}}, *this);
  driver_->start();
}

TestCall::~TestCall() {
  driver_->onCancel();
  if (isWriting()) written();
  EXPECT_TRUE(eventually([&] { return hasEnded(); }));
  driver_->onDone();
  EXPECT_EQ(ends_, 1);
}

void TestCall::read(Message* into) {
  const std::lock_guard lock(mutex_);
  EXPECT_EQ(into_, nullptr) << "two reads at once";
  EXPECT_FALSE(end_) << "a read after the end";
  into_ = into;
}

void TestCall::write(const Message&) {
  const std::lock_guard lock(mutex_);
  EXPECT_FALSE(writing_) << "two writes at once";
  EXPECT_FALSE(end_) << "a write after the end";
  writing_ = true;
  ++messages_;
}

void TestCall::finish(const Message* last, const Status& status) {
  const std::lock_guard lock(mutex_);
  EXPECT_FALSE(writing_) << "ended while writing";
  ++ends_;
  if (last) {
    answer_.reset(last->New());
    answer_->CopyFrom(*last);
  }
  end_ = status;
}

void TestCall::arrive(const Message* message, api::ReadResult result) {
  Message* into = nullptr;
  EXPECT_TRUE(eventually([&] {
    const std::lock_guard lock(mutex_);
    into = std::exchange(into_, nullptr);
    return into != nullptr || end_.has_value();
  }));
  if (into == nullptr) return;
  if (message) into->CopyFrom(*message);
  driver_->onRead(result);
}

void TestCall::written() {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
  }
  driver_->onWrite(true);
}

bool TestCall::isWriting() const {
  const std::lock_guard lock(mutex_);
  return writing_;
}

bool TestCall::hasEnded() const {
  const std::lock_guard lock(mutex_);
  return end_.has_value();
}

Status TestCall::end() const {
  EXPECT_TRUE(eventually([&] { return hasEnded(); }));
  const std::lock_guard lock(mutex_);
  return end_.value_or(Status());
}

int TestCall::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

}  // namespace lpv::test
