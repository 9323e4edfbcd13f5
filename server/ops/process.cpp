#include "ops/process.h"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace lpv::ops {
namespace {

double seconds(const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); }

std::int64_t residentBytes() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t total = 0;
  std::int64_t resident = 0;
  if (!(statm >> total >> resident)) return 0;
  return resident * sysconf(_SC_PAGESIZE);
}

std::int64_t openFiles() {
  std::error_code error;
  std::filesystem::directory_iterator file("/proc/self/fd", error);
  std::int64_t count = 0;
  for (; !error && file != std::filesystem::directory_iterator(); file.increment(error)) ++count;
  return count;
}

}  // namespace

ProcessUse processUse() {
  ProcessUse out;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) out.cpuSeconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  out.residentBytes = residentBytes();
  out.openFiles = openFiles();
  return out;
}

}  // namespace lpv::ops
