#pragma once
// A page without a network: the test is its socket, and says when turns are taken and when messages have gone out.

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lpv/web/v1/socket.pb.h"
#include "web/calls.h"

namespace lpv::test {

class PageSocket final : public web_door::Socket {
 public:
  void send(std::string message, std::function<void(bool)> sent) override;
  void close(web_door::CloseCode code, const std::string& reason) override;
  void greeted(bool good) override { greetedGood = good; }
  void roomAgain() override { ++roomAgains; }
  void post(std::function<void()> job) override;

  /// Runs what is posted; true where there was something. What was sent has gone out then, unless it is held back.
  bool turn();
  /// Takes turns until nothing more comes for a while.
  void settle();

  std::vector<web::v1::ToClient> said;
  std::optional<web_door::CloseCode> closedWith;
  std::string reason;
  std::optional<bool> greetedGood;
  int roomAgains = 0;
  bool holdsBack = false;

 private:
  std::mutex mutex_;
  std::deque<std::function<void()>> jobs_;
  std::deque<std::function<void(bool)>> going_;
};

web::v1::ToServer beginStep(std::uint32_t call, const std::string& method);
web::v1::ToServer messageStep(std::uint32_t call, const std::string& bytes);

}  // namespace lpv::test
