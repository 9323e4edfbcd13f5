#pragma once
// Another client than the attackers: it makes one call after the other, and knows how long they took.

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "lpv/v1/session.grpc.pb.h"

namespace lpv::rpc {

/// What a bystander saw.
struct Calls {
  std::vector<double> milliseconds;  ///< of those that succeeded
  int failed = 0;
  std::string lastError;

  double percentile(double share) const {
    if (milliseconds.empty()) return 0.0;
    std::vector<double> sorted = milliseconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1, std::size_t(share * double(sorted.size())))];
  }
};

class Bystander {
 public:
  Bystander(std::shared_ptr<grpc::Channel> channel, std::string session)
      : stub_(lpv::v1::SessionService::NewStub(std::move(channel))),
        session_(std::move(session)),
        thread_([this] { run(); }) {}
  ~Bystander() {
    stopping_ = true;
    thread_.join();
  }
  Bystander(const Bystander&) = delete;
  Bystander& operator=(const Bystander&) = delete;

  /// What was seen since the last time.
  Calls take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(calls_, {});
  }

 private:
  static constexpr std::chrono::milliseconds kPause{10};
  static constexpr std::chrono::seconds kPatience{20};

  void run() {
    while (!stopping_) {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + kPatience);
      lpv::v1::GetSessionRequest request;
      request.set_name(session_);
      lpv::v1::GetSessionResponse response;
      const auto begun = std::chrono::steady_clock::now();
      const grpc::Status status = stub_->GetSession(&context, request, &response);
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begun;
      {
        const std::lock_guard lock(mutex_);
        if (status.ok()) {
          calls_.milliseconds.push_back(took.count());
        } else {
          ++calls_.failed;
          calls_.lastError = status.error_message();
        }
      }
      std::this_thread::sleep_for(kPause);
    }
  }

  std::unique_ptr<lpv::v1::SessionService::Stub> stub_;
  const std::string session_;
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  Calls calls_;
  std::thread thread_;
};

}  // namespace lpv::rpc
