#include "store/sqlite/directory_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace lpv::store {
namespace {

Status unusable(const std::string& directory, const char* what) {
  return {Code::kUnavailable, "--state-dir " + directory + ": cannot " + what + ": " + std::strerror(errno),
          "state-dir"};
}

std::string holder(int file) {
  char text[32] = {};
  const ssize_t count = pread(file, text, sizeof text - 1, 0);
  return count > 0 ? "process " + std::string(text, std::size_t(count)) : std::string("another process");
}

}  // namespace

Expected<std::unique_ptr<DirectoryLock>> DirectoryLock::take(const std::string& directory) {
  std::error_code failed;
  if (std::filesystem::create_directories(directory, failed)) {
    std::filesystem::permissions(directory, std::filesystem::perms::owner_all, failed);  // sessions may be private
  }
  const int file = open((directory + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return unusable(directory, "open its lock file");
  std::unique_ptr<DirectoryLock> lock(new DirectoryLock(file));
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return unusable(directory, "lock it");
    return Status(Code::kFailedPrecondition,
                  "--state-dir " + directory + " is in use by " + holder(file) +
                      "; one server has a state directory at a time: stop that one or give another directory",
                  "state-dir");
  }
  const std::string pid = std::to_string(getpid());
  if (ftruncate(file, 0) != 0 || pwrite(file, pid.data(), pid.size(), 0) != ssize_t(pid.size())) {
    return unusable(directory, "write its lock file");
  }
  return lock;
}

DirectoryLock::~DirectoryLock() { close(file_); }

}  // namespace lpv::store
