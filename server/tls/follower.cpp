#include "tls/follower.h"

#include <chrono>
#include <list>
#include <optional>
#include <thread>
#include <utility>

#include "base/mutex.h"

namespace lpv::tls {
namespace {

constexpr std::chrono::milliseconds kLookEvery{250};
constexpr int kLooksUntilTold = 2;

}  // namespace

class Follower::Parts {
 public:
  Parts(Files files, OnTrouble onTrouble) : files_(std::move(files)), onTrouble_(std::move(onTrouble)) {}
  ~Parts();

  Status begin();
  const Files& files() const { return files_; }
  Expected<std::shared_ptr<void>> use(TakeUp takeUp);

 private:
  void run();
  void look();
  Status give(const PemFiles& good);
  void tell(const Status& status);

  const Files files_;
  const OnTrouble onTrouble_;
  int badLooks_ = 0;  ///< since the last good one
  Mutex using_;  ///< held while users are given files
  std::optional<PemFiles> inUse_ LPV_GUARDED_BY(using_);
  std::list<TakeUp> users_ LPV_GUARDED_BY(using_);
  Mutex mutex_;
  ConditionVariable ending_;
  bool ended_ LPV_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

Follower::Parts::~Parts() {
  {
    const MutexLock lock(mutex_);
    ended_ = true;
  }
  ending_.notifyAll();
  if (thread_.joinable()) thread_.join();
}

Status Follower::Parts::begin() {
  const Expected<PemFiles> read = readPemFiles(files_);
  if (!read) return read.status();
  if (Status s = checkPem(files_, *read); !s.ok()) return s;
  {
    const MutexLock lock(using_);
    inUse_ = *read;
  }
  thread_ = std::thread([this] { run(); });
  return {};
}

Expected<std::shared_ptr<void>> Follower::Parts::use(TakeUp takeUp) {
  const MutexLock lock(using_);
  if (Status s = takeUp(*inUse_); !s.ok()) return s;
  const auto user = users_.insert(users_.end(), std::move(takeUp));
  return std::shared_ptr<void>(&*user, [this, user](void*) {
    const MutexLock gone(using_);
    users_.erase(user);
  });
}

void Follower::Parts::run() {
  MutexLock lock(mutex_);
  while (!ended_) {
    if (ending_.waitUntil(lock, std::chrono::steady_clock::now() + kLookEvery)) continue;
    lock.unlock();
    look();
    lock.lock();
  }
}

void Follower::Parts::look() {
  const Expected<PemFiles> read = readPemFiles(files_);
  Status status = read.status();
  if (status.ok()) status = checkPem(files_, *read);
  if (status.ok()) status = give(*read);
  tell(status);
}

/// A user that cannot take the files up is asked again at the next look, and so are the others.
Status Follower::Parts::give(const PemFiles& good) {
  const MutexLock lock(using_);
  if (good == inUse_) return {};
  Status out;
  for (const TakeUp& user : users_) {
    if (Status s = user(good); !s.ok()) out = s;
  }
  if (out.ok()) inUse_ = good;
  return out;
}

/// A file may just be in the middle of its change: it is bad at the next look as well, or nothing is said.
void Follower::Parts::tell(const Status& status) {
  if (status.ok()) {
    if (std::exchange(badLooks_, 0) >= kLooksUntilTold) onTrouble_(status);
  } else if (++badLooks_ == kLooksUntilTold) {
    onTrouble_(status);
  }
}

Status check(const Files& files) {
  if (!files.given()) return {};
  if (files.certificate.empty() || files.key.empty()) {
    return invalid("tls-cert", "--tls-cert and --tls-key go together; give both, or none and no --tls-client-ca");
  }
  const Expected<PemFiles> read = readPemFiles(files);
  return read ? checkPem(files, *read) : read.status();
}

Follower::Follower(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Follower::~Follower() = default;

Expected<std::unique_ptr<Follower>> Follower::follow(const Files& files, OnTrouble onTrouble) {
  auto parts = std::make_unique<Parts>(files, std::move(onTrouble));
  if (Status s = parts->begin(); !s.ok()) return s;
  return std::unique_ptr<Follower>(new Follower(std::move(parts)));
}

const Files& Follower::files() const { return parts_->files(); }

Expected<std::shared_ptr<void>> Follower::use(TakeUp takeUp) { return parts_->use(std::move(takeUp)); }

}  // namespace lpv::tls
