#include "store/sqlite/directory_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace lpv::store {
namespace {

Status unusable(const std::string& directory, const char* what) {
  return {Code::kUnavailable, "--state-dir " + directory + ": cannot " + what + ": " + std::strerror(errno),
          "state-dir"};
}

/// Second line of the lock file, below the number of the process.
constexpr const char* kUsed = "sessions.db was made\n";

std::string contentOf(int file) {
  char text[64] = {};
  const ssize_t count = pread(file, text, sizeof text - 1, 0);
  return std::string(text, std::size_t(std::max<ssize_t>(count, 0)));
}

std::string holder(int file) {
  const std::string text = contentOf(file);
  return text.empty() ? std::string("another process") : "process " + text.substr(0, text.find('\n'));
}

}  // namespace

Expected<std::unique_ptr<DirectoryLock>> DirectoryLock::take(const std::string& directory) {
  std::error_code failed;
  if (std::filesystem::create_directories(directory, failed)) {
    std::filesystem::permissions(directory, std::filesystem::perms::owner_all, failed);  // sessions may be private
  }
  const int file = open((directory + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return unusable(directory, "open its lock file");
  std::unique_ptr<DirectoryLock> lock(new DirectoryLock(file, directory));
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return unusable(directory, "lock it");
    return Status(Code::kFailedPrecondition,
                  "--state-dir " + directory + " is in use by " + holder(file) +
                      "; one server has a state directory at a time: stop that one or give another directory",
                  "state-dir");
  }
  lock->used_ = contentOf(file).find(kUsed) != std::string::npos;
  if (Status s = lock->write(); !s.ok()) return s;
  return lock;
}

Status DirectoryLock::markUsed() {
  if (used_) return {};
  used_ = true;
  return write();
}

Status DirectoryLock::write() const {
  const std::string text = std::to_string(getpid()) + "\n" + (used_ ? kUsed : "");
  if (pwrite(file_, text.data(), text.size(), 0) == ssize_t(text.size()) && ftruncate(file_, off_t(text.size())) == 0) {
    return {};
  }
  return unusable(directory_, "write its lock file");
}

DirectoryLock::~DirectoryLock() { close(file_); }

}  // namespace lpv::store
