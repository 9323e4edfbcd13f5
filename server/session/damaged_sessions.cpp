#include "session/damaged_sessions.h"

#include <utility>
#include <vector>

#include "session/services.h"

namespace lpv {
namespace {

/// Of those that are named in a warning.
constexpr std::size_t kMostNamed = 5;

struct Check {
  const SessionServices services;
  WorkerPool& background;
  const std::vector<SessionHead> kept;
  const std::function<void(std::size_t)> checked;
};

/// One job a session: what else the threads are for gets its turn between two.
void checkFrom(const std::shared_ptr<const Check>& check, std::size_t next) {
  if (next == check->kept.size()) return check->checked(next);
  check->background.post([check, next] {
    const std::string& id = check->kept[next].id;
    noteRead(check->services, id, check->services.journal->load(id).status());
    checkFrom(check, next + 1);
  });
}

}  // namespace

bool DamagedSessions::note(const std::string& id, const std::string& why) {
  const MutexLock lock(mutex_);
  return why_.insert_or_assign(id, why).second;
}

void DamagedSessions::forget(const std::string& id) {
  const MutexLock lock(mutex_);
  why_.erase(id);
}

std::size_t DamagedSessions::count() const {
  const MutexLock lock(mutex_);
  return why_.size();
}

std::string DamagedSessions::warning() const {
  const MutexLock lock(mutex_);
  if (why_.empty()) return {};
  std::string out = "state directory: " + std::to_string(why_.size()) +
                    (why_.size() == 1 ? " session is damaged: " : " sessions are damaged: ");
  std::size_t named = 0;
  for (const auto& [id, why] : why_) {
    if (named == kMostNamed) return out + ", ...";
    out += (named++ == 0 ? "" : ", ") + id;
  }
  return out;
}

void noteRead(const SessionServices& services, const std::string& id, const Status& read) {
  if (read.ok()) return services.damaged->forget(id);
  if (read.code() != Code::kDataLoss) return;  // gone meanwhile, or not to be read now
  const bool news = services.damaged->note(id, read.message());
  if (news && services.onEvent) services.onEvent(SessionEvent::kDamaged, id, read.message());
}

void checkKeptSessions(const SessionServices& services, WorkerPool& background,
                       std::function<void(std::size_t)> checked) {
  Expected<std::vector<SessionHead>> kept = services.journal->heads();
  if (!kept) return;
  checkFrom(std::make_shared<const Check>(Check{services, background, std::move(*kept), std::move(checked)}), 0);
}

}  // namespace lpv
