#include "gpu/loop_guard.h"

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "gpu/gl.h"

namespace lpv::gpu {

namespace {

bool wanted() {
  static const char* const value = std::getenv("LPV_LOOP_GUARD");
  return value != nullptr && std::string_view(value) == "1";
}

// Once a thread's loops are ended, so is every later one after its first round.
constexpr const char* kCountingMain = R"(
#undef main
layout(binding = 0) uniform atomic_uint endedLoops;
void main() {
  guardedMain();
  const uint wanted = gl_NumWorkGroups.x > 0u ? 2u : 0u;
  uint rounds = 0u;
  for (uint i = 0u; i < wanted; ++i) rounds += 1u;
  if (rounds < wanted) atomicCounterIncrement(endedLoops);
}
)";

}  // namespace

LoopGuard::LoopGuard(std::string program) : program_(std::move(program)) {
  if (!wanted()) return;
  glCreateBuffers(1, &counter_);
  const GLuint none = 0;
  glNamedBufferStorage(counter_, sizeof none, &none, 0);
}

LoopGuard::LoopGuard(LoopGuard&& other) noexcept
    : program_(std::move(other.program_)), counter_(std::exchange(other.counter_, 0)) {}

LoopGuard& LoopGuard::operator=(LoopGuard&& other) noexcept {
  LoopGuard taken(std::move(other));
  std::swap(program_, taken.program_);
  std::swap(counter_, taken.counter_);
  return *this;
}

LoopGuard::~LoopGuard() {
  if (counter_ == 0) return;
  if (const std::uint32_t threads = ended(); threads > 0) {
    std::fprintf(stderr, "loops were ended early in %u threads of %s\n", threads, program_.c_str());
  }
  glDeleteBuffers(1, &counter_);
}

std::string LoopGuard::guarded(const std::string& text) {
  if (!wanted()) return text;
  const std::size_t afterVersion = text.find('\n') + 1;
  return text.substr(0, afterVersion) + "#define main guardedMain\n" + text.substr(afterVersion) + kCountingMain;
}

void LoopGuard::bind() const {
  if (counter_ != 0) glBindBufferBase(GL_ATOMIC_COUNTER_BUFFER, 0, counter_);
}

std::uint32_t LoopGuard::ended() {
  std::uint32_t threads = 0;
  if (counter_ == 0) return threads;
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(counter_, 0, sizeof threads, &threads);
  glClearNamedBufferData(counter_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  return threads;
}

}  // namespace lpv::gpu
