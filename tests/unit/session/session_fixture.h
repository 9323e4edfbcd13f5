#pragma once
// A session with one light, "Lamp", and what tests do to it.

#include <gtest/gtest.h>

#include <memory>

#include "session/session.h"
#include "unit/session/session_rig.h"

namespace lpv::test {

class SessionTest : public testing::Test {
 protected:
  ~SessionTest() override { rig_.settle(); }

  /// The revision that an edit of anything made.
  std::uint64_t edited() {
    const EditOutcome outcome = session_->apply({}, editOf({setRadiance("Lamp", ++brightness_)}));
    EXPECT_TRUE(outcome.status.ok()) << outcome.status.message();
    rig_.settle();
    return outcome.revision;
  }
  std::shared_ptr<Subscriber> subscribed(const std::shared_ptr<Inbox>& inbox,
                                         const Subscription& subscription = volumes()) {
    const auto subscriber = session_->delivery().subscribe(subscription, inbox);
    EXPECT_TRUE(subscriber.ok()) << subscriber.status().message();
    rig_.settle();
    return *subscriber;
  }
  void acknowledge(const std::shared_ptr<Subscriber>& subscriber, std::uint64_t resultId) {
    session_->delivery().acknowledge(subscriber, resultId);
    rig_.settle();
  }
  static Subscription volumes() {
    Subscription subscription;
    subscription.volume = VolumeStage::kTransported;
    return subscription;
  }
  static Subscription twoCredits() {
    Subscription subscription = volumes();
    subscription.twoCredits = true;
    return subscription;
  }

  Rig rig_;
  std::shared_ptr<Session> session_ = [this] {
    auto session = rig_.session({std::chrono::seconds(60), ""});
    EXPECT_TRUE(session->apply({}, editOf({createLight("Lamp")})).status.ok());
    return session;
  }();
  std::shared_ptr<Inbox> inbox_ = std::make_shared<Inbox>();
  double brightness_ = 1.0;
};

}  // namespace lpv::test
