#include "unit/web/page_rig.h"

#include <chrono>
#include <thread>
#include <utility>

namespace lpv::test {

void PageSocket::send(std::string message, std::function<void(bool)> sent) {
  web::v1::ToClient step;
  if (step.ParseFromString(message)) said.push_back(std::move(step));
  going_.push_back(std::move(sent));
}

void PageSocket::close(web_door::CloseCode code, const std::string& why) {
  if (closedWith) return;
  closedWith = code;
  reason = why;
}

void PageSocket::post(std::function<void()> job) {
  const std::lock_guard lock(mutex_);
  jobs_.push_back(std::move(job));
}

bool PageSocket::turn() {
  std::deque<std::function<void()>> jobs;
  {
    const std::lock_guard lock(mutex_);
    jobs.swap(jobs_);
  }
  for (const auto& job : jobs) job();
  std::deque<std::function<void(bool)>> gone;
  if (!holdsBack) gone.swap(going_);
  for (const auto& sent : gone) sent(true);
  return !jobs.empty() || !gone.empty();
}

void PageSocket::settle() {
  constexpr int kQuietTurns = 20;
  for (int quiet = 0; quiet < kQuietTurns;) {
    quiet = turn() ? 0 : quiet + 1;
    if (quiet > 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

web::v1::ToServer beginStep(std::uint32_t call, const std::string& method) {
  web::v1::ToServer out;
  out.set_call(call);
  out.mutable_begin()->set_method("lpv.v1." + method);
  return out;
}

web::v1::ToServer messageStep(std::uint32_t call, const std::string& bytes) {
  web::v1::ToServer out;
  out.set_call(call);
  out.set_message(bytes);
  return out;
}

}  // namespace lpv::test
